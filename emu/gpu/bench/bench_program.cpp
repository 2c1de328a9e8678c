// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "emu/gpu/bench/bench_report.h"
#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/resources.h"
#include "model/base/text.h"

namespace cuboct::gpu {
namespace {

struct Request {
  std::string only, json, lines, machine;
  bool list = false, quick = false, no_energy = false;
  int repeats = 0;     // 0: not given
  double seconds = 0;  // 0: not given
  BenchOptions options;
};

// Scenes and states on the host: about 200 bytes a particle, and what the engine takes while it is made.
bool fits_in_memory(uint64_t particles) { return particles < free_memory() / 500; }

// A file that gains a line with each row, so that an interrupted benchmark keeps what it found.
class Lines {
 public:
  explicit Lines(const std::string& path) : path_(path) {
    if (path.empty()) return;
    check_writable(path);
    std::ofstream(path, std::ios::trunc);
  }
  void add(const std::string& text) const {
    if (path_.empty()) return;
    std::ofstream out(path_, std::ios::app);
    if (!(out << text << std::flush)) throw InputError(fmt::format("cannot write {}", path_));
  }

 private:
  std::string path_;
};

std::vector<Device> devices_of(const Request& request, const BenchMachine& machine, std::string* why) {
  const std::vector<Device> found = machine.devices(why);
  std::vector<Device> chosen;
  if (found.empty()) return chosen;
  for (const int ordinal : request.options.engine.devices) {
    const auto is = [&](const Device& device) { return device.ordinal == ordinal; };
    const auto at = std::find_if(found.begin(), found.end(), is);
    if (at == found.end())
      throw InputError(
          fmt::format("--devices: there is no CUDA device {}", ordinal),
          found.size() == 1 ? "there is one, 0" : fmt::format("there are {}, from 0", found.size()));
    if (std::none_of(chosen.begin(), chosen.end(), is)) chosen.push_back(*at);
  }
  return chosen;
}

// Whether all rows went well.
bool run_rows(const Request& request, const std::vector<BenchRow>& rows, const BenchMachine& machine,
              BenchSetting setting, PowerMeter& power) {
  const Lines json(request.json), lines(request.lines);
  for (const Device& device : setting.devices) setting.bandwidth += machine.copy_bandwidth(device.ordinal);
  fmt::print("{}", table_head(setting));
  std::fflush(stdout);
  json.add(json_line(setting) + "\n");
  std::optional<BenchBody> body;
  bool failed = false;
  const auto leave_out = [&](const BenchRow& row, const std::string& why, const char* word) {
    fmt::print("# {}: {}: {}\n", row.name, word, why);
    json.add(json_left_out(row, why) + "\n");
    lines.add(fmt::format("# {}: {}\n", word, why));
  };
  for (const BenchRow& row : rows) {
    if (interrupted()) break;
    try {
      if (!body || !(body->of() == row.scene)) {
        body.reset();  // before the next one takes its memory
        if (!fits_in_memory(row.scene.particles())) {
          leave_out(row,
                    fmt::format("{} particles do not fit into the host's free memory", row.scene.particles()),
                    "skipped");
          continue;
        }
        body.emplace(row.scene);
      }
      const auto result = measure_row(row, *body, setting.options, machine, power);
      if (!result) break;
      fmt::print("{}", table_line(setting, row, *result));
      json.add(json_line(setting, row, *result) + "\n");
      lines.add(value_lines(setting, *result));
      if (!result->energy && setting.no_energy.empty())
        fmt::print("# {}: no energy: {}\n", row.name, result->no_energy);
    } catch (const InputError& e) {  // too large for the devices, say
      leave_out(row, parts_of(e).message, "skipped");
    } catch (const std::exception& e) {
      leave_out(row, line_text(e.what()), "failed");
      failed = true;
    }
    std::fflush(stdout);
  }
  if (interrupted()) fmt::print("# interrupted\n");
  return !failed && !interrupted();
}

int run(const Request& request, const BenchMachine& machine) {
  if (request.list) {
    for (const BenchRow& row : bench_rows()) fmt::print("{:<18} {}\n", row.name, row.what);
    return 0;
  }
  BenchSetting setting;
  setting.options = request.options;
  BenchOptions& options = setting.options;
  if (request.quick) options.repeats = 3, options.seconds = 0.1, options.energy = false;
  if (request.repeats > 0) options.repeats = request.repeats;
  if (request.seconds > 0) options.seconds = request.seconds;
  if (request.no_energy) options.energy = false;
  std::vector<BenchRow> rows = choose_rows(bench_rows(), request.only);
  if (request.quick && request.only.empty())
    std::erase_if(rows, [](const BenchRow& row) { return row.scene.cells > 40; });
  std::string why;
  setting.devices = devices_of(request, machine, &why);
  if (!request.machine.empty()) {
    write_text(request.machine,
               setting.devices.empty() ? fmt::format("none: {}\n", why) : json_line(setting) + "\n");
    return 0;
  }
  if (setting.devices.empty()) throw InputError("no GPU: " + why);
  std::vector<std::string> buses;
  for (const Device& device : setting.devices) buses.push_back(device.bus);
  PowerMeter power(buses, machine.nvml, *machine.clock);
  setting.driver = power.driver();
  setting.no_energy = options.energy ? power.why() : "not asked for";
  catch_interrupts();
  return run_rows(request, rows, machine, std::move(setting), power) ? 0 : 1;
}

}  // namespace

int run_bench(int argc, char** argv, const BenchMachine& machine) {
  Request request;
  BenchOptions& options = request.options;
  Command app("cuboct-gpu bench", "Measures how fast the GPU engines are, and what energy they take");
  app.option("--only", request.only, "A row, or its first words; all without it", "NAME");
  app.flag("--list", request.list, "Name the rows");
  app.option("--devices", options.engine.devices, "GPUs, one per slab: 0,1").delimiter(',').show_default();
  app.option("--block", options.engine.block, "Threads of a block, a multiple of 32 up to 256")
      .show_default();
  app.option("--repeats", request.repeats, "Of which the median is told; 5, quick: 3").range(1, 1000);
  app.option("--seconds", request.seconds, "Least length of a repeat; 0.3, quick: 0.1").range(1e-3, 1e4);
  app.option("--settle", options.settle, "Steps before the timing; a melt's 1000, others' 100 without it");
  app.flag("--quick", request.quick, "Short repeats, no energies, the smallest size unless --only names one");
  app.flag("--no-energy", request.no_energy, "Measure no energies");
  app.option("--window", options.times.window, "Least length of the time whose energy is measured, s")
      .range(0.5, 1e4)
      .show_default();
  app.option("--json", request.json,
             "Also write a line of JSON for the machine and for each row to this file");
  app.option("--lines", request.lines, "Also write 'name value unit' lines to this file");
  app.option("--machine", request.machine, "Write to this file what the devices are, and end");
  return run_command_line(app, argc, argv, [&] {
    if (options.engine.block % 32 != 0 || options.engine.block < 32 || options.engine.block > 256)
      throw InputError(fmt::format("--block {}: not a multiple of 32 from 32 to 256", options.engine.block));
    return run(request, machine);
  });
}

}  // namespace cuboct::gpu
