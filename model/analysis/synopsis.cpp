// SPDX-License-Identifier: MIT
#include "model/analysis/synopsis.h"

#include <fmt/format.h>

#include "model/analysis/motion.h"
#include "model/base/quantity_text.h"
#include "model/body/packing.h"

namespace cuboct {
namespace {

// Lengths and times of a scene; plain numbers in reduced units.
class Shown {
 public:
  explicit Shown(const Scene& scene) : reduced_(scene.boltzmann == 1) {}
  std::string operator()(double value, const char* unit) const {
    return quantity_text(value, reduced_ ? "" : unit);
  }
  std::string mass(double kg) const {
    return reduced_ ? "mass " + (*this)(kg, "") : quantity_text(1000 * kg, "g");
  }

 private:
  bool reduced_;
};

double duration_of(const Scene& scene) { return static_cast<double>(scene.steps) * scene.rule.dt; }

// Of the box along axes that repeat, else of the particles' centres. m
Vec3 size_of(const Scene& scene) {
  Vec3 size = body_size(scene);
  for (int a = 0; a < 3; ++a)
    if (scene.periodic.extent[a] > 0) size[a] = scene.periodic.extent[a];
  return size;
}

std::string body_text(const Scene& scene, const Shown& shown) {
  const Vec3 size = size_of(scene);
  std::string text, repeats;
  for (int a = 0; a < 3; ++a) {
    if (scene.periodic.extent[a] > 0) repeats += "xyz"[a];
    if (size[a] > 1e-9 * scene.rule.cutoff()) text += (text.empty() ? "" : " x ") + shown(size[a], "m");
  }
  if (!repeats.empty()) text += ", repeats along " + repeats;
  const size_t count = scene.body.size();
  text += fmt::format("{}{} particle{} of {}", text.empty() ? "" : ", ", count, count == 1 ? "" : "s",
                      shown.mass(scene.rule.mass));
  if (!scene.rule.masses.empty()) text += " to " + shown.mass(scene.rule.heaviest());
  if (scene.pitch > 0) text += fmt::format(", {} apart", shown(scene.pitch, "m"));
  if (scene.grains > 0) text += fmt::format(", in {} grains", scene.grains);
  return text;
}

void add_meshes(const Scene& scene, std::vector<SynopsisLine>& lines) {
  for (const MeshFacts& mesh : scene.meshes)
    lines.push_back({"mesh", fmt::format("{}: {}", mesh.file, mesh_text(mesh))});
  if (scene.meshes.empty()) return;
  const double volume = static_cast<double>(scene.body.size()) * particle_mass(1, scene.pitch);
  lines.push_back({"packed", fmt::format("{:.4g} m^3, a particle's share times their number", volume)});
}

std::string run_text(const Scene& scene, const Shown& shown) {
  return fmt::format("{} step{} of {} = {}", scene.steps, scene.steps == 1 ? "" : "s",
                     shown(scene.rule.dt, "s"), shown(duration_of(scene), "s"));
}

// "x to 1.05 of the packing's length, at 1e+09 1/s", for each axis that is or becomes another one.
SynopsisLine box_line(const Scene& scene, const Shown& shown) {
  const Vec3 begin = scene.deform->strain, end = scene.deform->strain_at(scene.steps);
  const Vec3 extent = scene.box_at(scene.steps).extent;
  std::string text;
  for (int a = 0; a < 3; ++a) {
    if (begin[a] == 0 && end[a] == 0) continue;
    text += fmt::format("{}strain {:.4g} % along {}, {} long", text.empty() ? "" : "; ", 100 * end[a],
                        "xyz"[a], shown(extent[a], "m"));
    if (scene.deforms() && !scene.loading)
      text += fmt::format(", at {}", shown(scene.deform->per_step[a] / scene.rule.dt, "1/s"));
  }
  if (!scene.deforms()) return {"box", "keeps the size that it was left with: " + text};
  return {"box", "deforms, at the end " + text, "for the reference engine alone"};
}

std::string until_text(const Until& until) {
  return fmt::format("{} is {} {:.6g}", until.curve, until.side_name(), until.limit);
}

}  // namespace

Vec3 body_size(const Scene& scene) {
  Vec3 low = scene.body.x.front(), high = low;
  for (const Vec3& x : scene.body.x) low = low.cwiseMin(x), high = high.cwiseMax(x);
  return high - low;
}

std::vector<SynopsisLine> synopsis_of(const Scene& scene) {
  const Shown shown(scene);
  const Motion motion = motion_of(scene);
  const double length = size_of(scene).maxCoeff();
  std::vector<SynopsisLine> lines{{"body", body_text(scene, shown)}};
  add_meshes(scene, lines);
  std::string crossings;
  if (motion.sound_speed > 0 && length > 0) {
    lines.push_back({"waves", fmt::format("{}, {} from end to end", shown(motion.sound_speed, "m/s"),
                                          shown(length / motion.sound_speed, "s"))});
    crossings = fmt::format(", {} crossings", times_text(duration_of(scene) * motion.sound_speed / length));
  }
  lines.push_back({"run", run_text(scene, shown) + crossings});
  if (scene.deform) lines.push_back(box_line(scene, shown));
  if (scene.loading)
    lines.push_back(
        {"loading",
         fmt::format("static: {} load steps of {} steps each, {:g} of the load unbalanced at most",
                     scene.steps / scene.loading->every, scene.loading->every, scene.loading->tolerance)});
  lines.push_back({"step", scene.dt_limit > 0
                               ? fmt::format("{:.2g} of {}, the largest stable one of {}", scene.dt_safety,
                                             shown(scene.dt_limit, "s"), scene.dt_limit_of)
                               : "by the scene; no largest stable one is known"});
  if (motion.strain > 0)
    lines.push_back({"strain", fmt::format("about {:.2g} %, by {}", 100 * motion.strain, motion.strain_of)});
  if (scene.until) lines.push_back({"until", until_text(*scene.until), "or the last step"});
  return lines;
}

std::string stage_synopsis(const Scene& scene) {
  std::string text = run_text(scene, Shown(scene));
  if (scene.until) text += ", until " + until_text(*scene.until);
  return text + (scene.rule.damping.coefficient > 0 ? ", damped" : "");
}

}  // namespace cuboct
