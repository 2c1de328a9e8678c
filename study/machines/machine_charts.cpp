// SPDX-License-Identifier: MIT
#include "study/machines/machine_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "model/base/quantity_text.h"
#include "study/machines/machine_table.h"
#include "study/report/chart_axes.h"
#include "study/sweep/numbers.h"
#include "study/sweep/series.h"

namespace cuboct::study {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr char kPeerColour[] = "#555555";
// Bars of a stacked chart.
constexpr size_t kMostBars = 16;

// A band's place on a logarithmic axis. Of what is open, its low end.
double middle(const MachineValue& v) {
  if (!v.there()) return kNone;
  return v.open ? v.band.low : std::sqrt(v.band.low * v.band.high);
}

// The axis around both ends of all bands; its values are those of the marks.
ChartAxis around(const std::string& label, std::vector<double> values, std::vector<double> ends) {
  std::erase_if(ends, [](double x) { return !(x > 0) || !std::isfinite(x); });
  Rows drawn(ends.size());
  std::iota(drawn.begin(), drawn.end(), size_t{0});
  ChartAxis axis = decades_axis(label, ends, drawn);
  axis.values = std::move(values);
  return axis;
}

// Of the marks that a chart has: those of machines, then those of peers.
struct Marks {
  std::vector<double> x, y, low, high;  // low and high: along x
  std::vector<std::string> tips;

  size_t add(double at_x, double at_y, double from, double to, std::string tip) {
    x.push_back(at_x), y.push_back(at_y), low.push_back(from), high.push_back(to);
    tips.push_back(std::move(tip));
    return x.size() - 1;
  }
};

std::string tip_of(const MachineResults& r, size_t n) {
  return fmt::format("machine {}\n{}\n{}", n + 1, machine_text(r.study, r.findings[n].choice),
                     machine_report(r.study, r.findings[n]));
}

// Bars from end to end, each a line of its own: a place that is not there lies between two.
void add_bars(Chart& chart, const Marks& marks, const Rows& rows, const std::string& name,
              const std::string& colour) {
  Plotted bars{name, colour, -1, 0, Stroke::solid, 1, {}, {}};
  for (const size_t row : rows) {
    if (!(marks.high[row] > marks.low[row])) continue;
    bars.places.emplace_back(marks.low[row], marks.y[row]);
    bars.places.emplace_back(marks.high[row], marks.y[row]);
    bars.places.emplace_back(kNone, kNone);
  }
  if (!bars.places.empty()) chart.plotted.push_back(std::move(bars));
}

std::string technology_name(const MachineResults& r, size_t n) {
  const MachineFinding& f = r.findings[n];
  return r.study.technologies[f.choice.technology].name +
         (f.choice.target.empty() ? "" : " on " + f.choice.target);
}

// Rows of the machines by a word of theirs, in the order of its first.
using Groups = std::vector<std::pair<std::string, Rows>>;
void add_to(Groups& groups, const std::string& name, size_t row) {
  const auto found = std::ranges::find(groups, name, &std::pair<std::string, Rows>::first);
  if (found == groups.end())
    groups.emplace_back(name, Rows{row});
  else
    found->second.push_back(row);
}

struct RateChart {
  const char* id;
  const char* label;  // of the rate
  bool particles;     // particle-steps/s, else steps/s
  MachineQuantity against;
};

Chart rate_chart(const MachineResults& r, const RateChart& what) {
  Marks marks;
  Groups groups;
  const bool energy = what.against == MachineQuantity::energy;
  Chart chart;
  const double scale = what.against == MachineQuantity::area ? 1e6 : 1;
  for (size_t n = 0; n < r.findings.size(); ++n) {
    const MachineFinding& f = r.findings[n];
    if (!f.done() || !f.value(what.against).there()) continue;
    const MachineValue& v = f.value(what.against);
    const double rate = f.value(MachineQuantity::rate).band.low * (what.particles ? f.particles : 1);
    const size_t row = marks.add(scale * middle(v), rate, scale * v.band.low,
                                 scale * (v.open ? v.band.low : v.band.high), tip_of(r, n));
    add_to(groups, technology_name(r, n) + (v.open ? ", at least" : ""), row);
    if (std::ranges::binary_search(r.front, n)) chart.best.push_back(row);
  }
  if (groups.empty()) return {};
  size_t k = 0;
  // Marks before their bars: the key shows the first of a name.
  for (const auto& [name, rows] : groups) {
    const std::string colour = series_colour(k);
    chart.plotted.push_back({name, colour, static_cast<int>(k % kSymbols), 8, Stroke::none, 0, {rows}, {}});
    Rows ringed;
    std::ranges::copy_if(rows, std::back_inserter(ringed),
                         [&](size_t row) { return std::ranges::binary_search(chart.best, row); });
    add_bars(chart, marks, ringed, name, colour);
    ++k;
  }
  if (energy)
    for (const Peer& peer : r.peers) {
      const double rate = what.particles ? peer.rate : peer.rate / peer.particles;
      const size_t row =
          marks.add(std::sqrt(peer.joules.low * peer.joules.high), rate, peer.joules.low, peer.joules.high,
                    fmt::format("{}\n{}\n{}", peer.what, peer.known, peer.source));
      const std::string name = fmt::format("{} ({})", peer.what, peer.known);
      chart.plotted.push_back(
          {name, kPeerColour, static_cast<int>(k++ % kSymbols), 10, Stroke::none, 0, {{row}}, {}});
      add_bars(chart, marks, {row}, name, kPeerColour);
    }
  std::vector<double> ends = marks.low;
  ends.insert(ends.end(), marks.high.begin(), marks.high.end());
  chart.id = what.id;
  chart.section = "rates";
  chart.x = around(named(what.against).label, marks.x, ends);
  chart.y = around(what.label, marks.y, marks.y);
  chart.title = fmt::format("{} against {}", what.label, named(what.against).label);
  chart.caption =
      "The better, the higher and the further to the left. A bar is the band of published figures, its mark "
      "stands "
      "in the middle of the logarithms; rings: the front. Within a band there is no order.";
  chart.corner_left = true;
  chart.tips = marks.tips;
  return chart;
}

// Machines of the front, or of all, each once, the fastest first; of many some, evenly.
std::vector<size_t> machines_for_bars(const MachineResults& r) {
  std::vector<size_t> some;
  std::set<std::string> known;
  const auto take = [&](size_t n) {
    if (r.findings[n].done() && known.insert(r.findings[n].choice.machine_key()).second) some.push_back(n);
  };
  for (const size_t n : r.front) take(n);
  if (some.empty())
    for (size_t n = 0; n < r.findings.size(); ++n) take(n);
  std::ranges::stable_sort(some, {}, [&](size_t n) { return r.findings[n].counts->mean(); });
  if (some.size() <= kMostBars) return some;
  std::vector<size_t> fewer;
  for (size_t k = 0; k < kMostBars; ++k) fewer.push_back(some[k * (some.size() - 1) / (kMostBars - 1)]);
  return fewer;
}

// What share of its cycles a machine spends on what, bar by bar: steps of machines differ a hundredfold.
Chart parts_chart(const MachineResults& r) {
  const std::vector<size_t> some = machines_for_bars(r);
  Chart chart;
  if (some.empty()) return chart;
  std::vector<double> x, y(some.size(), 100.0);
  std::vector<std::string> names;
  for (size_t k = 0; k < some.size(); ++k) {
    x.push_back(static_cast<double>(k));
    const double cycles = r.findings[some[k]].counts->mean();
    names.push_back(cycles < 1e4 ? fmt::format("{:.0f}", cycles) : fmt::format("{:.0f}k", cycles / 1000));
    chart.tips.push_back(tip_of(r, some[k]));
  }
  for (size_t part = 0; part < kStepParts; ++part) {
    Plotted bars{
        name_of(static_cast<StepPart>(part)), series_colour(part), -1, 0, Stroke::solid, 20.0, {}, {}};
    for (size_t k = 0; k < some.size(); ++k) {
      const MachineCounts& counts = *r.findings[some[k]].counts;
      const double from = std::accumulate(counts.parts.begin(),
                                          counts.parts.begin() + static_cast<std::ptrdiff_t>(part), 0.0);
      bars.places.emplace_back(x[k], 100 * from / counts.mean());
      bars.places.emplace_back(x[k], 100 * (from + counts.parts[part]) / counts.mean());
      bars.places.emplace_back(kNone, kNone);
    }
    chart.plotted.push_back(std::move(bars));
  }
  Rows all(some.size());
  std::iota(all.begin(), all.end(), size_t{0});
  chart.plotted.push_back({"a step", "#222222", 0, 4, Stroke::none, 0, {all}, {}});
  chart.id = "parts", chart.section = "bound";
  chart.title = "What a step's cycles go to, machines of the front";
  chart.caption =
      "Of the node that waits least; the parts add up to the step. Force is what is left of it when the last "
      "exchange is over.";
  chart.x = named_axis("cycles per step of each machine", x, names);
  chart.y = ChartAxis{"share of a step, %", y, false, false, 0, 105, {}};
  for (double tick = 0; tick <= 100; tick += 20) chart.y.ticks.push_back({tick, number_text(tick)});
  return chart;
}

// One mark for each machine, whatever its technology and clock.
std::vector<size_t> machines_once(const MachineResults& r) {
  std::vector<size_t> some;
  std::set<std::string> known;
  for (size_t n = 0; n < r.findings.size(); ++n)
    if (r.findings[n].done() && known.insert(r.findings[n].choice.machine_key()).second) some.push_back(n);
  return some;
}

// A kind of mark for each part that binds.
void plot_by_bound(Chart& chart, const Groups& groups) {
  size_t k = 0;
  for (const auto& [name, rows] : groups) {
    const int symbol = static_cast<int>(k % kSymbols);
    chart.plotted.push_back({"bound by " + name, series_colour(k), symbol, 8, Stroke::none, 0, {rows}, {}});
    ++k;
  }
}

// Pairs per cycle of the busiest node, against what the tightest of its lanes, pipes and links allows.
Chart roof_chart(const MachineResults& r) {
  Chart chart;
  Groups groups;
  std::vector<double> x, y;
  for (const size_t n : machines_once(r)) {
    const MachineFinding& f = r.findings[n];
    const auto& demands = f.counts->demands;
    const double tightest = *std::ranges::max_element(demands);
    if (!(f.pairs_per_step > 0) || !(tightest > 0)) continue;
    x.push_back(f.pairs_per_step / tightest), y.push_back(f.pairs_per_step / f.counts->mean());
    chart.tips.push_back(tip_of(r, n));
    add_to(groups, bound_of(*f.counts), x.size() - 1);
  }
  if (groups.empty()) return chart;
  chart.x = around("pairs per cycle that lanes, pipes, links and memories allow", x, x);
  chart.y = around("pairs per cycle, as counted", y, y);
  const double low = std::max(chart.x.low, chart.y.low), high = std::min(chart.x.high, chart.y.high);
  if (low < high)
    chart.plotted.push_back(
        {"the roof", "#222222", -1, 0, Stroke::dashed, 1.5, {}, {{low, low}, {high, high}}});
  plot_by_bound(chart, groups);
  chart.id = "roof", chart.section = "bound";
  chart.title = "How near machines come to what their parts allow";
  chart.caption =
      "Of the busiest node. A machine on the roof keeps its tightest part busy in every cycle; how far below "
      "it "
      "stands is latency and waiting.";
  return chart;
}

// Cycles against particles of a node: from many to one.
Chart strong_chart(const MachineResults& r) {
  Chart chart;
  std::vector<double> x, y;
  Groups groups;
  for (const size_t n : machines_once(r)) {
    const MachineFinding& f = r.findings[n];
    if (f.choice.scene != 0 || !f.choice.settings.scene.empty()) continue;
    x.push_back(static_cast<double>(f.particles) / f.nodes), y.push_back(f.counts->mean());
    chart.tips.push_back(tip_of(r, n));
    add_to(groups, bound_of(*f.counts), x.size() - 1);
  }
  const std::set<double> sizes(x.begin(), x.end());
  if (sizes.size() < 3) return {};
  // The fewest cycles at each size; sizes whose machines are all slower than one of fewer nodes are left out.
  Plotted best{"fewest cycles", "#222222", -1, 0, Stroke::solid, 1.5, {}, {}};
  double fewest = std::numeric_limits<double>::infinity();
  for (auto size = sizes.rbegin(); size != sizes.rend(); ++size) {
    double least = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < x.size(); ++k)
      if (x[k] == *size) least = std::min(least, y[k]);
    if (least < fewest) best.places.emplace_back(*size, fewest = least);
  }
  std::ranges::reverse(best.places);
  const double first = best.places.back().second;
  chart.plotted.push_back(best);
  chart.x = around("particles per node, mean", x, x);
  chart.y = around("cycles per step", y, y);
  // As many nodes, as much faster.
  std::vector<Place> ideal;
  const double most = *sizes.rbegin(), least = std::max(*sizes.begin(), most * chart.y.low / first);
  ideal = {{least, first * least / most}, {most, first}};
  chart.plotted.push_back({"in proportion to the nodes", "#777777", -1, 0, Stroke::dashed, 1.5, {}, ideal});
  plot_by_bound(chart, groups);
  chart.id = "strong", chart.section = "scaling";
  chart.title = "Strong scaling: one scene on more and more nodes";
  chart.caption =
      "Cells and bricks make the nodes. Where the line leaves the dashed one, more nodes help less.";
  return chart;
}

// Cycles against the particles of scenes that differ in size.
Chart weak_chart(const MachineResults& r) {
  Chart chart;
  std::vector<double> x, y;
  Groups lines;
  for (const size_t n : machines_once(r)) {
    const MachineFinding& f = r.findings[n];
    x.push_back(f.particles), y.push_back(f.counts->mean());
    chart.tips.push_back(tip_of(r, n));
    MachineChoice arch = f.choice;
    arch.scene = 0, arch.settings.scene.clear();
    add_to(lines, arch.machine_key(), x.size() - 1);
  }
  std::erase_if(lines, [&](const auto& line) {
    std::set<double> sizes;
    for (const size_t row : line.second) sizes.insert(x[row]);
    return sizes.size() < 2;
  });
  if (lines.empty()) return {};
  size_t k = 0;
  Rows drawn;
  for (auto& [name, rows] : lines) {
    std::ranges::stable_sort(rows, {}, [&](size_t row) { return x[row]; });
    drawn.insert(drawn.end(), rows.begin(), rows.end());
    const std::string shown = name.size() > 2 ? name.substr(2) : "the arch as it is";
    const int symbol = static_cast<int>(k % kSymbols);
    chart.plotted.push_back(
        {lines.size() <= 8 ? shown : "one arch", series_colour(k), symbol, 7, Stroke::solid, 1, {rows}, {}});
    ++k;
  }
  chart.id = "weak", chart.section = "scaling";
  chart.title = "Weak scaling: larger scenes on as many more nodes";
  chart.caption =
      "Lines join scenes that run on one arch. A level line: the step takes as long however large the scene.";
  chart.x = decades_axis("particles", x, drawn);
  chart.y = decades_axis("cycles per step", y, drawn);
  return chart;
}

// The energy of the machine that takes least in each technology.
Chart technology_chart(const MachineResults& r) {
  Groups groups;
  for (size_t n = 0; n < r.findings.size(); ++n)
    if (r.findings[n].done() && r.findings[n].value(MachineQuantity::energy).there())
      add_to(groups, technology_name(r, n), n);
  Chart chart;
  if (groups.size() < 2) return chart;
  std::vector<double> x, y, ends;
  std::vector<std::string> names;
  Plotted bars{"band", series_colour(0), -1, 0, Stroke::solid, 22, {}, {}};
  Plotted open{"at least: figures are missing", series_colour(1), 4, 10, Stroke::none, 0, {{}}, {}};
  for (const auto& [name, members] : groups) {
    const size_t n = *std::ranges::min_element(
        members, {}, [&](size_t m) { return middle(r.findings[m].value(MachineQuantity::energy)); });
    const MachineValue& v = r.findings[n].value(MachineQuantity::energy);
    const auto at = static_cast<double>(x.size());
    names.push_back(name), x.push_back(at), y.push_back(middle(v));
    chart.tips.push_back(tip_of(r, n));
    ends.insert(ends.end(), {v.band.low, v.open ? v.band.low : v.band.high});
    if (v.open) {
      open.rows[0].push_back(x.size() - 1);
      continue;
    }
    bars.places.emplace_back(at, v.band.low), bars.places.emplace_back(at, v.band.high);
    bars.places.emplace_back(kNone, kNone);
  }
  if (!bars.places.empty()) chart.plotted.push_back(bars);
  if (!open.rows[0].empty()) chart.plotted.push_back(open);
  Rows all(x.size());
  std::iota(all.begin(), all.end(), size_t{0});
  chart.plotted.push_back({"machine of least energy", "#222222", 0, 6, Stroke::none, 0, {all}, {}});
  chart.x = named_axis("technology", x, names);
  chart.y = around(named(MachineQuantity::energy).label, y, ends);
  chart.id = "technologies", chart.section = "technologies";
  chart.title = "The same scene in each technology";
  chart.caption =
      "The machine that takes least in each. Where figures are missing, the true value lies above the mark.";
  return chart;
}

}  // namespace

std::vector<Chart> machine_charts(const MachineResults& results) {
  std::vector<Chart> charts;
  const auto add = [&](Chart chart) {
    if (!chart.id.empty()) charts.push_back(std::move(chart));
  };
  add(rate_chart(results, {"rate_energy", "steps per second", false, MachineQuantity::energy}));
  add(rate_chart(results,
                 {"particle_rate_energy", "particle-steps per second", true, MachineQuantity::energy}));
  add(rate_chart(results, {"rate_area", "steps per second", false, MachineQuantity::area}));
  add(rate_chart(results, {"rate_error", "steps per second", false, MachineQuantity::error}));
  add(parts_chart(results));
  add(roof_chart(results));
  add(strong_chart(results));
  add(weak_chart(results));
  add(technology_chart(results));
  return charts;
}

}  // namespace cuboct::study
