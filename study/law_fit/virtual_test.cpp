// SPDX-License-Identifier: MIT
#include "study/law_fit/virtual_test.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/analysis/tension.h"
#include "model/base/error_parts.h"
#include "model/config/config.h"
#include "study/sweep/probe_run.h"

namespace cuboct::fit {
namespace {

std::string list_text(const std::vector<double>& values, const char* unit, bool reduced) {
  const std::string list = fmt::format("[{}]", fmt::join(values, ", "));
  return reduced ? list : fmt::format("\"{} {}\"", list, unit);
}

Tested read(const Scene& scene, const Test& test, const Trace& trace) {
  Tested tested;
  if (trace.stop) tested.stop = trace.stop->text;
  tested.particle_steps = study::particle_steps(scene, trace);
  for (const Curve& curve : trace.curves) {
    if (curve.name == test.against) tested.strain = curve.value;
    if (curve.name == test.curve) tested.stress = curve.value;
  }
  if (!scene.loading) tested.stress = running_mean(tested.stress, tension_window(tested.stress.size()));
  return tested;
}

}  // namespace

std::string scene_with(const study::Base& base, const LawPoints& law) {
  const bool reduced = study::is_reduced(base);
  std::vector<Change> changes;
  for (const std::string& name : parse_config(base.scene_text, base.scene_path).at("law").table().names())
    changes.push_back({"law." + name, ""});
  const std::string bare = with_changes(base.scene_text, base.scene_path, changes);
  return with_changes(bare, base.scene_path,
                      {{"law.kind", "\"spline\""},
                       {"law.r", list_text(law.r, "m", reduced)},
                       {"law.force", list_text(law.f, "N", reduced)}});
}

Tested run_test(const Test& test, const LawPoints& law) {
  Tested failed;
  try {
    const std::string arch_path = test.base.arch_path.empty() ? "(default arch)" : test.base.arch_path;
    const Arch arch =
        parse_arch(test.base.arch_text.empty() ? "name = \"default\"\n" : test.base.arch_text, arch_path);
    Scene scene = parse_scene(scene_with(test.base, law), test.base.scene_path);
    if (!scene.until) scene.until = Until{test.against, Until::Side::above, test.last_strain, 0};
    return read(scene, test, study::probe_run(scene, arch, test.engine, 1));
  } catch (const InputError& error) {
    failed.stop = bare_message(error);
    failed.refused = true;
  } catch (const std::runtime_error& error) {  // no rest, or not finite, at the start
    failed.stop = error.what();
  }
  return failed;
}

}  // namespace cuboct::fit
