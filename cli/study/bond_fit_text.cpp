// SPDX-License-Identifier: MIT
#include "cli/study/bond_fit_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "model/trace/plot.h"

namespace cuboct {
namespace {

using bond_fit::BondStudy;
using bond_fit::Compared;

constexpr std::array<const char*, 3> kColours = {"#1f5fa8", "#b03020", "#3d8a3d"};

double unit_of(size_t property) { return property < bulk ? 1 : kGpaOfEvPerA3; }
const char* unit_name(size_t property) {
  return property == cohesive ? "eV per atom" : property == edge_slope ? "eV/angstrom per atom" : "GPa";
}

std::string off_text(const BondStudy& study, size_t property, double value) {
  if (property == edge_slope) return {};
  const double target = study.problem.goal.value[property];
  return fmt::format(" ({:+.2f} %)", 100 * (value - target) / target);
}

DiamondProperties properties_of(const BondStudy& study, const TersoffTerm<double>& term) {
  return diamond_properties(term, study.problem.goal.edge, false);
}

TersoffTerm<double> best_term(const BondStudy& study, const bond_fit::BondFit& fit) {
  return with_free(study.problem.fixed, bond_fit::parameters_at(study.problem, fit.found().point));
}

void add_properties(Items& items, const BondFindings& found) {
  const BondStudy& study = found.study;
  const DiamondProperties is = properties_of(study, best_term(study, found.fit));
  for (size_t p = 0; p < kDiamondProperties; ++p) {
    std::string note = fmt::format("target {:.6g}{}", study.problem.goal.value[p] * unit_of(p),
                                   off_text(study, p, is.value[p]));
    for (const bond_fit::NamedSet& set : study.beside) {
      const double other = properties_of(study, set.term).value[p];
      note += fmt::format("; {} {:.4g}{}", set.name, other * unit_of(p), off_text(study, p, other));
    }
    items.add(bond_fit::property_names()[p], is.value[p] * unit_of(p), unit_name(p), note);
  }
}

void add_losses(Items& items, const BondFindings& found) {
  const BondStudy& study = found.study;
  items.add("loss", found.fit.found().loss, "", "equation 13");
  for (const bond_fit::NamedSet& set : study.beside)
    items.add("loss of " + set.name, bond_fit::loss_of(study.problem, free_of(set.term)));
}

// Not at the target's edge, and by forces: another way to the same numbers.
void add_rest(Items& items, const BondFindings& found) {
  const bond_fit::Tried& tried = found.fit.tried[*found.fit.best];
  TersoffForces forces({{found.study.element}, {best_term(found.study, found.fit)}});
  const CellConstants c = constants_of(forces, diamond_cell(tried.edge));
  const auto gpa = [](double value) { return value * kGpaOfEvPerA3; };
  items.add("edge at rest", tried.edge, "angstrom");
  items.add("energy at rest", c.energy, "eV per atom");
  items.add("C11 at rest", gpa(c.relaxed(0, 0)), "GPa");
  items.add("C12 at rest", gpa(c.relaxed(0, 1)), "GPa");
  items.add("C44 at rest", gpa(c.relaxed(3, 3)), "GPa",
            fmt::format("{:.4g} with atoms nailed to the strain", gpa(c.clamped(3, 3))));
}

std::string verdict(const bond_fit::Tried& tried) {
  if (!tried.fault.empty()) return tried.fault;
  for (size_t b = 0; b < bond_fit::kBoundaries; ++b)
    if (const std::string& fault = tried.endurance.runs[b].fault; !fault.empty())
      return fmt::format("periodic along {}: {}", bond_fit::kBoundaryNames[b], fault);
  return fmt::format("stable, {:.0f} K at most at the end", tried.endurance.hottest());
}

void add_trials(Items& items, const BondFindings& found) {
  std::vector<Items> list;
  for (const bond_fit::Tried& tried : found.fit.tried) {
    Items one;
    const double loss = found.fit.starts[tried.start].loss;
    one.add("text", fmt::format("set {}, loss {:.3g}: {}", tried.start, loss, verdict(tried)));
    one.add("set", static_cast<uint64_t>(tried.start));
    one.add("loss", loss);
    one.add("stable", tried.stable() ? "yes" : "no");
    list.push_back(std::move(one));
  }
  items.add_list("trials", "trial", list);
}

void add_methods(Items& items, const BondFindings& found) {
  for (const Compared& one : found.compared) {
    std::vector<double> losses;
    uint64_t evaluations = 0;
    for (const bond_fit::Found& f : one.found)
      losses.push_back(f.loss), evaluations += static_cast<uint64_t>(f.evaluations);
    std::ranges::sort(losses);
    items.add(
        bond_fit::name_of(one.method), losses[losses.size() / 2], "",
        fmt::format("median loss of {} starts, least {:.3g}; {} evaluations, {:.3g} us each", losses.size(),
                    losses.front(), evaluations, 1e6 * one.seconds / static_cast<double>(evaluations)));
  }
}

}  // namespace

Items items_of(const BondFindings& found) {
  Items items;
  const bond_fit::BondFit& fit = found.fit;
  if (!found.study.title.empty()) items.add("title", line_text(found.study.title));
  if (fit.best) {
    add_losses(items, found);
    add_properties(items, found);
    add_rest(items, found);
    const TersoffFree p = free_of(best_term(found.study, fit));
    for (size_t k = 0; k < kTersoffFree; ++k) {
      // B is a modulus too.
      items.add(fmt::format("parameter {}", kTersoffFreeNames[k]), p[k]);
    }
  }
  const auto equal = std::ranges::count_if(
      fit.starts, [&](const bond_fit::Found& f) { return f.loss <= found.study.enough; });
  items.add("starts", static_cast<uint64_t>(fit.starts.size()), "",
            fmt::format("{} evaluations of the loss with its gradient; {} starts end at or below {:g}",
                        fit.evaluations, equal, found.study.enough));
  add_trials(items, found);
  add_methods(items, found);
  items.add("time", found.seconds, "s");
  return items;
}

void write_bond_tables(const BondFindings& found, const std::string& directory) {
  std::string sets = fmt::format("set\tloss\tevaluations\t{}\n", fmt::join(kTersoffFreeNames, "\t"));
  for (size_t k = 0; k < found.fit.starts.size(); ++k) {
    const bond_fit::Found& f = found.fit.starts[k];
    sets += fmt::format("{}\t{:.6g}\t{}\t{:.9g}\n", k, f.loss, f.evaluations,
                        fmt::join(bond_fit::parameters_at(found.study.problem, f.point), "\t"));
  }
  write_text(directory + "/sets.tsv", sets);
  std::string trials = "set\tperiodic\ttemperature_K\tdrift_eV\tfault\n";
  for (const bond_fit::Tried& tried : found.fit.tried)
    for (size_t b = 0; b < bond_fit::kBoundaries; ++b) {
      const bond_fit::Endured& run = tried.endurance.runs[b];
      trials += fmt::format("{}\t{}\t{:.6g}\t{:.3g}\t{}\n", tried.start, bond_fit::kBoundaryNames[b],
                            run.temperature, run.drift, tried.fault.empty() ? run.fault : tried.fault);
    }
  write_text(directory + "/trials.tsv", trials);
}

std::string potential_file(const BondStudy& study, const bond_fit::BondFit& fit) {
  const TersoffTerm<double> t = best_term(study, fit);
  return fmt::format(
      "# Tersoff's parameters by cuboct fit, for a crystal of edge {:g} angstrom. UNITS: metal (eV, "
      "angstrom)\n"
      "# element element element m gamma lambda3 c d cos_theta0 n beta lambda2 B R D lambda1 A\n"
      "{} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}\n",
      study.problem.goal.edge, study.element, study.element, study.element, t.m, t.gamma, t.lambda3, t.c, t.d,
      t.cos_theta0, t.n, t.beta, t.lambda2, t.B, t.R, t.D, t.lambda1, t.A);
}

void write_convergence(const BondFindings& found, const std::string& directory) {
  std::string rows = "method\tstart\tevaluation\tloss\n";
  for (const Compared& one : found.compared)
    for (size_t s = 0; s < one.descents.size(); ++s)
      for (size_t k = 0; k < one.descents[s].loss.size(); ++k)
        rows += fmt::format("{}\t{}\t{}\t{:.6g}\n", bond_fit::name_of(one.method), s + 1,
                            one.descents[s].evaluation[k], one.descents[s].loss[k]);
  write_text(directory + "/convergence.tsv", rows);
}

void draw_convergence(const BondFindings& found, const std::string& directory) {
  std::string data, plots;
  for (size_t m = 0; m < found.compared.size(); ++m)
    for (size_t s = 0; s < found.compared[m].descents.size(); ++s) {
      const bond_fit::Descent& descent = found.compared[m].descents[s];
      std::string rows;
      for (size_t k = 0; k < descent.loss.size(); ++k)
        rows += fmt::format("{} {:.6g}\n", descent.evaluation[k], descent.loss[k]);
      rows += fmt::format("{} {:.6g}\n", found.compared[m].found[s].evaluations, descent.loss.back());
      data += plot_block(fmt::format("of{}_{}", m, s), rows);
      plots += fmt::format(
          "{}$of{}_{} with steps lw 2 lc rgb '{}' {}", plots.empty() ? "" : ", ", m, s, kColours[m],
          s > 0 ? "notitle" : fmt::format("title '{}'", bond_fit::name_of(found.compared[m].method)));
    }
  draw_plot(directory + "/convergence.png", data,
            "set grid lc '#dddddd' lt 1\nset border 3\nset tics nomirror\nset key right top\n"
            "set logscale xy\nset format y '10^{%T}'\nset xlabel 'evaluations of the loss'\n"
            "set ylabel 'loss, least so far'\nplot " +
                plots + "\n",
            900, 520);
}

}  // namespace cuboct
