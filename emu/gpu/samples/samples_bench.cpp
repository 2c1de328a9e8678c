// SPDX-License-Identifier: MIT
#include "emu/gpu/samples/samples_bench.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "emu/gpu/bench/bench.h"
#include "emu/gpu/messages.h"
#include "emu/gpu/samples/samples.h"
#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "model/atoms/bond_order/tersoff_parameters.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"

namespace cuboct::gpu {
namespace {

struct SamplesRequest {
  std::string set = "si_erhart_albe", precision = "float";
  int cubes = 2, samples = 4224, device = 0, repeats = 5;
  double seconds = 0.3, tolerance = 1e-3;
  bool no_energy = false;
  EnergyTimes times;
};

constexpr double kStep = 1;        // fs
constexpr double kMass = 28.0855;  // u, of silicon
constexpr double kStiffness = 25;  // eV/angstrom^2, above an atom's in silicon; diamond's is three times that
constexpr double kShake = 0.02;    // angstrom, standard deviation along an axis
constexpr double kStrain = 0.01;   // that of each component of a sample's strain
constexpr double kEdges[] = {5.43, 3.57};  // angstrom, of the cubes of silicon and diamond

// Each strained and shaken in its own way.
std::vector<AtomCell> samples_of(const SamplesRequest& request) {
  const bool carbon = request.set.front() == 'c';
  const AtomCell perfect = diamond_block(kEdges[carbon], request.cubes, request.cubes, request.cubes);
  std::vector<AtomCell> samples;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int s = 0; s < request.samples; ++s) {
    Mat3 strain;
    for (double& component : strain.reshaped()) component = kStrain * normal(random);
    AtomCell& sample = samples.emplace_back(strained(perfect, strain));
    for (Vec3& x : sample.x) x += kShake * Vec3(normal(random), normal(random), normal(random));
  }
  return samples;
}

struct Errors {
  double force = 0, stress = 0;
};

// Of a few samples, beside doubles at the same positions: the largest difference of a component over the
// largest component.
Errors errors_of(const Samples& samples, const std::vector<AtomCell>& cells, const Tersoff& tersoff) {
  constexpr size_t kCompared = 16;
  constexpr int kAxes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  const std::vector<Vec3> x = samples.positions(), f = samples.forces();
  const std::vector<SampleState> states = samples.states();
  TersoffForces exact(tersoff);
  double force = 0, most_force = 0, virial = 0, most_virial = 0;
  const size_t atoms = cells.front().x.size();
  for (size_t s = 0; s < std::min(kCompared, cells.size()); ++s) {
    const std::span<const Vec3> at(x.data() + s * atoms, atoms);
    std::vector<Vec3> beside(atoms);
    BondList list(tersoff.cutoff(), 0.3, bond_lanes());
    list.update(cells[s].box, at);
    exact.evaluate(list, cells[s].box, at, beside, {.sums = true});
    for (size_t i = 0; i < atoms; ++i) {
      force = std::max(force, (beside[i] - f[s * atoms + i]).cwiseAbs().maxCoeff());
      most_force = std::max(most_force, beside[i].cwiseAbs().maxCoeff());
    }
    for (size_t k = 0; k < 6; ++k) {
      const double value = exact.virial()(kAxes[k][0], kAxes[k][1]);
      virial = std::max(virial, std::abs(states[s].virial[k] - value));
      most_virial = std::max(most_virial, std::abs(value));
    }
  }
  return {force / most_force, virial / most_virial};
}

double timed(const std::function<void()>& work) {
  const double begin = steady_clock().now();
  work();
  return steady_clock().now() - begin;
}

// Steps that take about `seconds`.
uint32_t steps_for(Samples& samples, double seconds) {
  uint32_t steps = 16;
  while (true) {
    const double took = timed([&] { samples.advance(steps, kStep, kMass); });
    if (took >= seconds / 4 || interrupted()) return static_cast<uint32_t>(1.1 * steps * seconds / took) + 1;
    steps *= 4;
  }
}

void print_samples(const char* name, double value, const char* unit) {
  fmt::print("samples.{} {:.6g} {}\n", name, value, unit);
  std::fflush(stdout);
}

int run(const SamplesRequest& request) {
  const Tersoff tersoff = tersoff_set(request.set);
  const Device device = device_at(request.device);
  const std::vector<AtomCell> cells = samples_of(request);
  const std::unique_ptr<Samples> samples = make_samples(
      tersoff.term(0, 0, 0), {.doubles = request.precision == "double", .device = request.device});
  PowerMeter power({device.bus});
  samples->set(cells);
  const size_t atoms = cells.size() * cells.front().x.size();
  fmt::print("# {}: {} samples of {} atoms, {}, {}, {} bytes of a block's memory each\n", device.name,
             cells.size(), cells.front().x.size(), request.set, request.precision, samples->block_bytes());
  catch_interrupts();
  EnergyMeter meter(power, request.times);
  if (!request.no_energy) meter.idle();

  // Molecular dynamics at constant energy.
  samples->evaluate();
  const uint32_t steps = steps_for(*samples, request.seconds);
  std::vector<double> seconds;
  while (static_cast<int>(seconds.size()) < request.repeats && !interrupted()) {
    seconds.push_back(timed([&] { samples->advance(steps, kStep, kMass); }));
    meter.did(steps);
  }
  while (!request.no_energy && power.works() && !meter.enough() && !interrupted()) {
    samples->advance(steps, kStep, kMass);
    meter.did(steps);
  }
  if (interrupted()) return 1;
  const double work = static_cast<double>(atoms) * steps;
  print_samples("atom_steps_per_second", work / median(seconds), "1/s");
  print_samples("slowest_repeat", work / *std::max_element(seconds.begin(), seconds.end()), "1/s");
  std::string why;
  if (const auto energy = request.no_energy ? std::nullopt : meter.finish(&why)) {
    print_samples("joules_per_atom_step", energy->per_particle_step(atoms), "J");
    print_samples("power", energy->power.watts, "W");
  } else if (!request.no_energy) {
    fmt::print("# no energy: {}\n", why);
  }
  const Errors moving = errors_of(*samples, cells, tersoff);
  print_samples("force_error", moving.force, "1");
  print_samples("stress_error", moving.stress, "1");

  // Relaxation of all samples from where they began.
  samples->set(cells);
  const double relaxing = timed([&] { samples->relax(request.tolerance, kStiffness, 10000); });
  double evaluations = 0, largest = 0;
  for (const SampleState& state : samples->states())
    evaluations += state.evaluations, largest = std::max(largest, state.force);
  print_samples("relaxed_per_second", static_cast<double>(cells.size()) / relaxing, "1/s");
  print_samples("evaluations_to_rest", evaluations / static_cast<double>(cells.size()), "1");
  print_samples("force_at_rest", largest, "eV/angstrom");
  print_samples("stress_error_at_rest", errors_of(*samples, cells, tersoff).stress, "1");
  return 0;
}

}  // namespace

int run_samples_bench(int argc, char** argv) {
  SamplesRequest request;
  Command app("cuboct-gpu samples",
              "Measures how fast a GPU computes small periodic samples under Tersoff's potential");
  app.option("--set", request.set, "Parameters: " + fmt::format("{}", fmt::join(tersoff_set_names(), ", ")))
      .show_default();
  app.option("--cubes", request.cubes, "Cubes of eight atoms along each edge").range(1, 8).show_default();
  app.option("--samples", request.samples, "How many").range(1, 1 << 20).show_default();
  app.option("--precision", request.precision, "float or double").one_of({"float", "double"}).show_default();
  app.option("--device", request.device, "CUDA's ordinal").show_default();
  app.option("--repeats", request.repeats, "Of which the median is told").range(1, 1000).show_default();
  app.option("--seconds", request.seconds, "Length of a repeat").range(1e-3, 1e4).show_default();
  app.option("--tolerance", request.tolerance, "Largest force at rest, eV/angstrom")
      .range(1e-9, 1.0)
      .show_default();
  app.flag("--no-energy", request.no_energy, "Measure no energies");
  return run_command_line(app, argc, argv, [&] { return run(request); });
}

}  // namespace cuboct::gpu
