// SPDX-License-Identifier: MIT
#include "cli/study/multiscale_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/base/output.h"
#include "model/base/text.h"
#include "model/solid/moduli.h"
#include "model/trace/plot.h"

namespace cuboct {
namespace {

// "166.21 GPa"-like pairs under one name: the value by Hill's mean, Reuss's and Voigt's bound in the note.
std::string bounds_note(double reuss, double voigt, const char* form_unit, double scale) {
  return fmt::format("Reuss {:.4g}, Voigt {:.4g} {}", reuss / scale, voigt / scale, form_unit);
}

std::string spread_note(const SetMean& m, size_t sets, double scale, const std::string& unit) {
  if (sets < 2) return "one set of grains: no error bar";
  return fmt::format("standard error {:.2g}, of {} sets, which differ by {:.2g}{}", m.error / scale, sets,
                     m.deviation / scale, unit.empty() ? "" : " " + unit);
}

// The stiffness of each shell, and how far the constants are from what was asked of them.
void add_springs(Items& items, const SpringInput& input) {
  std::string shells;
  for (const ShellSprings::Shell& shell : input.springs.shells)
    shells += fmt::format("{}{:.4g} eV/angstrom^2 at {:.4g} angstrom", shells.empty() ? "" : ", ",
                          shell.stiffness, shell.rest);
  items.add("springs", shells);
  const auto miss = [](double have, double asked) { return 100 * (have / asked - 1); };
  items.add("C12 off", miss(input.fit.c44, input.c12), "%",
            fmt::format("{:.4g} GPa asked; under a pair law C44 is at most C12", input.c12 / 1e9));
  items.add("C44 off", miss(input.fit.c44, input.c44), "%", fmt::format("{:.4g} GPa asked", input.c44 / 1e9));
}

void add_material(Items& items, const ElementFindings& found) {
  const SampleMaterial& m = found.material;
  const auto gpa = [](double value) { return value / 1e9; };
  items.add("potential", line_text(found.study.material.name));
  if (found.study.material.springs) add_springs(items, *found.study.material.springs);
  items.add("sample", static_cast<uint64_t>(m.lattice.place.size()), "atoms");
  items.add("edge", m.edge(found.study.material.cells), "angstrom");
  items.add("energy", m.energy, "eV per atom");
  items.add("density", m.lattice.density(), "kg/m^3");
  items.add("C11", gpa(m.constants(0, 0)), "GPa");
  items.add("C12", gpa(m.constants(0, 1)), "GPa");
  items.add("C44", gpa(m.constants(3, 3)), "GPa",
            fmt::format("{:.4g} with atoms nailed to the strain", gpa(m.clamped(3, 3))));
  const Isotropic hill = hill_mean(m.constants), reuss = reuss_mean(m.constants),
                  voigt = voigt_mean(m.constants);
  items.add("Hill modulus", gpa(hill.youngs()), "GPa",
            bounds_note(reuss.youngs(), voigt.youngs(), "GPa", 1e9));
  items.add("Hill Poisson ratio", hill.poisson(), "", bounds_note(reuss.poisson(), voigt.poisson(), "", 1));
}

void add_stretch(Items& items, const ElementFindings& found) {
  std::vector<double> youngs, poisson;
  for (const SetOutcome& set : found.sets)
    youngs.push_back(set.moduli.youngs), poisson.push_back(set.moduli.poisson);
  const SetMean e = mean_of(youngs), nu = mean_of(poisson);
  items.add("modulus", e.mean / 1e9, "GPa", spread_note(e, youngs.size(), 1e9, "GPa"));
  items.add("modulus error", e.error / 1e9, "GPa");
  items.add("Poisson ratio", nu.mean, "", spread_note(nu, poisson.size(), 1, ""));
  items.add("Poisson ratio error", nu.error);
}

double expected_of(const ElementFindings& found, const Isotropic& matter) {
  const WaveInput& wave = *found.study.wave;
  return expected_speed(matter, found.material.lattice.density(), {wave.axis, wave.polarisation},
                        found.study.mesh.period);
}

void add_wave(Items& items, const ElementFindings& found) {
  std::vector<double> speeds;
  for (const SetOutcome& set : found.sets) speeds.push_back(set.wave.speed.speed);
  const SetMean speed = mean_of(speeds);
  const WaveOutcome& first = found.sets[0].wave;
  items.add("wave speed", speed.mean, "m/s",
            speeds.size() > 1 ? spread_note(speed, speeds.size(), 1, "m/s")
                              : fmt::format("standard error of the fit {:.2g}", first.speed.error));
  const Matrix6& c = found.material.constants;
  const double hill = expected_of(found, hill_mean(c));
  items.add("Hill wave speed", hill, "m/s",
            bounds_note(expected_of(found, reuss_mean(c)), expected_of(found, voigt_mean(c)), "m/s", 1) +
                fmt::format("; measured {:+.1f} %", 100 * (speed.mean / hill - 1)));
  if (const auto reference = found.study.wave->reference)
    items.add("reference", *reference, "m/s",
              fmt::format("measured {:+.1f} %", 100 * (speed.mean / *reference - 1)));
  items.add("wave steps", first.steps, "",
            fmt::format("of {:.3g} s; strain {:.2g}", first.dt, first.largest_strain));
}

void add_work(Items& items, const ElementFindings& found) {
  SampleWork work;
  double seconds = 0, processor = 0;
  for (const SetOutcome& set : found.sets)
    work.add(set.work), seconds += set.seconds, processor += set.processor;
  items.add("stress updates", work.updates);
  items.add("relaxations", work.relaxations, "",
            fmt::format("{:.3g} % of the updates, {:.3g} evaluations of forces each",
                        100.0 * static_cast<double>(work.relaxations) /
                            static_cast<double>(std::max<uint64_t>(work.updates, 1)),
                        static_cast<double>(work.evaluations) /
                            static_cast<double>(std::max<uint64_t>(work.relaxations, 1))));
  items.add("atom steps", work.evaluations * found.material.lattice.place.size(), "",
            "evaluations of forces times atoms of a sample");
  if (found.study.strain_tolerance > 0 && work.measured > 0)
    items.add(
        "stress error", std::sqrt(work.squared_error / static_cast<double>(work.measured)) / 1e6, "MPa",
        fmt::format("root mean square where relaxations ended a stretch without one; largest {:.2g} MPa",
                    work.largest_error / 1e6));
  items.add("time", seconds, "s");
  items.add("processor time", processor, "s", "of all threads");
}

void draw_stretch(const ElementFindings& found, const std::string& directory, bool stress) {
  std::string rows;
  double most = 0, least = 0;
  for (const SetOutcome& set : found.sets)
    for (const StretchPoint& p : set.stretch) {
      rows += fmt::format("{:.9g} {:.9g}\n", 100 * p.strain, stress ? p.stress / 1e9 : 100 * p.expansion);
      most = std::max(most, 100 * p.strain), least = std::min(least, 100 * p.strain);
    }
  const Isotropic hill = hill_mean(found.material.constants);
  const double slope = stress ? hill.youngs() / 1e11 : 1 - 2 * hill.poisson();
  draw_plot(
      directory + (stress ? "/stress.svg" : "/volume.svg"), plot_block("points", rows),
      fmt::format("{}set key left top\n"
                  "set xlabel 'strain, %'\nset ylabel '{}'\nset xrange [{:.6g}:{:.6g}]\n"
                  "plot {:.9g}*x with lines lw 2 lc rgb '#888888' title 'linear elasticity, Hill mean', "
                  "$points with points pt 7 ps 0.6 lc rgb '#1f5fa8' title '{} of grains'\n",
                  kPlotStyle, stress ? "stress, GPa" : "change of volume, %", 1.05 * least, 1.05 * most,
                  slope, found.sets.size() == 1 ? "one set" : fmt::format("{} sets", found.sets.size())),
      640, 400);
}

void draw_front(const ElementFindings& found, const std::string& directory) {
  std::string rows;
  for (const SetOutcome& set : found.sets)
    for (const FrontPoint& p : set.wave.front)
      rows += fmt::format("{:.9g} {:.9g}\n", 1e9 * p.time, 1e6 * p.place);
  const FrontPoint first = found.sets[0].wave.front.front();
  const double speed = expected_of(found, hill_mean(found.material.constants));
  draw_plot(
      directory + "/front.svg", plot_block("points", rows),
      fmt::format(
          "{}set key left top\n"
          "set xlabel 'time, ns'\nset ylabel 'front, um'\n"
          "plot {:.9g}+{:.9g}*(x-{:.9g}) with lines lw 2 lc rgb '#888888' title 'Hill mean, {:.0f} m/s', "
          "$points with points pt 7 ps 0.6 lc rgb '#1f5fa8' title 'front'\n",
          kPlotStyle, 1e6 * first.place, speed * 1e-3, 1e9 * first.time, speed),
      640, 400);
}

// Where a front of the given speed is, begun with the pulse: half of the pulse's peak comes in after a
// quarter of its length.
double front_at(const ElementFindings& found, double time) {
  const WaveOutcome& wave = found.sets[0].wave;
  const double speed =
      found.study.wave->reference.value_or(expected_of(found, hill_mean(found.material.constants)));
  const FrontPoint first = wave.front.front();
  return first.place + speed * (time - first.time);
}

// Of points that touch along the wave, in gnuplot's unit: a picture of 660 dots, points of 8.
double square_size(const WaveSnapshot& snapshot) {
  std::set<double> places;
  for (const auto& point : snapshot.points) places.insert(point[0]);
  return std::clamp(82.0 / static_cast<double>(places.size()), 0.3, 3.0);
}

void draw_velocity(const ElementFindings& found, const std::string& directory) {
  const std::vector<WaveSnapshot>& snapshots = found.sets[0].wave.snapshots;
  std::string data, plot;
  double most = 0, length = 0, width = 0;
  for (const WaveSnapshot& s : snapshots)
    for (const auto& [x, y, v] : s.points)
      most = std::max(most, std::abs(v)), length = std::max(length, x), width = std::max(width, y);
  const auto count = static_cast<double>(snapshots.size());
  plot = fmt::format(
      "set multiplot layout {},1\nset palette defined (-1 '#1f5fa8', 0 '#f4f4f4', 1 '#b03020')\n"
      "set cbrange [{:.6g}:{:.6g}]\nset cblabel 'm/s'\nset xrange [{:.6g}:{:.6g}]\n"
      "set yrange [{:.6g}:{:.6g}]\nunset key\nset xlabel 'um'\nset ylabel 'um'\n",
      snapshots.size(), -most, most, -0.01 * 1e6 * length, 1.01 * 1e6 * length, -0.15 * 1e6 * width,
      1.15 * 1e6 * width);
  for (size_t k = 0; k < snapshots.size(); ++k) {
    std::string rows;
    for (const auto& [x, y, v] : snapshots[k].points)
      rows += fmt::format("{:.6g} {:.6g} {:.6g}\n", 1e6 * x, 1e6 * y, v);
    data += plot_block(fmt::format("at{}", k), rows);
    const double front = 1e6 * front_at(found, snapshots[k].time);
    plot += fmt::format(
        "set title '{:.3g} ns'\nset arrow 1 from {:.6g},graph 0 to {:.6g},graph 1 nohead lw 2 lc rgb "
        "'#222222' front\n"
        "plot $at{} using 1:2:3 with points pt 5 ps {:.3g} lc palette\n",
        1e9 * snapshots[k].time, front, front, k, square_size(snapshots[k]));
  }
  draw_plot(directory + "/velocity.png", data, plot + "unset multiplot\n", 900,
            static_cast<int>(40 + 220 * count));
}

}  // namespace

SetMean mean_of(const std::vector<double>& values) {
  SetMean out;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) out.mean += v / n;
  for (const double v : values) out.deviation += (v - out.mean) * (v - out.mean);
  out.deviation = values.size() > 1 ? std::sqrt(out.deviation / (n - 1)) : 0;
  out.error = out.deviation / std::sqrt(n);
  return out;
}

Items items_of(const ElementFindings& found) {
  Items items;
  if (!found.study.title.empty()) items.add("title", line_text(found.study.title));
  add_material(items, found);
  items.add("elements", static_cast<uint64_t>(found.study.mesh.elements.size()));
  items.add("grains", found.study.mesh.grains());
  if (found.study.stretch) add_stretch(items, found);
  if (found.study.wave) add_wave(items, found);
  add_work(items, found);
  return items;
}

void write_element_tables(const ElementFindings& found, const std::string& directory) {
  std::string stretch = "set\tstrain\tstress_Pa\texpansion\tacross_Pa\tupdates\n",
              front = "set\ttime_s\tplace_m\n";
  for (size_t k = 0; k < found.sets.size(); ++k) {
    for (const StretchPoint& p : found.sets[k].stretch)
      stretch += fmt::format("{}\t{:.9g}\t{:.9g}\t{:.9g}\t{:.3g}\t{}\n", k + 1, p.strain, p.stress,
                             p.expansion, p.across, p.iterations);
    for (const FrontPoint& p : found.sets[k].wave.front)
      front += fmt::format("{}\t{:.9g}\t{:.9g}\n", k + 1, p.time, p.place);
  }
  if (found.study.stretch) write_text(directory + "/stretch.tsv", stretch);
  if (found.study.wave) write_text(directory + "/front.tsv", front);
}

void draw_elements(const ElementFindings& found, const std::string& directory) {
  if (found.study.stretch) draw_stretch(found, directory, true), draw_stretch(found, directory, false);
  if (!found.study.wave) return;
  draw_front(found, directory);
  if (!found.sets[0].wave.snapshots.empty()) draw_velocity(found, directory);
}

}  // namespace cuboct
