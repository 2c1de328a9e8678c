// SPDX-License-Identifier: MIT
#include "emu/gpu/bench/bench_report.h"

#include <fmt/format.h>

#include <cmath>

#include "model/base/json.h"
#include "model/base/text.h"

namespace cuboct::gpu {
namespace {

// Numbers that JSON cannot hold are null.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null"; }

class JsonLine {
 public:
  JsonLine& add(const char* name, const std::string& json) {
    members_ += fmt::format("{}\"{}\":{}", members_.empty() ? "" : ",", name, json);
    return *this;
  }
  JsonLine& add(const char* name, double value) { return add(name, number(value)); }
  JsonLine& add(const char* name, uint64_t value) { return add(name, std::to_string(value)); }
  JsonLine& add(const char* name, int value) { return add(name, std::to_string(value)); }
  JsonLine& text(const char* name, const std::string& value) { return add(name, json_text(value)); }
  std::string object() const { return fmt::format("{{{}}}", members_); }

 private:
  std::string members_;
};

// "NVIDIA H100", "2 x NVIDIA H100", "A and B".
std::string names_of(const std::vector<Device>& devices) {
  bool alike = true;
  std::string all;
  for (const Device& device : devices) {
    alike = alike && device.name == devices.front().name;
    if (!all.empty()) all += " and ";
    all += device.name;
  }
  if (!alike || devices.size() == 1) return all;
  return fmt::format("{} x {}", devices.size(), devices.front().name);
}

// Bytes that the devices' own copies would move in the time of one particle-step.
double copied(const BenchSetting& setting, const RowResult& result) {
  return setting.bandwidth / result.rate();
}

constexpr int kWidths[] = {18, 9, 7, 10, 10, 5, 6, 6, 6, 7, 9, 9, 5, 5, 5};

std::string table(const std::vector<std::string>& cells) {
  std::string line = fmt::format("{:<{}}", cells[0], kWidths[0]);
  for (size_t k = 1; k < cells.size(); ++k) line += fmt::format(" {:>{}}", cells[k], kWidths[k]);
  return line + "\n";
}

}  // namespace

std::string table_head(const BenchSetting& setting) {
  const BenchOptions& o = setting.options;
  std::string text =
      fmt::format("# {}{}, {} slab{}, blocks of {} threads\n", names_of(setting.devices),
                  setting.driver.empty() ? "" : ", driver " + setting.driver, o.engine.devices.size(),
                  o.engine.devices.size() == 1 ? "" : "s", o.engine.block);
  text += fmt::format("# copies in the devices' memory move {:.4g} GB/s, read and written\n",
                      setting.bandwidth * 1e-9);
  text += fmt::format(
      "# 1/s: particle-steps by the median of {} repeats of {:g} s or more; mean: of all; sd: of their "
      "rates\n",
      o.repeats, o.seconds);
  if (!setting.no_energy.empty())
    text += fmt::format("# no energies: {}\n", setting.no_energy);
  else
    text += fmt::format(
        "# energies of whole boards over {:g} s or more after {:g} s of warm-up; idle: {:g} s before the "
        "work, "
        "after {:g} s at rest; net: less idle\n",
        o.times.window, o.times.warm_up, o.times.idle, o.times.settle);
  return text + table({"row", "particles", "steps", "1/s", "mean", "sd %", "lists", "pairs", "B", "copy B",
                       "J", "net J", "W", "idle", "MHz"});
}

std::string table_line(const BenchSetting& setting, const BenchRow& row, const RowResult& result) {
  const auto& energy = result.energy;
  const auto of_energy = [&](const char* form, double value) {
    return energy ? fmt::format(fmt::runtime(form), value) : std::string("-");
  };
  return table({row.name, std::to_string(result.particles), std::to_string(result.steps),
                fmt::format("{:.4g}", result.rate()), fmt::format("{:.4g}", result.mean_rate()),
                fmt::format("{:.1f}", 100 * result.spread()),
                std::to_string(result.after.list_builds - result.before.list_builds),
                fmt::format("{:.1f}", result.after.listed_pairs),
                fmt::format("{:.0f}", static_cast<double>(result.after.device_bytes) /
                                          static_cast<double>(result.particles)),
                fmt::format("{:.0f}", copied(setting, result)),
                of_energy("{:.3g}", energy ? energy->per_particle_step(result.particles) : 0),
                of_energy("{:.3g}", energy ? energy->net_per_particle_step(result.particles) : 0),
                of_energy("{:.0f}", energy ? energy->power.watts : 0),
                of_energy("{:.0f}", energy ? energy->idle.watts : 0),
                energy && energy->sm_clock > 0 ? fmt::format("{:.0f}", energy->sm_clock) : "-"});
}

std::string json_line(const BenchSetting& setting) {
  const BenchOptions& o = setting.options;
  JsonLine line;
  line.add("devices", json_array(setting.devices, [](const Device& device) {
             JsonLine one;
             one.add("ordinal", device.ordinal).text("name", device.name).text("bus", device.bus);
             one.add("multiprocessors", device.multiprocessors).add("memory", device.memory);
             return one.object();
           }));
  line.add("slabs", json_array(o.engine.devices, [](int ordinal) { return std::to_string(ordinal); }));
  if (!setting.driver.empty()) line.text("driver", setting.driver);
  line.add("copy_bandwidth", setting.bandwidth).add("block", o.engine.block);
  line.add("repeats", o.repeats).add("least_seconds", o.seconds);
  if (!setting.no_energy.empty()) return line.text("no_energy", setting.no_energy).object();
  line.add("energy_settle", o.times.settle).add("energy_idle", o.times.idle);
  return line.add("energy_warm_up", o.times.warm_up).add("energy_least_window", o.times.window).object();
}

std::string json_line(const BenchSetting& setting, const BenchRow& row, const RowResult& result) {
  JsonLine line;
  line.text("row", row.name).text("arithmetic", row.arithmetic).add("particles", result.particles);
  line.add("steps", result.steps).add("seconds", json_array(result.seconds, number));
  line.add("particle_steps_per_second", result.rate())
      .add("mean_particle_steps_per_second", result.mean_rate())
      .add("spread", result.spread());
  line.add("copied_bytes", copied(setting, result));
  line.add("list_builds", result.after.list_builds - result.before.list_builds);
  line.add("golden_steps", result.after.golden_steps - result.before.golden_steps);
  line.add("listed_pairs", result.after.listed_pairs).add("longest_list", result.after.longest_list);
  line.add("halo_particles", result.after.halo_particles).add("device_bytes", result.after.device_bytes);
  if (!result.energy) return line.text("no_energy", result.no_energy).object();
  line.text("energy_method", result.energy->method);
  for (const auto& [name, value] : result.energy->counters(result.particles)) line.add(name.c_str(), value);
  return line.object();
}

std::string json_left_out(const BenchRow& row, const std::string& why) {
  return JsonLine().text("row", row.name).text("left_out", why).object();
}

std::string value_lines(const BenchSetting& setting, const RowResult& result) {
  std::string text = fmt::format(
      "# {} particles on {}, {} steps per repeat, median of {} repeats of {:.4g} s, standard deviation "
      "{:.1f} %",
      result.particles, names_of(setting.devices), result.steps, result.seconds.size(),
      result.median_seconds(), 100 * result.spread());
  if (result.energy)
    text += fmt::format(", {:.3g} J per particle-step, {:.3g} J above idle",
                        result.energy->per_particle_step(result.particles),
                        result.energy->net_per_particle_step(result.particles));
  return text + fmt::format("\nparticle_steps {:.6g} 1/s\nrepeat {:.6g} s\n", result.rate(),
                            result.median_seconds());
}

}  // namespace cuboct::gpu
