// SPDX-License-Identifier: MIT
#include "cli/run/crosscheck_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "cli/run/crosscheck_real.h"
#include "cli/run/told.h"
#include "model/base/interrupt.h"
#include "model/program/program_errors.h"
#include "model/real/real_engine.h"
#include "model/rules/rounds_rule.h"
#include "model/run/rounds_run.h"

namespace cuboct {
namespace {

// The reference and the bounds of the device's errors, side by side.
struct Beside {
  Beside(const Scene& scene, bool floats)
      : scene(scene),
        body(completed(scene, scene.body)),
        reference(make_real_engine(scene.rule, body, scene.periodic,
                                   {.threads = reference_threads(scene.body.size())})),
        errors(std::in_place, scene.rule, body, scene.periodic, floats) {}

  // As far as the distance from the device's run has a bound that tells something: of positions over the
  // reach, or, where nothing moves, of fields over their largest values.
  void run(uint64_t most, double told) {
    while (step < most && !interrupted()) {
      ProgramErrors next = *errors;
      next.step(body.x, body.v, step);
      const double error =
          scene.rule.rounds->text()->still ? next.field_share() : next.position() / scene.rule.cutoff();
      if (step > 0 && !(error <= told)) break;
      errors.emplace(std::move(next));
      reference->step(step++);
      reference->read(body);
    }
    errors->look(body.x, body.v, step);
  }
  // The state becomes that of a frame, where that has all that the rule keeps.
  bool place(const RealFrame& frame) {
    const RuleProgram& program = *scene.rule.rounds->text();
    if (std::ranges::any_of(program.bond, &ProgramField::kept)) return false;
    std::vector<uint64_t> kept;
    size_t shown = 0;
    for (const ProgramField& field : program.particle) {
      if (field.kept && !field.shown) return false;
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) {
        const std::vector<double> values = number(frame.shown[shown], field, k);
        for (const double value : values) kept.push_back(std::bit_cast<uint64_t>(value));
        errors->place(field.first + k, values);
      }
      shown += field.shown;
    }
    body.x = frame.x, body.v = frame.v, body.u = frame.u, step = frame.step;
    reference->place(body, step);
    reference->recall(kept);
    errors->look(body.x, body.v, step);
    return true;
  }
  static std::vector<double> number(const std::vector<double>& shown, const ProgramField& field, uint32_t k) {
    std::vector<double> values;
    for (size_t at = k; at < shown.size(); at += field.numbers()) values.push_back(shown[at]);
    return values;
  }

  const Scene& scene;
  Body body;
  std::unique_ptr<RealEngine> reference;
  std::optional<ProgramErrors> errors;
  uint64_t step = 0;
};

bool check_fields(Told& told, const Beside& exact, const RealFrame& frame, const std::string& when) {
  const std::vector<std::vector<double>> fields = exact.reference->terms()->shown();
  bool within = true;
  size_t at = 0;
  for (const ProgramField& field : exact.scene.rule.rounds->text()->particle) {
    if (!field.shown) continue;
    for (uint32_t k = 0; k < field.numbers(); ++k) {
      std::vector<Vec3> got, reference;
      for (const double value : Beside::number(frame.shown[at], field, k)) got.emplace_back(value, 0, 0);
      for (const double value : Beside::number(fields[at], field, k)) reference.emplace_back(value, 0, 0);
      within &= tell(
          told,
          fmt::format("'{}'{} {}", field.name, field.numbers() > 1 ? fmt::format("_{}", "xyz"[k]) : "", when),
          got, reference, [&](size_t i) { return exact.errors->field(field.first + k, i); }, "(SI)", "");
    }
    ++at;
  }
  return within;
}

bool check_state(Told& told, const Beside& exact, const RealFrame& frame, const std::string& when) {
  bool within = true;
  if (!exact.scene.rule.rounds->text()->still) {
    const std::vector<Vec3> forces = exact.reference->forces();
    within &= tell(
        told, "forces " + when, frame.force, forces, [&](size_t i) { return exact.errors->force()[i]; }, "N",
        fmt::format(", largest force {:.3g} N", largest(forces)));
  }
  return check_fields(told, exact, frame, when) && within;
}

}  // namespace

struct TextComparison::Parts {
  Parts(const Scene& scene, bool floats)
      : scene(scene), floats(floats), first(scene, floats), after(scene, floats) {}
  const Scene& scene;
  const bool floats;
  Beside first, after;
};

TextComparison::TextComparison(const Scene& scene, bool floats, uint64_t steps)
    : parts_(std::make_unique<Parts>(scene, floats)) {
  parts_->first.run(0, 0);
  parts_->after.run(steps, kRealTold(floats));
}
TextComparison::~TextComparison() = default;

uint64_t TextComparison::step() const { return parts_->after.step; }

bool TextComparison::compare(Told& told, const std::vector<RealFrame>& frames) const {
  const auto& [scene, floats, first, later] = *parts_;
  const auto& after = later;  // a binding is captured by no lambda
  bool within = check_state(told, first, frames.front(), "at the start");
  const RealFrame& last = frames.back();
  for (const RealFrame& frame : frames) {
    if (frame.step != after.step || after.step == 0) continue;
    const std::string when = fmt::format("after {} steps", after.step);
    if (!scene.rule.rounds->text()->still)
      within &= tell(
          told, "positions " + when, frame.x, after.body.x, [&](size_t) { return after.errors->position(); },
          "m", "");
    within &= check_fields(told, after, frame, when);
  }
  Beside there(scene, floats);
  if (last.step > 0 && there.place(last))
    within &= check_state(told, there, last, fmt::format("after {} steps", last.step));
  return within;
}

}  // namespace cuboct
