// SPDX-License-Identifier: MIT
#include "cli/study/learn_cracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/atom_units.h"
#include "model/base/output.h"
#include "model/trace/plot.h"
#include "study/learn/spread.h"

namespace cuboct {
namespace {

using learn::CrackErrors;
using learn::CrackModel;
using learn::Cracks;
using learn::CrackState;
using learn::LearnStudy;
using learn::Spread;

struct Measure {
  const char* name;
  double CrackErrors::*value;
  double CrackErrors::*squares;
  double learn::PaperErrors::*paper;
};
constexpr Measure kMeasures[] = {
    {"displacement", &CrackErrors::displacement, &CrackErrors::displacement_squares,
     &learn::PaperErrors::displacement},
    {"damage", &CrackErrors::damage, &CrackErrors::damage_squares, &learn::PaperErrors::damage}};
constexpr const char* kLoads[] = {"pulled", "pushed"};

void add_test(Items& items, const Cracks& cracks, size_t test) {
  for (const Measure& of : kMeasures) {
    const double error = cracks.model.tests[test].*of.value;
    const Spread drawn =
        spread_of(cracks.drawn, [&](const CrackModel& m) { return m.tests[test].*of.value; });
    items.add(
        fmt::format("{}: {}", learn::kCrackTests[test], of.name), 100 * error, "%",
        fmt::format("mean of squares {:.2g} %; the paper {:g} %; samples drawn anew: {:.3g} +- {:.2g} %",
                    100 * (cracks.model.tests[test].*of.squares), 100 * (learn::kPaperErrors[test].*of.paper),
                    100 * drawn.mean, 100 * drawn.deviation));
  }
}

}  // namespace

void add_cracks(Items& items, const LearnStudy& study, const Cracks& cracks) {
  const Spread drawn = spread_of(cracks.drawn, [](const CrackModel& m) { return m.stretch.stretch; });
  items.add("breaking kernel, validation residual", cracks.model.validation, "",
            study.stretch.positive ? fmt::format("no negative weight; horizon {:g} spacings, degree {}",
                                                 study.stretch.horizon, study.stretch.degree)
                                   : std::string("the learned one"));
  items.add("critical stretch", cracks.model.stretch.stretch, "",
            fmt::format("samples drawn anew: {:.4f} +- {:.4f}, {} times", drawn.mean, drawn.deviation,
                        cracks.drawn.size()));
  for (size_t test = 0; test < learn::kCrackTests.size(); ++test) add_test(items, cracks, test);
}

void write_crack_tables(const LearnStudy& study, const Cracks& cracks, const std::string& directory) {
  std::string stretch = "stretch\tdisplacement\tdamage\tresidual\n";
  for (const learn::StretchPoint& p : cracks.model.stretch.tried)
    stretch += fmt::format("{:.6g}\t{:.6g}\t{:.6g}\t{:.6g}\n", p.stretch, p.errors.displacement,
                           p.errors.damage, p.residual);
  write_text(directory + "/stretch.tsv", stretch);
  std::string tests = "test\tmeasure\terror\tsquares\tdrawn_mean\tdrawn_deviation\tpaper\n";
  for (size_t t = 0; t < learn::kCrackTests.size(); ++t)
    for (const Measure& of : kMeasures) {
      const Spread drawn = spread_of(cracks.drawn, [&](const CrackModel& m) { return m.tests[t].*of.value; });
      tests += fmt::format("{}\t{}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.6g}\t{:g}\n", learn::kCrackTests[t], of.name,
                           cracks.model.tests[t].*of.value, cracks.model.tests[t].*of.squares, drawn.mean,
                           drawn.deviation, learn::kPaperErrors[t].*of.paper);
    }
  write_text(directory + "/predictions.tsv", tests);
  std::string cost = "model\tpoints\tload\tdisplacement\tdamage\tcore_seconds\tjoules\n";
  for (const learn::CostPoint& p : cracks.cost)
    cost += fmt::format("{}\t{}\t{}\t{:.6g}\t{:.6g}\t{:.4g}\t{:.4g}\n", p.model, p.points,
                        kLoads[static_cast<size_t>(p.load)], p.errors.displacement, p.errors.damage,
                        p.seconds, p.seconds * study.prediction.watts);
  write_text(directory + "/cost.tsv", cost);
}

namespace {

void draw_stretch(const Cracks& cracks, const std::string& directory) {
  std::string rows;
  for (const learn::StretchPoint& p : cracks.model.stretch.tried)
    rows += fmt::format("{:.6g} {:.6g} {:.6g}\n", p.stretch, p.errors.displacement, p.errors.damage);
  draw_plot(directory + "/stretch.svg", plot_block("tried", rows),
            fmt::format("{}set xlabel 'critical stretch'\nset ylabel 'relative error, training'\n"
                        "set yrange [0:*]\nset arrow 1 from {},graph 0 to {},graph 1 nohead dt 2\n"
                        "plot $tried using 1:2 with linespoints pt 7 ps 0.5 lw 2 lc rgb '#1f5fa8' "
                        "title 'displacement', $tried using 1:3 with linespoints pt 7 ps 0.5 lw 2 "
                        "lc rgb '#b03020' title 'damage'\n",
                        kPlotStyle, cracks.model.stretch.stretch, cracks.model.stretch.stretch),
            640, 400);
}

// Error against core seconds; joules are these times a power, on the upper axis.
void draw_cost(const LearnStudy& study, const Cracks& cracks, const std::string& directory) {
  std::string data, plots;
  double atoms = 0, least = 1e9, most = 0;
  for (const learn::CostPoint& p : cracks.cost) {
    if (p.model == "atoms") atoms = std::max(atoms, p.seconds);
    least = std::min(least, p.seconds), most = std::max(most, p.seconds);
  }
  int number = 0;
  for (const char* model : {"solid", "pairs"})
    for (const size_t load : {0, 1}) {
      data += fmt::format("$of{} << END\n", number);
      for (const learn::CostPoint& p : cracks.cost)
        if (p.model == model && static_cast<size_t>(p.load) == load)
          data += fmt::format("{:.6g} {:.6g} {}\n", p.seconds, 100 * p.errors.displacement, p.points);
      data += "END\n";
      const bool solid = std::string(model) == "solid";
      plots += fmt::format(
          "{}$of{} using 1:2 with linespoints lw 2 pt {} dt {} lc rgb '{}' title '{}, {}', $of{} using "
          "1:2:(sprintf('%d', $3)) with labels offset 0,0.8 notitle",
          number == 0 ? "" : ", ", number, load == 0 ? 7 : 5, load == 0 ? 1 : 2,
          solid ? "#1f5fa8" : "#b03020", solid ? "peridynamic solid" : "pair law", kLoads[load], number);
      ++number;
    }
  const double low = least / 1.5, high = most * 2, watts = study.prediction.watts;
  draw_plot(directory + "/cost.svg", data,
            fmt::format("{}set border 7\nset logscale xx2\nset xrange [{:.4g}:{:.4g}]\nset x2range "
                        "[{:.4g}:{:.4g}]\nset x2tics\nset yrange [0:*]\nset key left bottom\nset xlabel "
                        "'core seconds'\nset x2label 'J, at {:g} W a core'\nset ylabel 'error of "
                        "displacement, %'\nset arrow 1 from {:.4g},graph 0 to {:.4g},graph 1 nohead dt 2\n"
                        "set label 1 'atoms' at {:.4g},graph 0.9 right offset -1,0\nplot {}\n",
                        kPlotStyle, low, high, low * watts, high * watts, watts, atoms, atoms, atoms, plots),
            720, 460);
}

std::string block(const std::string& name, const learn::Grid& grid, const CrackState& state) {
  std::string out;
  for (size_t i = 0; i < grid.size(); ++i) {
    const Vec3 at = (grid.at(i) + state.u[i]) / kAngstrom;
    out += fmt::format("{:.4g} {:.4g} {:.4g} {:.4g}\n", at[0], at[1], state.u[i][0] / kAngstrom,
                       state.damage[i]);
  }
  return plot_block(name, out);
}

// Like the paper's Figures 6 to 8: atoms, then displacement and damage, each as seen and as predicted.
void draw_test(const Cracks& cracks, size_t test, const std::string& path) {
  const size_t load = learn::load_of_test(test), grid = learn::grid_of_test(test);
  const std::vector<learn::AtomFrame>& atoms = cracks.samples[load].atoms;
  double wide = 0, most = 0;
  std::string data;
  for (const learn::AtomFrame& frame : atoms) {
    data += fmt::format("$atoms{} << END\n", frame.frame);
    for (size_t i = 0; i < frame.x.size(); ++i) {
      const Vec3 at = (frame.x[i] + frame.u[i]) / kAngstrom;
      data += fmt::format("{:.4g} {:.4g}\n", at[0], at[1]);
    }
    data += "END\n";
    const auto k = static_cast<size_t>(frame.frame);
    data += block(fmt::format("seen{}", k), cracks.grids[grid], cracks.seen[test][k]);
    data += block(fmt::format("predicted{}", k), cracks.grids[grid], cracks.predicted[test][k]);
    for (size_t i = 0; i < cracks.seen[test][k].u.size(); ++i) {
      const double x = cracks.grids[grid].at(i)[0] + cracks.seen[test][k].u[i][0];
      wide = std::max(wide, std::abs(x) / kAngstrom);
      most = std::max(most, std::abs(cracks.seen[test][k].u[i][0]) / kAngstrom);
    }
  }
  wide = 10 * std::ceil(wide / 10 + 0.5);
  std::string plot = fmt::format(
      "set multiplot layout 5,3\nset size ratio -1\nunset key\nset xrange [{}:{}]\nset yrange [-70:60]\n"
      "set tics font ',8'\n",
      -wide, wide);
  for (const learn::AtomFrame& frame : atoms)
    plot += fmt::format("set title 'atoms, frame {}'\nplot $atoms{} with dots lc rgb 'black'\n", frame.frame,
                        frame.frame);
  const struct {
    const char* what;
    int column;
    std::string range, palette;
  } shown[] = {{"u_x, angstrom", 3, fmt::format("[{:.3g}:{:.3g}]", -most, most),
                "(-1 '#2166ac', 0 '#f0f0f0', 1 '#b2182b')"},
               {"damage", 4, "[0:1]", "(0 '#20204a', 0.5 '#c03a76', 1 '#fcd34d')"}};
  const double size = grid == 1 ? 0.35 : 0.55;
  for (const auto& one : shown)
    for (const char* source : {"seen", "predicted"}) {
      plot += fmt::format("set palette defined {}\nset cbrange {}\n", one.palette, one.range);
      for (const learn::AtomFrame& frame : atoms)
        plot += fmt::format(
            "set title '{}, {}, frame {}' noenhanced\nplot ${}{} using 1:2:{} with points pt 7 ps {} "
            "palette\n",
            one.what, source, frame.frame, source, frame.frame, one.column, size);
    }
  draw_plot(path, data, plot + "unset multiplot\n", 1100, 1500);
}

}  // namespace

void draw_cracks(const LearnStudy& study, const Cracks& cracks, const std::string& directory) {
  draw_stretch(cracks, directory);
  draw_cost(study, cracks, directory);
  const char* names[] = {"longer_time.png", "other_load.png", "finer_grid.png"};
  for (size_t test = 0; test < learn::kCrackTests.size(); ++test)
    draw_test(cracks, test, directory + "/" + names[test]);
}

}  // namespace cuboct
