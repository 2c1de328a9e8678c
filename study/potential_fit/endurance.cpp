// SPDX-License-Identifier: MIT
#include "study/potential_fit/endurance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/atom_motion.h"
#include "study/sweep/interrupted.h"

namespace cuboct::bond_fit {
namespace {

constexpr double kBoltzmann = 8.617333262e-5;  // eV/K
constexpr uint64_t kBetween = 100;             // steps between two looks
constexpr double kMostDrift = 0.01;            // of k T
constexpr double kBelow = 1e-6;                // eV per atom
constexpr int kDepth = 3;                      // bonds between an inner atom and a surface
constexpr double kSecondShell = 1.3;           // of the bond; second neighbours begin at 1.63

using Neighbours = std::vector<std::set<size_t>>;

// The nearest image, in a box whose edges lie along the axes.
Vec3 between(const AtomBox& box, const Vec3& a, const Vec3& b) {
  Vec3 d = b - a;
  for (int axis = 0; axis < 3; ++axis)
    if (box.periodic[static_cast<size_t>(axis)])
      d[axis] -= box.edges(axis, axis) * std::round(d[axis] / box.edges(axis, axis));
  return d;
}

Neighbours neighbours_of(const AtomBox& box, const std::vector<Vec3>& x, double reach) {
  Neighbours out(x.size());
  for (size_t i = 0; i < x.size(); ++i)
    for (size_t j = i + 1; j < x.size(); ++j)
      if (between(box, x[i], x[j]).squaredNorm() < reach * reach) out[i].insert(j), out[j].insert(i);
  return out;
}

// Atoms all of whose neighbours, over kDepth bonds, have four.
std::vector<size_t> inner_atoms(const Neighbours& bonds) {
  std::vector<char> inner(bonds.size());
  for (size_t i = 0; i < bonds.size(); ++i) inner[i] = bonds[i].size() == 4;
  for (int depth = 0; depth < kDepth; ++depth) {
    const std::vector<char> before = inner;
    for (size_t i = 0; i < bonds.size(); ++i)
      for (const size_t j : bonds[i]) inner[i] = inner[i] && before[j];
  }
  std::vector<size_t> out;
  for (size_t i = 0; i < inner.size(); ++i)
    if (inner[i]) out.push_back(i);
  return out;
}

// Atoms that hang together with the first.
size_t size_of_body(const Neighbours& bonds) {
  std::vector<char> seen(bonds.size());
  std::vector<size_t> open = {0};
  seen[0] = 1;
  for (size_t at = 0; at < open.size(); ++at)
    for (const size_t j : bonds[open[at]])
      if (!seen[j]) seen[j] = 1, open.push_back(j);
  return open.size();
}

// Maxwell's, by Box and Muller, without a motion as a whole.
std::vector<Vec3> velocities(size_t atoms, const Trial& trial) {
  std::mt19937_64 random(trial.seed);
  const auto even = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  const double width = std::sqrt(kBoltzmann * trial.temperature / trial.mass);
  std::vector<Vec3> v(atoms);
  Vec3 mean = Vec3::Zero();
  for (Vec3& of : v) {
    for (int axis = 0; axis < 3; ++axis)
      of[axis] = width * std::sqrt(-2 * std::log(even())) * std::cos(2 * std::numbers::pi * even());
    mean += of / static_cast<double>(atoms);
  }
  for (Vec3& of : v) of -= mean;
  return v;
}

AtomSystem crystal(double edge, const Trial& trial, size_t boundary) {
  const AtomCell block = diamond_block(edge, trial.cells, trial.cells, trial.cells);
  AtomSystem out{block.box, block.x, velocities(block.x.size(), trial), {}, {trial.mass}};
  for (size_t axis = 0; axis < 3; ++axis) out.box.periodic[axis] = axis + boundary < 3;
  return out;
}

// Figures of a run that has left all numbers behind are 0.
Endured finite(Endured run) {
  if (!std::isfinite(run.temperature)) run.temperature = 0;
  if (!std::isfinite(run.drift)) run.drift = 0;
  return run;
}

std::string fault_of_bonds(const AtomSystem& end, const Neighbours& before, double reach) {
  const Neighbours after = neighbours_of(end.box, end.x, reach);
  if (const size_t left = size_of_body(after); left < end.x.size())
    return fmt::format("the body comes apart: {} of {} atoms hang together", left, end.x.size());
  size_t changed = 0;
  const std::vector<size_t> inner = inner_atoms(before);
  for (const size_t i : inner) changed += after[i] != before[i];
  if (changed == 0) return {};
  return fmt::format("{} of {} inner atoms changed their neighbours", changed, inner.size());
}

}  // namespace

bool Endurance::stable() const {
  return std::ranges::all_of(runs, [](const Endured& run) { return run.fault.empty(); });
}

double Endurance::hottest() const { return std::ranges::max(runs, {}, &Endured::temperature).temperature; }

Endured endure(const Tersoff& tersoff, double edge, const Trial& trial, size_t boundary,
               const std::function<bool()>& stopped) {
  const double bond = std::sqrt(3) / 4 * edge, reach = kSecondShell * bond;
  AtomMotion motion(tersoff, crystal(edge, trial, boundary), {.dt = trial.step});
  const auto atoms = static_cast<double>(motion.atoms().x.size());
  const Neighbours before = neighbours_of(motion.atoms().box, motion.atoms().x, reach);
  AtomSystem whole = crystal(edge, trial, 0);
  const double perfect = AtomMotion(tersoff, whole, {.dt = trial.step}).potential_energy();
  const double begin = motion.potential_energy() + motion.kinetic_energy();
  const auto steps = static_cast<uint64_t>(std::llround(trial.time / trial.step));
  Endured out;
  try {
    while (motion.steps() < steps) {
      if (stopped()) throw study::Interrupted();
      motion.step(std::min(kBetween, steps - motion.steps()));
      const double potential = motion.potential_energy(), kinetic = motion.kinetic_energy();
      out.temperature = 2 * kinetic / (3 * atoms * kBoltzmann);
      out.drift = (potential + kinetic - begin) / atoms;
      const double time = static_cast<double>(motion.steps()) * trial.step;
      if (potential < perfect - kBelow * atoms)
        out.fault = fmt::format("after {:.3g} ps its bonds have less energy than the crystal's", time);
      else if (!(std::abs(out.drift) < kMostDrift * kBoltzmann * trial.temperature))
        out.fault = fmt::format("after {:.3g} ps the energy is off by {:.2g} eV per atom", time, out.drift);
      if (!out.fault.empty()) return finite(out);
    }
  } catch (const std::runtime_error& error) {  // of AtomMotion: a position is not finite
    out.fault = error.what();
    return finite(out);
  }
  out.fault = fault_of_bonds(motion.atoms(), before, reach);
  return out;
}

}  // namespace cuboct::bond_fit
