// SPDX-License-Identifier: MIT
#include "emu/gpu/lps/lps_bench.h"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

#include "emu/gpu/bench/bench.h"
#include "emu/gpu/lps/lps_compare.h"
#include "emu/gpu/messages.h"
#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/real/rounds_engine.h"
#include "model/scene/scene.h"

namespace cuboct::gpu {
namespace {

struct LpsRequest {
  std::string scene, precision = "both", points;
  uint64_t steps = 0, compared = 10;
  std::optional<uint64_t> from;
  int device = 0, block = 128, repeats = 3, rows = 20, threads = 0;
  double damaged = 0.25;
  bool no_energy = false;
  EnergyTimes times;
};

// A scene, and its reference, whose bonds the device takes.
struct Case {
  Scene scene;
  std::unique_ptr<RealEngine> reference;
  int threads;

  Case(const LpsRequest& request) : scene(read_scene(request.scene)) {
    if (scene.rule.rounds == nullptr)
      throw InputError(fmt::format("{}: its rule has pairs alone", request.scene),
                       "cuboct-gpu lps runs scenes with [rule] kind = \"lps\"");
    if (scene.loading)
      throw InputError(fmt::format("{}: static loading is not for a GPU's peridynamic solid", request.scene));
    threads = request.threads > 0 ? request.threads : reference_threads(scene.body.size());
    reference =
        make_rounds_engine(scene.rule, scene.packing(), scene.periodic, RealOptions{.threads = threads});
  }
  const LpsTerms& terms() const { return lps_terms_of(*reference); }
  double bonds() const { return static_cast<double>(terms().bonds()); }
};

void print_lps(const std::string& name, double value, const char* unit) {
  fmt::print("lps.{} {:.6g} {}\n", name, value, unit);
  std::fflush(stdout);
}

// Where points are damaged: their number, and the box around them as packed.
void print_crack(const std::string& name, const Case& of, LpsDevice& device, double least) {
  const std::vector<double> damage = device.damage();
  size_t count = 0;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (size_t i = 0; i < damage.size(); ++i) {
    if (damage[i] < least) continue;
    const Vec3& x = of.scene.packing().x[i];
    ++count, low = low.cwiseMin(x), high = high.cwiseMax(x);
  }
  fmt::print("lps.{}.crack {:.6g} s {} points", name,
             static_cast<double>(device.step_count()) * of.scene.rule.dt, count);
  if (count > 0)
    fmt::print(" from ({:.5g}, {:.5g}, {:.5g}) to ({:.5g}, {:.5g}, {:.5g}) m", low[0], low[1], low[2],
               high[0], high[1], high[2]);
  fmt::print("\n");
  std::fflush(stdout);
}

void write_points(const std::string& path, const Case& of, LpsDevice& device) {
  const std::vector<double> damage = device.damage();
  auto out = fmt::output_file(path);
  out.print("x\ty\tz\tdamage\n");
  for (size_t i = 0; i < damage.size(); ++i) {
    const Vec3& x = of.scene.packing().x[i];
    if (damage[i] > 0.01) out.print("{:.5g}\t{:.5g}\t{:.5g}\t{:.3f}\n", x[0], x[1], x[2], damage[i]);
  }
}

// Whole runs from the start, each `steps` long. False: an interrupt came.
bool time_runs(const LpsRequest& request, const std::string& name, const Case& of, LpsDevice& device,
               const Device& at, uint64_t steps) {
  PowerMeter power({at.bus});
  EnergyMeter meter(power, request.times);
  if (!request.no_energy) meter.idle();
  std::vector<double> seconds;
  const auto run = [&] {
    device.start();
    const double begin = steady_clock().now();
    device.advance(steps);
    meter.did(steps);
    return steady_clock().now() - begin;
  };
  run();  // the first one warms the device up
  while (static_cast<int>(seconds.size()) < request.repeats && !interrupted()) seconds.push_back(run());
  while (!request.no_energy && power.works() && !meter.enough() && !interrupted()) run();
  if (interrupted()) return false;
  const double updates = of.bonds() * static_cast<double>(steps);
  print_lps(name + ".bond_updates_per_second", updates / median(seconds), "1/s");
  print_lps(name + ".slowest_repeat", updates / *std::max_element(seconds.begin(), seconds.end()), "1/s");
  print_lps(name + ".steps_per_second", static_cast<double>(steps) / median(seconds), "1/s");
  print_lps(name + ".run", median(seconds), "s");
  std::string why;
  if (const auto energy = request.no_energy ? std::nullopt : meter.finish(&why)) {
    const double per_step = energy->joules() / static_cast<double>(energy->steps);
    print_lps(name + ".joules_per_bond_update", per_step / of.bonds(), "J");
    print_lps(name + ".energy_of_run", per_step * static_cast<double>(steps), "J");
    print_lps(name + ".power", energy->power.watts, "W");
  } else if (!request.no_energy) {
    fmt::print("# no energy: {}\n", why);
  }
  return true;
}

// A run with looks at its cracks, and, where it is asked for, beside the reference from some step on.
void follow(const LpsRequest& request, const std::string& name, Case& of, LpsDevice& device, uint64_t steps) {
  const uint64_t from = std::min(request.from.value_or(steps / 2), steps);
  device.start();
  device.advance(from);
  if (request.compared > 0) {
    double seconds = 0;
    const LpsErrors off = lps_errors(device, *of.reference, of.scene.packing(), request.compared, &seconds);
    fmt::print("# beside the reference in doubles, {} threads, steps {} to {}\n", of.threads, from,
               from + request.compared);
    print_lps(name + ".displacement_error", off.displacement, "1");
    print_lps(name + ".velocity_error", off.velocity, "1");
    print_lps(name + ".dilatation_error", off.dilatation, "1");
    print_lps(name + ".damage_error", off.damage, "1");
    print_lps("reference.bond_updates_per_second",
              of.bonds() * static_cast<double>(request.compared) / seconds, "1/s");
  }
  device.start();
  for (int row = 1; row <= request.rows && !interrupted(); ++row) {
    const uint64_t to = steps * static_cast<uint64_t>(row) / static_cast<uint64_t>(request.rows);
    device.advance(to - device.step_count());
    print_crack(name, of, device, request.damaged);
  }
}

int run(const LpsRequest& request) {
  const Device at = device_at(request.device);
  Case of(request);
  const uint64_t steps = request.steps > 0 ? request.steps : of.scene.steps;
  catch_interrupts();
  for (const std::string name : {"float", "double"}) {
    if (request.precision != "both" && request.precision != name) continue;
    const auto device =
        make_lps_device(of.scene.rule, of.scene.body, of.scene.packing().x, of.terms(),
                        {.doubles = name == "double", .device = request.device, .block = request.block});
    fmt::print("# {}: {} points, {} bonds of {} kinds, {} steps of {:.6g} s, {}, {} bytes\n", at.name,
               of.scene.body.size(), of.terms().bonds(), device->kinds(), steps, of.scene.rule.dt, name,
               device->device_bytes());
    if (!time_runs(request, name, of, *device, at, steps)) return 1;
    follow(request, name, of, *device, steps);
    if (interrupted()) return 1;
    if (!request.points.empty()) write_points(request.points + "." + name + ".tsv", of, *device);
  }
  return 0;
}

void add_options(Command& app, LpsRequest& request) {
  app.option("SCENE", request.scene, "A scene with [rule] kind = \"lps\"").required();
  app.option("--precision", request.precision, "float, double or both")
      .one_of({"float", "double", "both"})
      .show_default();
  app.option("--steps", request.steps, "Of a run; the scene's own number without it");
  app.option("--repeats", request.repeats, "Runs, of which the median is told").range(1, 1000).show_default();
  app.option("--compare", request.compared, "Steps beside the reference in doubles; 0: none").show_default();
  app.option("--from", request.from, "The step from which on; half of the run without it");
  app.option("--threads", request.threads, "Of the reference; as many as pay without it");
  app.option("--rows", request.rows, "Looks at the cracks along the run").range(0, 100000).show_default();
  app.option("--damaged", request.damaged, "The damage from which on a point is part of a crack")
      .range(0.0, 1.0)
      .show_default();
  app.option("--points", request.points, "Begin of the files of damaged points: NAME.float.tsv");
  app.option("--device", request.device, "CUDA's ordinal").show_default();
  app.option("--block", request.block, "Threads of a block").one_of({32, 64, 128, 256}).show_default();
  app.flag("--no-energy", request.no_energy, "Measure no energies");
}

}  // namespace

int run_lps_bench(int argc, char** argv) {
  LpsRequest request;
  Command app("cuboct-gpu lps", "Runs a linear peridynamic solid on a GPU, and measures it");
  add_options(app, request);
  return run_command_line(app, argc, argv, [&] { return run(request); });
}

}  // namespace cuboct::gpu
