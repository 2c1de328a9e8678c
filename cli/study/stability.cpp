// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/outputs.h"
#include "hw/plan/setup.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/base/directory_lock.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/progress.h"
#include "model/base/text.h"
#include "model/rules/rounds_rule.h"
#include "model/solid/dynamical_matrix.h"
#include "study/stability/stability.h"
#include "study/stability/stability_pictures.h"

namespace cuboct {
namespace {

using study::Arithmetic;
using study::Method;
using study::Subject;

struct StabilityOptions {
  Input input;
  Answer answer;
  std::string maps;
  std::string axis;
  double strain = 0.1;
  double resolution = 0.002;
  int threads = 0;
  bool anyway = false;
};

// The matrix of a million particles takes 3 GB.
constexpr size_t kMostForStability = 1000000;

struct Engine {
  const char *name, *key;
  Arithmetic arithmetic;
  Integrator integrator;
};
constexpr std::array<Engine, 4> kEngines{
    {{"Euler", "euler", Arithmetic::float64, Integrator::semi_implicit_euler},
     {"Verlet", "verlet", Arithmetic::float64, Integrator::velocity_verlet},
     {"Euler, floats", "euler_float32", Arithmetic::float32, Integrator::semi_implicit_euler},
     {"Euler, fixed", "euler_fixed", Arithmetic::fixed, Integrator::semi_implicit_euler}}};

struct Row {
  std::string name, note;
  double predicted = 0, frequency = 0, damping_share = 0;
  std::array<std::optional<study::MeasuredLimit>, kEngines.size()> measured;
};

int axis_of(const StabilityOptions& options, const Scene& scene) {
  return options.axis.empty() ? strain_axis(scene) : options.axis[0] - 'x';
}

// Each line's scene, only where the scene has the thing.
std::vector<std::pair<std::string, Scene>> variants_of(const Scene& scene) {
  bool strengths = false, imposed = false, pd = false;
  for (const auto& row : scene.rule.strength)
    for (const double s : row) strengths = strengths || s != 1;
  for (const ParticleType& type : scene.rule.types) {
    for (const bool axis : type.imposed) imposed = imposed || axis;
    pd = pd || type.pd;
  }
  const bool damping = scene.rule.damping.coefficient > 0;
  const study::Parts none{false, false, false, false};
  const bool ring = scene.periodic.extent.minCoeff() > 0;
  std::vector<std::pair<std::string, Scene>> out;
  out.emplace_back(ring ? "body, periodic" : "body with its surface", with_parts(scene, none));
  const auto add = [&](bool there, const char* name, bool study::Parts::*part) {
    if (!there) return;
    study::Parts parts = none;
    parts.*part = true;
    out.emplace_back(name, with_parts(scene, parts));
  };
  add(damping, "damped", &study::Parts::damping);
  add(strengths, "types of unlike strength", &study::Parts::strengths);
  add(imposed, "held and moved regions", &study::Parts::imposed);
  add(pd, "regions held by force", &study::Parts::pd);
  if (damping + strengths + imposed + pd > 1) out.emplace_back("all of the scene", scene);
  return out;
}

std::string text_of(const Scene& scene, const std::vector<Row>& rows) {
  std::string out = fmt::format("scene      {}\nparticles  {}\ndt         {:.6g} s\n\n", scene.path,
                                scene.body.size(), scene.rule.dt);
  size_t width = 0;
  for (const Row& row : rows) width = std::max(width, row.name.size());
  out += fmt::format("{:<{}}  {:>12}", "largest stable dt", width, "theory, s");
  for (const Engine& engine : kEngines) out += fmt::format("  {:>13}  {:>7}", engine.name, "ratio");
  out += '\n';
  bool refused = false;
  for (const Row& row : rows) {
    out += fmt::format("{:<{}}  {:>12.5g}", row.name, width, row.predicted);
    bool any = false;
    for (const auto& measured : row.measured) any = any || measured;
    for (const auto& measured : row.measured) {
      if (!any) break;
      if (!measured)
        out += fmt::format("  {:>13}  {:>7}", "-", "");
      else
        out += fmt::format("  {:>13}  {:>7.4f}",
                           fmt::format("{}{:.5g}", measured->refused ? ">" : "", measured->middle()),
                           measured->middle() / row.predicted);
      refused = refused || (measured && measured->refused);
    }
    out += '\n';
    if (!row.note.empty()) out += fmt::format("{:<{}}  {}\n", "", width, row.note);
  }
  if (refused) out += "\n> the fixed formats end before stability does\n";
  return out;
}

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : "null"; }

std::string json_of(const Scene& scene, const std::vector<Row>& rows, const std::vector<std::string>& maps) {
  std::string out = fmt::format("{{\"scene\": {}, \"particles\": {}, \"dt\": {}, \"lines\": [",
                                json(scene.path), scene.body.size(), number(scene.rule.dt));
  for (size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    out += fmt::format(
        "{}\n  {{\"name\": {}, \"note\": {}, \"predicted\": {}, \"frequency\": {}, \"damping_share\": {}, "
        "\"measured\": {{",
        i > 0 ? "," : "", json(row.name), json(row.note), number(row.predicted), number(row.frequency),
        number(row.damping_share));
    bool first = true;
    for (size_t e = 0; e < kEngines.size(); ++e) {
      if (!row.measured[e]) continue;
      const study::MeasuredLimit& m = *row.measured[e];
      out += fmt::format(
          "{}\n    \"{}\": {{\"stable\": {}, \"unstable\": {}, \"ratio\": {}, \"steps\": {}, \"trials\": {}, "
          "\"refused\": {}, \"sign\": {}}}",
          first ? "" : ",", kEngines[e].key, number(m.stable), number(m.unstable),
          number(m.middle() / row.predicted), m.steps, m.trials, m.refused, json(m.sign));
      first = false;
    }
    out += "}}";
  }
  return out + fmt::format("\n], \"maps\": {}}}", json(maps));
}

void check(const StabilityOptions& options) {
  check_workers("--threads", options.threads, options.anyway);
  if (!(options.strain >= 0 && options.strain <= 0.5))
    throw InputError(
        fmt::format("--strain: {:g} is not in [0, 0.5]: the part of its length that the body is "
                    "stretched and pressed by",
                    options.strain));
  if (!(options.resolution >= 1e-4 && options.resolution <= 0.1))
    throw InputError(fmt::format("--resolution: {:g} is not in [0.0001, 0.1]", options.resolution));
  if (!options.axis.empty() && options.axis != "x" && options.axis != "y" && options.axis != "z")
    throw InputError(fmt::format("--axis: '{}' is not x, y or z", options.axis));
}

void measure(const StabilityOptions& options, const Scene& scene, const Arch& arch) {
  if (scene.body.size() > kMostForStability)
    throw InputError(fmt::format("{} particles: 'cuboct stability' builds the matrix of at most {}",
                                 scene.body.size(), kMostForStability),
                     "a smaller piece of the same body has the same limit");
  check_memory(fmt::format("{} particles", scene.body.size()),
               static_cast<double>(scene.body.size()) * 3e9 / kMostForStability,
               "a smaller piece of the same body has the same limit", options.anyway);
  std::optional<DirectoryLock> lock;
  if (!options.maps.empty()) {
    study::check_maps(scene);
    lock.emplace(options.maps, "cuboct stability");
    check_writable(options.maps + "/damping.png");
  }
  catch_interrupts();
  StatusLine status;  // what is being measured
  std::vector<Row> rows;
  std::vector<std::string> drawn;
  const auto print = [&] {
    status.wipe();
    options.answer.say("{}", block_text(text_of(scene, rows)));
    for (const std::string& path : drawn) options.answer.say("{}\n", line_text(path));
    options.answer.close(json_of(scene, rows, drawn));
  };
  try {
    if (scene.pitch > 0) {
      Row row{"perfect packing", "", 0, largest_frequency(scene.rule, scene.pitch), 0, {}};
      row.predicted = 2 / row.frequency;
      rows.push_back(row);
    }
    const auto line = [&](const std::string& name, const Scene& of, int axis, double strain) {
      status.say(fmt::format("{}: vibrations", name));
      const Subject subject = study::subject_of(of, axis, strain);
      Row row{name, subject.note, subject.limit.dt, subject.limit.frequency, subject.limit.damping_share, {}};
      for (size_t e = 0; e < kEngines.size() && subject.measurable; ++e) {
        status.say(fmt::format("{}: {}", name, kEngines[e].name));
        const Method method{kEngines[e].arithmetic, kEngines[e].integrator, std::max(1, options.threads)};
        try {
          row.measured[e] = study::measured_limit(subject, arch, method, options.resolution);
        } catch (const InputError& error) {
          if (kEngines[e].arithmetic != Arithmetic::fixed) throw;
          std::string why = error.what();
          row.note += (row.note.empty() ? "" : "; ") + ("fixed: " + why.substr(0, why.find('\n')));
        }
      }
      rows.push_back(std::move(row));
    };
    for (const auto& [name, variant] : variants_of(scene)) line(name, variant, 0, 0);
    const int axis = axis_of(options, scene);
    if (options.strain > 0)
      for (const double strain : {options.strain, -options.strain})
        line(fmt::format("{} {:g} % along {}", strain > 0 ? "stretched by" : "pressed by",
                         100 * options.strain, "xyz"[axis]),
             scene, axis, strain);
    if (!options.maps.empty())
      for (const study::StabilityMap& map :
           study::stability_maps(scene, arch, axis, 26, [&](const std::string&name, double done) {
             status.say(fmt::format("map of {}: {:.0f} %", name, 100 * done));
           }))
        for (const std::string& path : draw(map, options.maps)) drawn.push_back(path);
  } catch (const study::Interrupted&) {
    print();
    throw Failed("interrupted");
  }
  print();
}

void stability(const StabilityOptions& options) {
  check(options);
  const Scene scene = read_scene(options.input.scene);
  const Arch arch = read_arch(options.input.arch);
  with_places(scene, arch, [&] {
    refuse_rounds(scene.rule, "'cuboct stability'");
    measure(options, scene, arch);
  });
}

}  // namespace

void add_stability(Command& app, int& exit_code) {
  auto [command, options] = add_command<StabilityOptions>(app, "stability", exit_code, stability);
  options->input.add_to(command);
  options->answer.add_to(command);
  command.option("--maps", options->maps, "draw maps of stable and unstable runs there", "DIR");
  command
      .option("--strain", options->strain,
              "the part of its length that the body is stretched and pressed by; 0: neither", "E")
      .show_default();
  command.option("--axis", options->axis, "of the strain; default: the tensile probe's, or the longest", "A")
      .proposed({"x", "y", "z"});
  command.option("--resolution", options->resolution, "of the measured limits, relative", "R").show_default();
  command.option("--threads", options->threads, "of the engines; default: 1", "N").range(1, 4096);
  add_anyway_to(command, options->anyway);
}

}  // namespace cuboct
