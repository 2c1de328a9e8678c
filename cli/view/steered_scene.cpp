// SPDX-License-Identifier: MIT
#include "cli/view/steered_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hw/engine/scene_engine.h"
#include "model/base/error.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/config/config.h"
#include "model/run/start.h"

namespace cuboct {
namespace {

std::string constraint_of(const ParticleType& type) {
  const size_t at = type.name.find('/');
  return at == std::string::npos ? "" : type.name.substr(at + 1);
}

[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& hint = "") {
  throw InputError(fmt::format("--steer: {} {}", path, what), hint);
}

}  // namespace

SteeredScene::SteeredScene(Input asked, std::string engine, bool real, std::string directory, uint64_t steps,
                           uint64_t parts)
    : asked_(std::move(asked)), engine_(std::move(engine)), real_(real), directory_(std::move(directory)) {
  const std::string& path = asked_.scene;
  const Scene scene = read_scene(path);
  if (scene.until) refuse(path, "ends by 'until'", "without it the run goes to its last step");
  if (scene.loading) refuse(path, "loads at rest", "a run in motion can be steered");
  text_ = scene.text;
  dt_ = scene.rule.dt;
  reduced_ = scene.boltzmann == 1;
  steps_ = steps > 0 ? steps : scene.steps;
  each_ = std::max<uint64_t>(1, (steps_ + parts - 1) / parts);
  for (const ParticleType& type : scene.rule.types) {
    const std::string name = constraint_of(type);
    if (name.empty() || std::ranges::any_of(led_, [&](const Led& one) { return one.name == name; })) continue;
    try {  // one that is held takes no velocity
      parse_scene(text_ + stage_text({{name, type.velocity}}, 1, 1), path,
                  {.begins = true, .stage = "part-1"});
    } catch (const InputError&) {
      continue;
    }
    led_.push_back({name, type.velocity});
  }
  if (led_.empty()) refuse(path, "moves nothing", "a constraint of kind 'moved' has a velocity");
  own_ = led_;
  try {
    parse_scene(text_, this->path());
  } catch (const InputError&) {
    refuse(path, "names files, which its copy in the run's directory would not find",
           "whole paths are found");
  }
}

// Velocities that the scene has itself are left to it, digit by digit.
std::string SteeredScene::stage_text(const std::vector<Led>& led, uint64_t number, uint64_t steps) const {
  std::string changes;
  for (size_t k = 0; k < led.size(); ++k) {
    const Vec3& v = led[k].velocity;
    if (k < own_.size() && v == own_[k].velocity) continue;
    const std::string numbers = fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v[0], v[1], v[2]);
    changes += fmt::format("{}{{ name = {}, velocity = {} }}", changes.empty() ? "" : ", ", json(led[k].name),
                           reduced_ ? numbers : "\"" + numbers + " m/s\"");
  }
  return fmt::format("\n[[stage]]\nname = \"part-{}\"\nsteps = {}\n{}", number, steps,
                     changes.empty() ? "" : "constraint = [" + changes + "]\n");
}

std::string SteeredScene::place() const { return fmt::format("{}/{}-{}", directory_, part_, stage()); }

uint64_t SteeredScene::next_first() const { return part_ == 0 ? 0 : std::min(steps_, first_ + each_); }

void SteeredScene::set(size_t which, const Vec3& velocity) {
  if (which >= led_.size()) throw InputError("there is no such constraint");
  if (!velocity.allFinite()) throw InputError("the velocity is not finite");
  if (next_first() >= steps_) throw InputError("the last part of the run goes: no change would be in force");
  std::vector<Led> led = led_;
  led[which].velocity = velocity;
  // What its plan refuses, as formats that cannot hold it, is refused before the run is. The state it begins
  // with is not there yet: of the packing it is told as well.
  const uint64_t steps = std::min(each_, steps_ - next_first());
  const Scene scene = load_scene(text_ + stage_text(led, part_ + 1, steps), path(),
                                 {fmt::format("part-{}", part_ + 1), "", true});
  static_cast<void>(scene_plan_of(scene, read_arch(asked_.arch), engine_, real_));
  led_ = std::move(led);
}

bool SteeredScene::next() {
  first_ = next_first();
  if (first_ >= steps_) return false;
  ++part_;
  text_ += stage_text(led_, part_, std::min(each_, steps_ - first_));
  write_text(path(), text_);
  return true;
}

}  // namespace cuboct
