// SPDX-License-Identifier: MIT
#include "library/cuboct/cuboct.h"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "cli/run/engine_options.h"
#include "hw/program/command_line.h"
#include "model/base/error_parts.h"
#include "model/base/module.h"
#include "model/base/process.h"
#include "model/base/spelling.h"
#include "model/config/config.h"
#include "model/trace/trace_head.h"
#include "python/runs.h"
#include "python/simulation.h"
#include "python/sources.h"

namespace cuboct {
namespace {

// Beside the library of an installation are bin (cmake --install) or cuboct/bin (Debian); of a build
// directory, its parent.
void find_parts() {
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&version), &info) == 0) return;
  std::error_code failed;
  const std::filesystem::path file = std::filesystem::canonical(info.dli_fname, failed);
  if (failed) return;  // parts are then looked for beside the program
  const std::filesystem::path here = file.parent_path();
  const std::filesystem::path above = here.parent_path();
  look_for_parts_in({here.string()});
  for (const auto& directory : {above / "bin", above / "cuboct/bin", above, here})
    if (std::filesystem::is_regular_file(directory / "cuboct", failed))
      return set_program_directory(directory.string());
}

void find_parts_once() {
  static const bool found = (find_parts(), true);
  static_cast<void>(found);
}

InputRefused refused(const InputError& error) {
  InputRefused out(error.told(), bare_message(error), parts_of(error).hint);
  if (const InputError::Place* place = error.place()) {
    out.file = place->file;
    out.line = place->line, out.column = place->column;
  }
  return out;
}

// What the inside throws, as what the header promises.
template <typename Work>
auto outward(Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw refused(error);
  } catch (const python::Stopped& stopped) {
    const std::string what = stopped.what();
    RunStopped out(what + (stopped.advice.empty() ? "" : "\n  hint: " + stopped.advice), what,
                   stopped.advice);
    out.step = stopped.reason.step;
    throw out;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (const auto refusal = path_error(error)) throw refused(*refusal);
    throw Error(error.what(), error.what(), "");
  }
}

python::Sources sources_of(const SceneText& scene, const Options& options) {
  python::Sources sources{scene.toml, scene.name, {}, options.arch};
  if (!options.arch.empty()) sources.arch = read_config_text(options.arch);
  sources.stage = options.stage;
  sources.from = options.from;
  return sources;
}

EngineOptions engine_options(const Options& options) {
  EngineOptions out;
  out.quiet = true;
  if (options.threads < 0 || options.threads > 4096)
    throw InputError("threads = " + std::to_string(options.threads) + ": from 1 to 4096, or 0");
  out.threads = options.threads;
  if (options.precision.empty()) return out;
  const std::vector<std::string> precisions{"fixed", "float", "double"};
  if (std::ranges::count(precisions, options.precision) == 0)
    throw InputError("unknown precision '" + options.precision + "'", "one of " + list_of(precisions));
  out.precision = options.precision;
  return out;
}

std::vector<std::array<double, 3>> arrays_of(const std::vector<Vec3>& vectors) {
  std::vector<std::array<double, 3>> out;
  out.reserve(vectors.size());
  for (const Vec3& vector : vectors) out.push_back({vector[0], vector[1], vector[2]});
  return out;
}

}  // namespace

// Here, so that their type information is one for the library and its users.
Error::~Error() = default;
InputRefused::~InputRefused() = default;
RunStopped::~RunStopped() = default;

struct Simulation::Inside {
  mutable python::Simulation of;
};

Simulation::Simulation(const std::string& scene_file, const Options& options)
    : Simulation(outward([&] {
                   return SceneText{read_config_text(scene_file), scene_file};
                 }),
                 options) {}

Simulation::Simulation(const SceneText& scene, const Options& options) {
  find_parts_once();
  inside_ = outward([&] {
    return std::unique_ptr<Inside>(
        new Inside{{sources_of(scene, options), options.engine, engine_options(options), options.probe_every,
                    options.anyway}});
  });
}

Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

void Simulation::step(uint64_t steps) {
  outward([&] { inside_->of.step(steps); });
}
void Simulation::run() {
  outward([&] { inside_->of.run(); });
}

uint64_t Simulation::steps() const { return inside_->of.step_count(); }
double Simulation::dt() const { return inside_->of.dt(); }
uint64_t Simulation::particles() const { return inside_->of.particles(); }
std::string Simulation::engine() const { return inside_->of.engine(); }
std::string Simulation::title() const { return inside_->of.title(); }
std::vector<std::string> Simulation::type_names() const { return inside_->of.type_names(); }
std::vector<double> Simulation::type_masses() const { return inside_->of.type_masses(); }

std::vector<std::array<double, 3>> Simulation::positions() const {
  return outward([&] { return arrays_of(inside_->of.body().x); });
}
std::vector<std::array<double, 3>> Simulation::velocities() const {
  return outward([&] { return arrays_of(inside_->of.body().v); });
}
std::vector<uint8_t> Simulation::types() const {
  return outward([&] { return inside_->of.body().type; });
}

std::optional<uint64_t> Simulation::hash() const {
  if (inside_->of.real()) return {};
  return outward([&] { return inside_->of.hash(); });
}
uint64_t Simulation::plan_hash() const { return inside_->of.plan_hash(); }

Simulation::Energies Simulation::energies() const {
  return outward([&] {
    const auto now = inside_->of.energies();
    return Energies{now.of.kinetic, now.of.potential, now.of.gravity, now.of.total(), now.temperature};
  });
}

std::vector<Simulation::Curve> Simulation::curves() const {
  return outward([&] {
    std::vector<Curve> out;
    for (auto& curve : inside_->of.curves())
      out.push_back(
          {std::move(curve.name), std::move(curve.unit), std::move(curve.step), std::move(curve.value)});
    return out;
  });
}

Simulation::Curve Simulation::curve(const std::string& name) const {
  std::vector<Curve> all = curves();
  std::vector<std::string> names;
  for (Curve& curve : all) {
    if (curve.name == name) return std::move(curve);
    names.push_back(curve.name);
  }
  return outward([&]() -> Curve {
    const std::string near = did_you_mean(name, names);
    throw InputError("no curve '" + name + "'", !near.empty()   ? near
                                                : names.empty() ? "the scene has no probes"
                                                                : "one of " + list_of(names));
  });
}

std::vector<std::pair<std::string, std::vector<double>>> Simulation::fields() const {
  return outward([&] { return inside_->of.fields(); });
}

void Simulation::set_velocity(const std::string& constraint, const std::array<double, 3>& velocity) {
  outward([&] { inside_->of.set_velocity(constraint, Vec3(velocity[0], velocity[1], velocity[2])); });
}
void Simulation::set_gravity(const std::array<double, 3>& gravity) {
  outward([&] { inside_->of.set_gravity(Vec3(gravity[0], gravity[1], gravity[2])); });
}
void Simulation::leave(const std::string& directory) const {
  outward([&] { inside_->of.leave(directory); });
}

Crosscheck crosscheck(const std::string& scene_file, const std::vector<std::string>& engines,
                      std::optional<uint64_t> steps, const Options& options) {
  find_parts_once();
  return outward([&] {
    const python::Comparison found =
        python::crosscheck(sources_of({read_config_text(scene_file), scene_file}, options), engines,
                           engine_options(options), steps, "");
    return Crosscheck{found.matched, found.text, found.updates, found.steps, found.step};
  });
}

void look_for_programs_in(const std::string& directory) {
  find_parts_once();
  set_program_directory(directory);
}

std::string version() { return program_version(); }

}  // namespace cuboct
