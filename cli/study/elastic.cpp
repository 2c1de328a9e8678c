// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cli/command.h"
#include "cli/programs.h"
#include "cli/study/elastic_text.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/analysis/scene_cell.h"
#include "model/analysis/strained_cell.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/progress.h"
#include "model/config/changes.h"
#include "model/config/config.h"
#include "model/scene/rule_cell.h"
#include "model/solid/cleavage.h"
#include "model/trace/plot.h"

namespace cuboct {
namespace {

struct ElasticOptions {
  std::string scene, law, pitch, density, material, polar;
  bool reduced = false, relaxed = false, json = false;
  double strain = 1e-6;
  int layers = 0, threads = 1;
  bool anyway = false;
};

constexpr size_t kMostForElastic = 100000;  // of which the force constants take some 2 GB
constexpr int kMostLayers = 64;

// The law alone as a scene; places in errors are those of this text.
Scene scene_of_law(const ElasticOptions& options) {
  const auto value = [&](const std::string& text) {
    return options.reduced || text == "relaxed" ? (text == "relaxed" ? "\"relaxed\"" : text)
                                                : "\"" + text + "\"";
  };
  std::string text = options.reduced ? "units = \"reduced\"\n" : "";
  text += options.density.empty() ? "mass = 1\n" : fmt::format("density = {}\n", value(options.density));
  text += fmt::format("packing = {{ pitch = {} }}\nlaw = {{ {} }}\n", value(options.pitch), options.law);
  text += "box = { cells = [1, 1, 1] }\n";
  return parse_scene(text + "[run]\nsteps = 0\n", "--law");
}

// Without the scene's own starts of fields that ask where they are, as velocities and constraints leave no
// mark.
Scene scene_of_matter(const std::string& path, std::vector<std::string>& left_out) {
  const std::vector<StageName> stages = stages_of(path);
  const SceneChoice choice{.stage = stages.empty() ? "" : stages.front().name};
  Scene scene = read_scene(path, choice);
  const RoundsRule* rounds = scene.rule.rounds.get();
  const std::string text = read_config_text(path);
  const auto rule = rounds && rounds->text() ? parse_config(text, path).find("rule") : std::nullopt;
  if (!rule || !rule->is_table()) return scene;
  std::vector<Change> changes;
  for (const std::string& name : starts_by_place(scene.rule)) {
    const Change change{"rule.start." + name, ""};
    if (with_changes(text, path, {change}) == text) continue;
    left_out.push_back(name);
    changes.push_back(change);
  }
  return changes.empty() ? scene : parse_scene(with_changes(text, path, changes), path, choice);
}

Scene scene_of(const ElasticOptions& options, std::vector<std::string>& left_out) {
  if (options.scene.empty() == options.law.empty())
    throw InputError("either a scene or --law",
                     "cuboct elastic SCENE, or cuboct elastic --law 'kind = ...' --pitch P");
  if (!options.scene.empty()) {
    if (!options.pitch.empty() || !options.density.empty() || options.reduced)
      throw InputError("--pitch, --density and --reduced go with --law", "a scene has its own");
    return scene_of_matter(options.scene, left_out);
  }
  if (options.pitch.empty()) throw InputError("--law needs --pitch, the distance of nearest particles");
  if (options.density.empty() && !options.reduced)
    throw InputError("--law needs --density, of which waves are told",
                     "--reduced: plain numbers, and masses of 1");
  return scene_of_law(options);
}

void check(const ElasticOptions& options) {
  check_workers("--threads", options.threads, options.anyway);
  if (!(options.strain >= 1e-8 && options.strain <= 1e-2))
    throw InputError(fmt::format("--strain: {:g} is not in [1e-8, 0.01]", options.strain));
  if (!options.polar.empty()) {
    if (!options.polar.ends_with(".svg") && !options.polar.ends_with(".png"))
      throw InputError(fmt::format("--polar: '{}' ends with neither .svg nor .png", options.polar));
    check_writable(options.polar);
  }
}

std::vector<Cleavage> cleavage_of(const Rule& rule, const CrystalCell& cell, const Mat3& crystal) {
  const CleavagePlanes planes = cleavage_planes(rule, cell);
  std::vector<Cleavage> out{{"{100}", crystal * Vec3(1, 0, 0)},
                            {"{110}", crystal * Vec3(1, 1, 0).normalized()},
                            {"{111}", crystal * Vec3(1, 1, 1).normalized()},
                            {"weakest", planes.weakest},
                            {"strongest", planes.strongest}};
  for (Cleavage& one : out) one.energy = cleavage_energy(rule, cell, one.normal);
  return out;
}

ElasticFindings findings_of(const ElasticOptions& options, const Scene& scene) {
  ElasticFindings out;
  refuse_cell(scene.rule);
  SceneCell start = cell_of(scene, options.material);
  if (start.cell.x.size() > kMostForElastic)
    throw InputError(fmt::format("{} particles: 'cuboct elastic' solves for at most {}", start.cell.x.size(),
                                 kMostForElastic),
                     "a smaller box of the same matter has the same constants");
  check_memory(fmt::format("{} particles", start.cell.x.size()),
               static_cast<double>(start.cell.x.size()) * 2e9 / kMostForElastic,
               "a smaller box of the same matter has the same constants", options.anyway);
  out.scene = scene.path;
  out.cell = start.of;
  out.particles = start.cell.x.size();
  StatusLine status;
  const auto at_work = [&](const std::string& what) {
    status.say(fmt::format("elastic: {}, {} particles ...", what, out.particles));
  };
  const auto strains = [&](int cell) { at_work(fmt::format("strained cell {} of 12", cell)); };
  at_work("the cell at rest");
  if (options.relaxed) start.cell = without_stress(scene.rule, start.cell, options.threads);
  StrainedCell rest(scene.rule, start.cell, options.threads);
  out.relaxing = rest.relax();
  out.density = density_of(scene.rule, rest.cell());
  out.strain = options.strain;
  out.by_sums = scene.rule.rounds == nullptr;
  const auto strained = [&](const CrystalCell& cell) {
    return constants_by_strain(scene.rule, cell, options.strain, options.threads, out.evaluations, strains);
  };
  if (out.by_sums) at_work("lattice sums");
  out.sums = tensor_of(scene.rule, rest.cell(), options.strain, options.threads, out.evaluations, strains);
  out.strained = out.by_sums ? strained(rest.cell()) : out.sums.c;
  // The grains of a box have no direction in common.
  if (scene.pitch > 0 && (scene.grains == 0 || out.particles == 1)) out.crystal = scene.orientation;
  if (out.crystal && out.particles == 1 && out.by_sums)
    out.cleavage = cleavage_of(scene.rule, rest.cell(), *out.crystal);
  for (int n = 2; n <= options.layers; ++n) {
    at_work(fmt::format("slab of {} layers", n));
    const CrystalCell slab = without_stress(scene.rule, slab_of(scene, options.material, n), options.threads);
    const double by_strain = plane_modulus(strained(slab));
    out.slabs.push_back({n, slab.vectors(2, 2),
                         out.by_sums ? plane_modulus(elastic_tensor(scene.rule, slab).c) : by_strain,
                         by_strain});
  }
  return out;
}

void draw(const ElasticFindings& found, const std::string& path) {
  constexpr int kPoints = 360, kEvery = 10;
  const auto modulus = [](const Matrix6& c, double angle) {
    return youngs_modulus(c, Vec3(std::cos(angle), std::sin(angle), 0));
  };
  std::vector<double> angles;
  double most = 0;
  for (int i = 0; i <= kPoints; ++i) {
    angles.push_back(2 * std::numbers::pi * i / kPoints);
    most = std::max(most, modulus(found.sums.c, angles.back()));
  }
  const auto [scale, unit] = pressure_unit(most);
  std::string sums = "$sums << END\n", strained = "END\n$strained << END\n";
  for (int i = 0; i <= kPoints; ++i) {
    sums += fmt::format("{:.6f} {:.6g}\n", angles[i], modulus(found.sums.c, angles[i]) / scale);
    if (i % kEvery == 0)
      strained += fmt::format("{:.6f} {:.6g}\n", angles[i], modulus(found.strained, angles[i]) / scale);
  }
  const std::string plot = fmt::format(
      "set polar\nset size ratio 1\nunset border\nunset xtics\nunset ytics\nset rrange [0:{:.3g}]\n"
      "set grid polar pi/6 lt 1 lc rgb '#dddddd'\nset rtics format '%g'\nset ttics 0, 30 format '%g°'\n"
      "set key bmargin center horizontal\nset title \"Young's modulus in the x-y plane, {}\"\n"
      "plot $sums with lines lw 2 lc rgb '#1f5fa8' title 'lattice sums', "
      "$strained with points pt 7 ps 0.6 lc rgb '#d9703f' title 'strained simulation'\n",
      1.1 * most / scale, unit);
  draw_plot(path, sums + strained + "END\n", plot, 620, 640);
}

int elastic(const ElasticOptions& options) {
  check(options);
  catch_interrupts();
  std::vector<std::string> left_out;
  const Scene scene = scene_of(options, left_out);
  const ElasticFindings found = [&] {
    try {
      ElasticFindings all = findings_of(options, scene);
      all.left_out = left_out;
      return all;
    } catch (const InputError& error) {
      throw scene.places.placed(error);
    }
  }();
  fmt::print("{}", options.json ? json_of(found) : text_of(found));
  if (!options.polar.empty() && found.stable()) draw(found, options.polar);
  return found.stable() ? 0 : 1;
}

}  // namespace

void add_elastic(Command& app, int& exit_code) {
  auto [command, options] = add_command<ElasticOptions>(app, "elastic", exit_code, elastic);
  command.option("scene", options->scene, "scene file (TOML)", "SCENE");
  command.option("--law", options->law, "in place of a scene, of an FCC packing: the keys of its [law]",
                 "KEYS");
  command.option("--pitch", options->pitch, "of --law: distance of nearest particles, or relaxed", "P");
  command.option("--density", options->density, "of --law, with its unit", "D");
  command.flag("--reduced", options->reduced, "quantities of --law are plain numbers, the mass is 1");
  command.option("--material", options->material, "of a scene whose box does not repeat; default: the first",
                 "NAME");
  command.flag("--relaxed", options->relaxed, "first strain the cell until it carries no stress");
  command.option("--strain", options->strain, "of the strained simulations", "E").show_default();
  command
      .option("--layers", options->layers, "also the modulus along x of slabs of 2 to N layers across z", "N")
      .range(2, kMostLayers);
  command.option("--polar", options->polar,
                 "draw Young's modulus against direction in the x-y plane (svg, png)", "FILE");
  command.option("--threads", options->threads, "of the simulations; default: 1", "N").range(1, 4096);
  add_anyway_to(command, options->anyway);
  command.flag("--json", options->json, "print as JSON");
}

}  // namespace cuboct
