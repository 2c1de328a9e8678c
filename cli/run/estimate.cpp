// SPDX-License-Identifier: MIT
#include "cli/run/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "cli/run/text_cost.h"
#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"
#include "hw/program/bounds.h"
#include "model/analysis/synopsis.h"
#include "model/base/resources.h"
#include "model/rules/rounds_rule.h"
#include "model/scene/readings.h"
#include "model/trace/trace.h"

namespace cuboct {
namespace {

// Keys that say how many particles and cells there are.
const std::vector<std::string> kOfSize{"packing.pitch", "box.cells", "geometry", "particles.file",
                                       "particle"};

constexpr double kProgram = 20e6;  // bytes, of a process before it has read anything

struct Extent {
  Vec3 size = Vec3::Zero();  // m, of the box around all particles
  double neighbours = 0;     // of a particle within the cutoff, in the mean
};

// Neighbours by density, in a box that is half a pitch or so larger than its particles' centres on either
// side; none are beyond the particles that there are.
Extent extent_of(const Scene& scene, const FixedRule& rule) {
  Extent extent;
  extent.size = body_size(scene);
  const double cutoff = scene.rule.cutoff();
  const double others = static_cast<double>(scene.body.size()) - 1;
  double volume = 1;
  for (int a = 0; a < 3; ++a) volume *= extent.size[a] + 0.6 * cutoff;
  // A packing has its own density, however hollow the body is.
  if (scene.pitch > 0) volume = std::pow(scene.pitch, 3) / std::numbers::sqrt2 * (others + 1);
  double sphere = 4 * std::numbers::pi / 3 * std::pow(cutoff, 3);
  if (rule.axes == 2 && scene.pitch == 0)
    volume /= extent.size[2] + 0.6 * cutoff, sphere = std::numbers::pi * cutoff * cutoff;
  extent.neighbours = std::min(others, (others + 1) * sphere / volume);
  return extent;
}

// Of a picture of the body, as raster_grid cuts it.
double pixels_of(const Scene& scene, const Extent& extent, uint32_t across) {
  std::array<double, 3> sides{extent.size[0], extent.size[1], extent.size[2]};
  std::ranges::sort(sides);
  const double radius = (scene.pitch > 0 ? scene.pitch : scene.rule.cutoff()) / 2;
  const double pixel = std::max((sides[2] + 2 * radius) / across, radius / 2);
  return ((sides[2] + 2 * radius) / pixel) * ((sides[1] + 2 * radius) / pixel);
}

// As every_so_often lists them.
double count_every(uint64_t every, uint64_t steps) {
  if (every == 0 || steps <= every) return steps > 0 ? 2 : 1;
  return 1 + std::ceil(static_cast<double>(steps) / static_cast<double>(every));
}

// A number of steps between two of something, in one or two digits, that makes at most `most` of them.
uint64_t round_interval(uint64_t steps, double most) {
  const double least = static_cast<double>(steps) / std::max(1.0, most - 2);
  const double ten = std::pow(10, std::floor(std::log10(std::max(1.0, least))));
  return static_cast<uint64_t>(std::ceil(least / ten) * ten);
}

// A rule of rounds keeps its bonds from the start: a neighbour is one, with all rounds and all that it keeps.
// Times are those of the linear peridynamic solid with 17 bonds a particle, on one core of an EPYC: where
// none breaks, and while an eighth of them does. Bonds of the moment are those of Tersoff's potential in a
// sheet of carbon. A rule that is text: by its operations.
EngineCost cost_of(const EngineRow& engine, const Scene& scene, double neighbours) {
  EngineCost cost = engine.cost;
  const RoundsRule* rounds = scene.rule.rounds.get();
  if (rounds == nullptr || engine.here != Here::reference) return cost;
  const bool breaks = std::isfinite(rounds->bond_reach());
  cost.neighbour_time = breaks ? 38e-9 : 13e-9, cost.neighbour = 70;
  if (rounds->declaration().bonds == BondRange::current) cost.neighbour_time = 10e-9;
  if (const RuleProgram* text = rounds->text()) {
    const TextCost of_text = text_cost(*text);
    // Where a particle has few neighbours its finishes count.
    cost.neighbour_time = of_text.neighbour + of_text.particle / std::max(1.0, neighbours);
  }
  return cost;
}

// Of a step, s, and of a particle: the lattice engine takes eight particles at a time with all that is near
// any of them. So few neighbours cost as much as 23, or each of them as 4.5. Templates on one thread of an
// EPYC: 50 ns in `sheet`, 90 in `tension`, 100 in `gas`, 200 in `metal` with its 55 neighbours.
double particle_time(const EngineRow& engine, const Scene& scene, double neighbours) {
  const double rate = cost_of(engine, scene, neighbours).neighbour_time;
  if (engine.here != Here::lattice) return rate * std::max(4.0, neighbours);
  return rate * std::max({4.0, neighbours, std::min(4.5 * neighbours, 23.0)});
}

// Of the lattice engine's lists, s of a run: one is made anew when the fastest particle has gone some quarter
// of a cell. Template `impact`: 227 of them, of 7636 particles in 233,000 cells, in 3.3 s.
double lists_time(const EngineRow& engine, const Scene& scene, const Plan& plan, double steps) {
  constexpr double kWay = 0.25, kParticle = 1e-6, kCell = 30e-9;
  if (engine.here != Here::lattice) return 0;
  double fastest = 0;  // m/s
  for (const Vec3& v : scene.body.v) fastest = std::max(fastest, v.norm());
  for (const ParticleType& type : scene.rule.types) fastest = std::max(fastest, type.velocity.norm());
  const double way = fastest * scene.rule.dt * steps / plan.rule.cell_edge;
  return way / kWay * (kParticle * plan.particles + kCell * plan.lattice.size());
}

// Of one reading of energies, s: a list of near pairs, the energies of all particles and pairs in doubles,
// and the watch's look at them. On an EPYC under the load of others, all readings of a run less those of the
// probes: 0.24 us a particle in the template `sheet`, 0.37 in `tension`, 0.6 in `drop`, 0.7 in `gas`, 1.1 in
// `metal`. Engines that do not hand on the sums of their pairs take a step's time for those.
double energies_time(const EngineRow& engine, const Scene& scene, double particles, double neighbours) {
  constexpr double kParticle = 300e-9, kPair = 10e-9;
  const double sums =
      engine.here == Here::lattice ? 0 : cost_of(engine, scene, neighbours).neighbour_time * neighbours;
  return particles * (kParticle + kPair * neighbours / 2 + sums);
}

// Of one reading of the probes, s. The lattice engine looks for the largest speed among all particles; others
// make a state of them.
double probes_time(const EngineRow& engine, const Scene& scene, double particles, double neighbours) {
  constexpr double kParticle = 2e-9, kState = 40e-9, kProbed = 40e-9, kPair = 10e-9;
  // Fields that go on from step to step are there as they are.
  const bool sums = std::ranges::any_of(scene.probes, [](const Probe& probe) {
    using enum Probe::Kind;
    return probe.kind != displacement && probe.kind != field && probe.kind != crack;
  });
  const bool stress =
      std::ranges::any_of(scene.probes, [](const Probe& probe) { return probe.kind == Probe::Kind::stress; });
  double probed = 0;
  for (const Probe& probe : scene.probes)
    for (const ParticleSet* set : {&probe.set, &probe.lower, &probe.upper, &probe.grip})
      probed += static_cast<double>(set->ids.size());
  const double of_sums = sums ? cost_of(engine, scene, neighbours).neighbour_time * neighbours : 0;
  double each = engine.here == Here::lattice ? kParticle : kState + of_sums;
  if (stress) each += kState + 2 * kPair * neighbours;
  return particles * each + probed * kProbed;
}

}  // namespace

RunSize run_size(const Scene& scene, uint64_t steps) {
  const Readings readings = readings_of(scene, steps);
  RunSize size;
  size.engine = engine_for(scene);
  size.steps = steps;
  size.frame_every = scene.frame_every;
  size.probe_every = readings.probes;
  size.energy_every = readings.energies;
  return size;
}

Estimate estimate(const Scene& scene, const Plan& plan, const RunSize& size) {
  const EngineRow& engine = engine_row(size.engine);
  const Extent extent = extent_of(scene, plan.rule);
  const EngineCost rates = cost_of(engine, scene, extent.neighbours);
  const double particles = plan.particles, cells = plan.lattice.size(),
               steps = static_cast<double>(size.steps);
  Estimate e;
  // How many evaluations bring a body to rest is not known before.
  if (scene.loading) e.load_steps = size.steps / scene.loading->every;
  const double rounds = scene.loading ? 1 : steps;
  e.particle_steps = particles * rounds;
  if (rates.neighbour_time > 0) {
    constexpr double kEach = 1000;  // fewer particles are not worth a thread
    e.threads = rates.threads
                    ? std::clamp(size.threads > 0 ? size.threads : static_cast<int>(particles / kEach), 1,
                                 usable_cores())
                    : 1;
    if (size.ranks > 1) e.threads = std::min(size.ranks * std::max(1, size.threads), usable_cores());
    // Cells at rest cost something too: one thread passes over them.
    e.seconds = (e.particle_steps * particle_time(engine, scene, extent.neighbours) +
                 lists_time(engine, scene, plan, rounds)) /
                    e.threads +
                rounds * cells * rates.cell_time;
    e.rate = e.seconds > 0 ? e.particle_steps / (e.seconds * e.threads) : 0;
  }

  const double samples = size.probe_every > 0 ? count_every(size.probe_every, size.steps) : 0;
  const double of_energies = count_every(size.energy_every, size.steps);
  if (e.seconds > 0 && !scene.loading) {
    e.probing = samples * probes_time(engine, scene, particles, extent.neighbours);
    e.energy_readings = of_energies;
    e.energies = of_energies * energies_time(engine, scene, particles, extent.neighbours);
    e.seconds += e.probing + e.energies;
  }

  constexpr double kCurvePoint = sizeof(uint64_t) + sizeof(double), kEnergies = 6, kOfProbe = 3;
  const double hashes = size.hash_every > 0 ? count_every(size.hash_every, size.steps) : 0;
  e.hashes = hashes * sizeof(uint64_t);
  e.samples =
      (of_energies * kEnergies + samples * kOfProbe * static_cast<double>(scene.probes.size())) * kCurvePoint;
  const bool cycles = size.cycles || engine.cycles;
  e.spans = cycles ? steps * static_cast<double>(spans_of_step(plan)) * sizeof(PhaseSpan) : 0;
  // Each rank reads the scene and keeps its lattice.
  constexpr double kRead = 64, kRank = 40e6;
  e.memory = kProgram + particles * (rates.particle + rates.neighbour * extent.neighbours) +
             cells * rates.cell +
             (size.ranks > 1 ? size.ranks * (kRank + kRead * particles + 70 * cells) : 0) + e.hashes +
             e.samples + e.spans;

  // Per particle a line of XYZ, a record of VTK and, packed, of the trace.
  constexpr double kXyz = 145, kVtk = 66, kState = 15, kPixel = 1, kSpan = 1.5;
  e.frames = count_every(size.frame_every, size.steps);
  e.frame =
      kPixel * pixels_of(scene, extent, size.raster) + (size.states ? particles * (kXyz + kVtk + kState) : 0);
  const double rest = e.hashes + e.samples + e.spans / sizeof(PhaseSpan) * kSpan;
  // The journal of checkpoints has each frame in whole words, and the rest; a checkpoint is there twice while
  // it is written.
  if (size.checkpoints) {
    constexpr double kWords = 80;  // of a particle
    e.checkpoints = rest + particles * kWords * (2 + e.frames);
  }
  e.disk = e.frames * e.frame + rest + e.checkpoints;
  return e;
}

void add_estimate(Items& items, const Estimate& e) {
  if (e.load_steps > 0)
    items.add("load steps", e.load_steps);
  else
    items.add("particle-steps", e.particle_steps);
  if (e.seconds > 0 && e.load_steps > 0)
    items.add("time per evaluation", e.seconds, "s",
              fmt::format("an estimate, on {} thread{}; a load step takes as many evaluations of forces as "
                          "bring the body to rest",
                          e.threads, e.threads == 1 ? "" : "s"));
  else if (e.seconds > 0)
    items.add(
        "time", e.seconds, "s",
        fmt::format("an estimate: {:.2g} particle-steps/s on {} thread{}, and {:.2g} s for readings; what "
                    "rests costs less",
                    e.rate * e.threads, e.threads, e.threads == 1 ? "" : "s", e.probing + e.energies));
  items.add("memory", static_cast<uint64_t>(e.memory), "B",
            fmt::format("an estimate: {}", in_bytes(e.memory)));
  items.add("disk", static_cast<uint64_t>(std::min(e.disk, 9e18)), "B",
            fmt::format("an estimate: {} in the directory of a run, {:.6g} frames of {}", in_bytes(e.disk),
                        e.frames, in_bytes(e.frame)));
}

void check_lists(const Scene& scene, const RunSize& size, bool frames_given) {
  constexpr double kMost = 1e7;
  const auto refuse = [&](bool option, const char* key, uint64_t every) {
    if (every == 0 || count_every(every, size.steps) <= kMost) return;
    const uint64_t would_do = round_interval(size.steps, 0.5 * kMost);
    const std::string text = fmt::format("every {} of {} steps are {:.0f}: at most {:.0f} can be kept", every,
                                         size.steps, count_every(every, size.steps), kMost);
    if (option) throw InputError("--frame-every: " + text, fmt::format("--frame-every {}", would_do));
    scene.places.fail({fmt::format("run.{}", key), "run.duration", "run.steps"},
                      fmt::format("{}: {}", key, text), fmt::format("{} = {}", key, would_do));
  };
  refuse(frames_given, "frame_every", size.frame_every);
  // Without probes the energies have an interval of their own.
  refuse(false, gives(scene, "probe_every") ? "probe_every" : "energy_every", size.probe_every);
}

namespace {

void check_run_memory(const Scene& scene, const RunSize& size, const Estimate& e) {
  const double free = static_cast<double>(free_memory());
  if (e.memory <= free) return;
  const std::string text =
      fmt::format("the run takes about {} of memory: {} are free", in_bytes(e.memory), in_bytes(free));
  const double rest = e.memory - e.hashes - e.spans - e.samples;
  const double left = std::max(0.0, free - rest);
  if (rest < free && e.spans >= std::max(e.hashes, e.samples))
    throw InputError(
        fmt::format("{}, {} of it for the cycles of {} steps", text, in_bytes(e.spans), size.steps),
        fmt::format("--steps {:.0f}{}", std::floor(0.9 * static_cast<double>(size.steps) * left / e.spans),
                    kAnyway));
  if (rest < free && e.hashes >= e.samples)
    throw InputError(
        fmt::format("{}, {} of it for a hash every {} steps of {}", text, in_bytes(e.hashes), size.hash_every,
                    size.steps),
        fmt::format("--hash-every {}{}", round_interval(size.steps, 0.5 * left / sizeof(uint64_t)), kAnyway));
  if (rest < free)
    scene.places.fail({"run.probe_every", "run.duration", "run.steps"},
                      fmt::format("{}, {} of it for curves", text, in_bytes(e.samples)),
                      std::string("a larger probe_every") + kAnyway);
  scene.places.fail(kOfSize, text,
                    (size.ranks > 1 ? std::string("fewer ranks, ") : std::string()) +
                        "a larger pitch or a smaller geometry" + kAnyway);
}

void check_run_disk(const Scene& scene, const RunSize& size, const Estimate& e, const std::string& out) {
  const double disk = static_cast<double>(free_disk(out.empty() ? "." : out));
  if (out.empty() || e.disk <= disk) return;
  const std::string checkpoints =
      e.checkpoints > 0 ? fmt::format(" and {} for checkpoints", in_bytes(e.checkpoints)) : std::string();
  const std::string text =
      fmt::format("the run takes about {} of disk, {:.6g} frames of {} each{}: {} are free in {}",
                  in_bytes(e.disk), e.frames, in_bytes(e.frame), checkpoints, in_bytes(disk), out);
  const double most = 0.9 * (disk - (e.disk - e.frames * e.frame)) / e.frame;
  const std::string hint =
      (most >= 3 && size.steps > 2
           ? fmt::format("{} {}", size.frame_every == scene.frame_every ? "frame_every =" : "--frame-every",
                         round_interval(size.steps, most))
           : std::string("--no-states keeps pictures alone")) +
      kAnyway;
  // The command line's own wish has no place in the file.
  if (size.frame_every != scene.frame_every) throw InputError(text, hint);
  scene.places.fail({"run.frame_every", "packing.pitch", "geometry", "box"}, text, hint);
}

void check_run_time(const Scene& scene, const RunSize& size, const Estimate& e) {
  if (e.seconds <= kMostSeconds) return;
  const std::string text =
      fmt::format("the run takes about {}: {:.3g} particle-steps on {} thread{}", long_time(e.seconds),
                  e.particle_steps, e.threads, e.threads == 1 ? "" : "s");
  const std::string hint =
      fmt::format("{:.0f} steps would take a day{}",
                  std::max(1.0, std::floor(86400 * static_cast<double>(size.steps) / e.seconds)), kAnyway);
  if (size.steps != scene.steps) throw InputError(text, hint);
  scene.places.fail({"run.duration", "run.steps"}, text, hint);
}

}  // namespace

void check_fits(const Scene& scene, const RunSize& size, const Estimate& e, const std::string& out) {
  check_run_memory(scene, size, e);
  check_run_disk(scene, size, e, out);
  check_run_time(scene, size, e);
}

void check_counted(const std::string& option, const std::string& engine, const Scene& scene, const Plan& plan,
                   uint64_t steps, bool anyway) {
  RunSize size;
  size.engine = engine, size.steps = steps, size.hash_every = 0;
  const double seconds = estimate(scene, plan, size).seconds;
  if (seconds > kMostSeconds)
    check_time(fmt::format("{} {}", option, steps), seconds,
               fmt::format("{} {:.0f} takes a day", option,
                           std::max(1.0, std::floor(86400 * static_cast<double>(steps) / seconds))),
               anyway);
}

void check_held(const Scene& scene, const Plan& plan, bool anyway) {
  if (anyway) return;
  RunSize size;
  size.hash_every = 0;
  const double memory = estimate(scene, plan, size).memory, free = static_cast<double>(free_memory());
  if (memory > free)
    scene.places.fail(
        kOfSize,
        fmt::format("the machine takes about {} of memory: {} are free", in_bytes(memory), in_bytes(free)),
        std::string("a larger pitch or a smaller geometry") + kAnyway);
}

void check_workers(int threads, int ranks, bool anyway, const Plan& plan) {
  check_workers("--threads", threads, anyway);
  const int most = most_workers();
  // Under a scheduler of jobs, or with a list of hosts, ranks run elsewhere too.
  const auto set = [](const char* name) { return std::getenv(name) != nullptr; };
  const bool elsewhere = anyway || set("SLURM_JOB_ID") || set("PBS_JOBID") || set("LSB_JOBID") ||
                         set("OMPI_MCA_orte_default_hostfile");
  const auto nodes = static_cast<int>(std::min<uint32_t>(plan.nodes(), 1 << 30));  // a rank has whole ones
  if (ranks <= 1 || (ranks <= nodes && (ranks <= most || elsewhere))) return;
  throw InputError(
      fmt::format("--ranks {}: {}, and the scene {} node{}", ranks, cores_text(), nodes,
                  nodes == 1 ? "" : "s"),
      fmt::format("--ranks {}{}", std::min(usable_cores(), nodes), ranks <= nodes ? kAnyway : ""));
}

}  // namespace cuboct
