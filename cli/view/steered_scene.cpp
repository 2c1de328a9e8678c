// SPDX-License-Identifier: MIT
#include "cli/view/steered_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

// As a scene has them; in one of reduced units without `unit`.
struct Numbers {
  bool reduced;
  std::string vector(const Vec3& v, const char* unit) const {
    const std::string numbers = fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v[0], v[1], v[2]);
    return reduced ? numbers : fmt::format("\"{} {}\"", numbers, unit);
  }
  std::string number(double value, const char* unit) const {
    return reduced ? fmt::format("{:.17g}", value) : fmt::format("\"{:.17g} {}\"", value, unit);
  }
};

}  // namespace

SteeredScene::SteeredScene(Input asked, std::string engine, bool real, std::string directory, uint64_t steps)
    : asked_(std::move(asked)), engine_(std::move(engine)), real_(real), directory_(std::move(directory)) {
  const std::string& path = asked_.scene;
  const Scene scene = read_scene(path);
  if (scene.until) refuse(path, "ends by 'until'", "without it the run goes to its last step");
  if (scene.loading) refuse(path, "loads at rest", "a run in motion can be steered");
  text_ = scene.text;
  dt_ = scene.rule.dt;
  reduced_ = scene.boltzmann == 1;
  steps_ = steps > 0 ? steps : scene.steps;
  packing_ = scene.body.x;
  if (!packing_.empty()) {
    Vec3 low = packing_[0], high = packing_[0];
    for (const Vec3& x : packing_) low = low.cwiseMin(x), high = high.cwiseMax(x);
    radius_ = std::max((high - low).maxCoeff() / 10, first_shell(scene));
  }
  wanted_.damping = own_.damping = scene.rule.damping.coefficient;
  if (!scene.rule.types.empty())
    wanted_.gravity = own_.gravity = scene.rule.types[0].gravity - scene.rule.types[0].pull;
  std::vector<Led>& led = wanted_.led;
  for (const ParticleType& type : scene.rule.types) {
    const std::string name = constraint_of(type);
    if (name.empty() || std::ranges::any_of(led, [&](const Led& one) { return one.name == name; })) continue;
    led.push_back({name, type.velocity});
    try {  // one that is held takes no velocity
      parse_scene(text_ + text_of({wanted_, {}, 1}, 1, {}), path, {.begins = true, .stage = "part-1"});
    } catch (const InputError&) {
      led.pop_back();
    }
  }
  own_ = wanted_;
  while (std::ranges::any_of(scene.rule.types, [&](auto& type) { return constraint_of(type) == hand_; }))
    hand_ += "-";
  try {
    parse_scene(text_, this->path());
  } catch (const InputError&) {
    refuse(path, "names files, which its copy in the run's directory would not find",
           "whole paths are found");
  }
}

// What the scene has itself is left to it, digit by digit.
std::string SteeredScene::text_of(const Stage& stage, uint64_t number, std::optional<uint64_t> done) const {
  const Numbers write{reduced_};
  std::string changes, keys;
  const auto add = [&](const std::string& name, const std::string& says) {
    changes += fmt::format("{}{{ name = {}, {} }}", changes.empty() ? "" : ", ", json(name), says);
  };
  const Wanted& wanted = stage.wanted;
  for (size_t k = 0; k < wanted.led.size(); ++k)
    if (k >= own_.led.size() || wanted.led[k].velocity != own_.led[k].velocity)
      add(wanted.led[k].name, "velocity = " + write.vector(wanted.led[k].velocity, "m/s"));
  if (wanted.gravity != own_.gravity)
    keys += fmt::format("gravity = {}\n", write.vector(wanted.gravity, "m/s^2"));
  if (wanted.damping != own_.damping)
    keys += fmt::format("damping = {{ coefficient = {} }}\n", write.number(wanted.damping, "kg/s"));
  if (stage.pull) {
    const Pull& pull = *stage.pull;
    const Vec3 velocity = pull.way / (static_cast<double>(pull.steps) * dt_);
    add(hand_,
        fmt::format(
            "kind = \"moved\", velocity = {}, region = {{ shape = \"sphere\", centre = {}, radius = {} }}",
            write.vector(velocity, "m/s"), write.vector(packing_[pull.particle], "m"),
            write.number(pull.radius, "m")));
  }
  if (!changes.empty()) keys += "constraint = [" + changes + "]\n";
  std::string length = fmt::format("steps = {}\n", done.value_or(stage.steps));
  if (done && *done < stage.steps) length += fmt::format("planned_steps = {}\n", stage.steps);
  return fmt::format("\n[[stage]]\nname = \"part-{}\"\n{}{}", number, length, keys);
}

std::string SteeredScene::place() const { return fmt::format("{}/{}-{}", directory_, part_, stage()); }

// What its plan refuses, as formats that cannot hold it, is refused before the run is. The state that it
// begins with is not there yet: of the packing it is told as well.
void SteeredScene::check(const Stage& stage) const {
  const std::string name = fmt::format("part-{}", part_ + 1);
  const Scene scene =
      load_scene(text_ + (part_ > 0 ? text_of(now_, part_, {}) : "") + text_of(stage, part_ + 1, {}), path(),
                 {name, "", true});
  static_cast<void>(scene_plan_of(scene, read_arch(asked_.arch), engine_, real_));
}

void SteeredScene::take(Wanted wanted) {
  check({wanted, {}, left()});
  wanted_ = std::move(wanted);
  changed_ = true;
}

void SteeredScene::set_velocity(size_t which, const Vec3& velocity) {
  Wanted wanted = wanted_;
  if (which >= wanted.led.size()) throw InputError("there is no such constraint");
  if (!velocity.allFinite()) throw InputError("the velocity is not finite");
  wanted.led[which].velocity = velocity;
  take(std::move(wanted));
}

void SteeredScene::set_gravity(const Vec3& gravity) {
  Wanted wanted = wanted_;
  if (!gravity.allFinite()) throw InputError("the gravity is not finite");
  wanted.gravity = gravity;
  take(std::move(wanted));
}

void SteeredScene::set_damping(double coefficient) {
  Wanted wanted = wanted_;
  if (!(coefficient >= 0) || std::isinf(coefficient))
    throw InputError("damping is a finite number, not below 0");
  wanted.damping = coefficient;
  take(std::move(wanted));
}

void SteeredScene::pull(const Pull& asked) {
  if (asked.particle >= packing_.size()) throw InputError("there is no such particle");
  if (!asked.way.allFinite() || !(asked.radius > 0) || std::isinf(asked.radius) || asked.steps == 0)
    throw InputError("a pull has a way, a radius above 0 and a step at least");
  Pull pull = asked;
  pull.steps = std::min(pull.steps, left());
  check({wanted_, pull, pull.steps});
  pull_ = pull;
  changed_ = true;
}

bool SteeredScene::next() {
  if (left() == 0) return false;
  now_ = {wanted_, std::exchange(pull_, std::nullopt), left()};
  if (now_.pull) now_.steps = now_.pull->steps = std::min(now_.pull->steps, left());
  changed_ = false;
  ++part_;
  write_text(path(), text_ + text_of(now_, part_, {}));
  return true;
}

void SteeredScene::ended(uint64_t done) {
  text_ += text_of(now_, part_, done);
  write_text(path(), text_);
  first_ += done;
  if (!now_.pull || pull_ || done >= now_.steps) return;
  // Another change has come in the midst of it: the hand does not let go.
  pull_ = now_.pull;
  pull_->steps -= done;
  pull_->way *= static_cast<double>(pull_->steps) / static_cast<double>(now_.steps);
}

}  // namespace cuboct
