// SPDX-License-Identifier: MIT
#include "cli/study/multiscale_compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "cli/study/multiscale_text.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "model/trace/plot.h"

namespace cuboct {
namespace {

struct FigureName {
  const char *name, *unit, *title;
  double scale;
};
constexpr std::array<FigureName, 3> kFigures{{{"modulus", "GPa", "Young''s modulus", 1e9},
                                              {"Poisson ratio", "", "Poisson''s ratio", 1},
                                              {"wave speed", "m/s", "wave speed", 1}}};
constexpr std::array<double, 3> kLimits{0.01, 1e-3, 1e-4};
constexpr double kLeastDrawn = 1e-7;  // of an error on the chart: less is drawn there

std::string settings_of(const ComparedPoint& point) {
  return fmt::format("{} elements, samples of {} atoms, strain tolerance {:g}, force {:g} eV/angstrom",
                     point.elements, point.atoms, point.effort.strain_tolerance, point.effort.force);
}

std::string cost_of(const ComparedPoint& point) {
  return fmt::format("{:.3g} atom-steps, {:.3g} s of a processor", static_cast<double>(point.atom_steps),
                     point.processor);
}

Items row_of(const Comparison& compared, const ComparedPoint& point) {
  Items row;
  std::string errors;
  row.add("elements", point.elements);
  row.add("atoms", point.atoms);
  row.add("strain_tolerance", point.effort.strain_tolerance);
  row.add("force_eV_per_angstrom", point.effort.force);
  row.add("atom_steps", point.atom_steps);
  row.add("processor_s", point.processor);
  for (size_t k = 0; k < kFigures.size(); ++k) {
    if (!point.figures[k]) continue;
    std::string name = kFigures[k].name;
    std::ranges::replace(name, ' ', '_');
    row.add(name, *point.figures[k] / kFigures[k].scale);
    row.add(name + "_error", *compared.error(point, k));
    errors +=
        fmt::format(", {} {:.6g}{}{} ({:+.2g} %)", kFigures[k].name, *point.figures[k] / kFigures[k].scale,
                    *kFigures[k].unit ? " " : "", kFigures[k].unit, 100 * *compared.error(point, k));
  }
  row.add("text", settings_of(point) + ": " + cost_of(point) + errors);
  return row;
}

void add_cheapest(Items& items, const Comparison& compared, double limit) {
  const ComparedPoint* cheapest = nullptr;
  for (const ComparedPoint& point : compared.points)
    if (compared.largest_error(point) <= limit &&
        (cheapest == nullptr || point.atom_steps < cheapest->atom_steps))
      cheapest = &point;
  if (cheapest == nullptr) return;
  items.add(fmt::format("within {:g} %", 100 * limit), settings_of(*cheapest),
            fmt::format("{}; the finest point takes {:.3g} times the atom-steps", cost_of(*cheapest),
                        static_cast<double>(compared.finest.atom_steps) /
                            static_cast<double>(std::max<uint64_t>(cheapest->atom_steps, 1))));
}

// Points of one mesh, one size of sample and one force, by rising cost.
struct CostCurve {
  uint64_t elements = 0, atoms = 0;
  double force = 0;
  std::vector<const ComparedPoint*> points;
};

std::vector<CostCurve> curves_of(const Comparison& compared) {
  std::set<std::tuple<uint64_t, uint64_t, double>> kinds;
  for (const ComparedPoint& p : compared.points) kinds.insert({p.elements, p.atoms, p.effort.force});
  std::vector<CostCurve> out;
  for (const auto& [elements, atoms, force] : kinds) {
    CostCurve curve{elements, atoms, force, {}};
    for (const ComparedPoint& p : compared.points)
      if (p.elements == elements && p.atoms == atoms && p.effort.force == force) curve.points.push_back(&p);
    std::ranges::sort(curve.points, {}, &ComparedPoint::atom_steps);
    out.push_back(std::move(curve));
  }
  return out;
}

// Shape by mesh, colour by size of sample, hollow where the force is not the least.
struct Marks {
  explicit Marks(const std::vector<CostCurve>& curves) {
    force = curves[0].force;
    for (const CostCurve& curve : curves)
      elements.insert(curve.elements), atoms.insert(curve.atoms), force = std::min(force, curve.force);
  }
  std::string of(const CostCurve& curve) const {
    static constexpr const char* kColours[] = {"#1f5fa8", "#d9822b", "#3a8f4d", "#8a4fa3"};
    static constexpr int kFilled[] = {7, 5, 9, 13, 11};
    const bool filled = curve.force == force;
    return fmt::format(
        "with linespoints lw 1 pt {} ps 0.8 lc rgb '{}' {}",
        kFilled[rank_of(elements, curve.elements) % std::size(kFilled)] - (filled ? 0 : 1),
        kColours[rank_of(atoms, curve.atoms) % std::size(kColours)],
        filled ? fmt::format("title '{} elements, {} atoms'", curve.elements, curve.atoms) : "notitle");
  }
  // The place of a value among those that are there.
  static size_t rank_of(const std::set<uint64_t>& values, uint64_t value) {
    return static_cast<size_t>(std::distance(values.begin(), values.find(value)));
  }
  std::set<uint64_t> elements, atoms;
  double force = 0;
};

// A panel: errors of one figure against one cost.
std::string panel(const std::vector<CostCurve>& curves, size_t figure, bool steps) {
  const Marks marks(curves);
  std::string out = fmt::format("set xlabel '{}'\nset ylabel 'error of {}'\nplot ",
                                steps ? "atom-steps" : "seconds of a processor", kFigures[figure].title);
  for (size_t c = 0; c < curves.size(); ++c)
    out += fmt::format("{}$curve{} using {}:{} {}", c == 0 ? "" : ", ", c, steps ? 1 : 2, 3 + figure,
                       marks.of(curves[c]));
  return out + "\n";
}

std::string data_of(const Comparison& compared, const std::vector<CostCurve>& curves) {
  std::string data;
  for (size_t c = 0; c < curves.size(); ++c) {
    data += fmt::format("$curve{} << END\n", c);
    for (const ComparedPoint* p : curves[c].points) {
      data += fmt::format("{} {:.6g}", std::max<uint64_t>(p->atom_steps, 1), std::max(p->processor, 1e-4));
      for (size_t k = 0; k < kFigures.size(); ++k)
        data += fmt::format(" {:.6g}", std::max(std::abs(compared.error(*p, k).value_or(0)), kLeastDrawn));
      data += "\n";
    }
    data += "END\n";
  }
  return data;
}

}  // namespace

ComparedPoint compared_point(const ElementEffort& effort, const ElementStudy& study,
                             const SampleMaterial& material, const std::vector<SetOutcome>& sets) {
  ComparedPoint out;
  out.effort = effort;
  out.atoms = material.lattice.place.size(), out.elements = study.mesh.elements.size();
  std::array<std::vector<double>, 3> values;
  for (const SetOutcome& set : sets) {
    out.atom_steps += set.work.evaluations * out.atoms, out.processor += set.processor;
    if (study.stretch) values[0].push_back(set.moduli.youngs), values[1].push_back(set.moduli.poisson);
    if (study.wave) values[2].push_back(set.wave.speed.speed);
  }
  for (size_t k = 0; k < values.size(); ++k)
    if (!values[k].empty()) out.figures[k] = mean_of(values[k]).mean;
  return out;
}

std::optional<double> Comparison::error(const ComparedPoint& point, size_t figure) const {
  if (!point.figures[figure]) return std::nullopt;
  return *point.figures[figure] / *finest.figures[figure] - 1;
}

double Comparison::largest_error(const ComparedPoint& point) const {
  double most = 0;
  for (size_t k = 0; k < kFigures.size(); ++k) most = std::max(most, std::abs(error(point, k).value_or(0)));
  return most;
}

Items items_of(const Comparison& compared) {
  Items items;
  if (!compared.title.empty()) items.add("title", line_text(compared.title));
  std::vector<Items> rows;
  for (const ComparedPoint& point : compared.points) rows.push_back(row_of(compared, point));
  items.add_list("points", "point", rows);
  items.add("finest", settings_of(compared.finest), cost_of(compared.finest));
  for (const double limit : kLimits) add_cheapest(items, compared, limit);
  return items;
}

void write_comparison(const Comparison& compared, const std::string& directory) {
  std::string text =
      "elements\tatoms\tstrain_tolerance\tforce_eV_per_angstrom\tatom_steps\tprocessor_s\tmodulus_Pa\t"
      "modulus_error\tPoisson_ratio\tPoisson_ratio_error\tspeed_m_per_s\tspeed_error\n";
  for (const ComparedPoint& p : compared.points) {
    text += fmt::format("{}\t{}\t{:g}\t{:g}\t{}\t{:.4g}", p.elements, p.atoms, p.effort.strain_tolerance,
                        p.effort.force, p.atom_steps, p.processor);
    for (size_t k = 0; k < kFigures.size(); ++k)
      text += p.figures[k] ? fmt::format("\t{:.9g}\t{:.4g}", *p.figures[k], *compared.error(p, k)) : "\t\t";
    text += "\n";
  }
  write_text(directory + "/compare.tsv", text);
}

void draw_comparison(const Comparison& compared, const std::string& directory) {
  const std::vector<CostCurve> curves = curves_of(compared);
  std::vector<size_t> there;
  for (size_t k = 0; k < kFigures.size(); ++k)
    if (compared.finest.figures[k]) there.push_back(k);
  constexpr double kPanel = 250;  // dots, its height; the key has a row for three meshes or samples
  const size_t key_rows = (curves.size() + 2) / 3;
  const double rows = static_cast<double>(there.size()), foot = 18.0 * static_cast<double>(key_rows) + 45,
               height = kPanel * rows + foot;
  std::string plot = fmt::format(
      "set grid lc '#dddddd' lt 1\nset border 3\nset tics nomirror font ',10'\nset logscale xy\nset format "
      "xy '%.0e'\nset yrange [{:g}:*]\nset lmargin 11\nset rmargin 2\nset tmargin 1\nunset key\n"
      "set label 1 'hollow: a looser force; along a line the strain tolerance falls; drawn at {:.0e}: less' "
      "at screen 0.5,{:.4f} center font ',10'\nset multiplot\n",
      0.7 * kLeastDrawn, kLeastDrawn, 12 / height);
  for (size_t k = 0; k < there.size(); ++k)
    for (const bool steps : {true, false}) {
      plot += fmt::format("set size 0.5,{:.4f}\nset origin {},{:.4f}\n", kPanel / height, steps ? 0 : 0.5,
                          (foot + kPanel * (rows - 1 - static_cast<double>(k))) / height);
      if (k + 1 == there.size() && !steps)
        plot += fmt::format("set key at screen 0.97,{:.4f} vertical maxrows {} font ',11'\n",
                            (foot - 5) / height, key_rows);
      plot += panel(curves, there[k], steps) + "unset label 1\n";
    }
  draw_plot(directory + "/compare.svg", data_of(compared, curves), plot + "unset multiplot\n", 900,
            static_cast<int>(height));
}

}  // namespace cuboct
