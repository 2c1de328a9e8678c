// SPDX-License-Identifier: MIT
#include "model/run/integer_run.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "model/base/error.h"
#include "model/program/program_rule.h"
#include "model/real/real_engine.h"

namespace cuboct {
namespace {

const RuleProgram& text_of(const Scene& scene) { return *scene.rule.rounds->text(); }

// Reads one number of a field back.
double real_of(const FieldScale& scale, int64_t number) {
  return std::ldexp(scale.unit * static_cast<double>(number), -scale.frac);
}

std::unique_ptr<IntegerEngine> made(const ProgramSetting& setting, const State& state,
                                    const MakeIntegerEngine& make) {
  if (make) return make(state);
  return std::make_unique<GoldenIntegers>(setting.program.program, setting.lattice, setting.capacity, state,
                                          setting.program.rows);
}

}  // namespace

State program_beginning(const Scene& scene, const ProgramSetting& setting) {
  const Body body = with_bonds(scene.rule, scene.body, scene.body);
  State state = to_fixed(body, setting.fixed, setting.lattice, setting.origin);
  const ProgramStart start = starts_of(text_of(scene), scene.rule, body, scene.periodic);
  const IntegerProgram& program = setting.program;
  for (const Particle& particle : state.particles)
    for (size_t f = 0; f < program.field.size(); ++f) {
      const ProgramField& field = text_of(scene).particle[program.field[f]];
      const graph::Interval range = program.program.fields[f].range;
      for (uint32_t n = 0; n < field.numbers(); ++n) {
        const double value = start.particle[field.first + n][particle.id] / program.scales[f].unit;
        state.fields.push_back(std::clamp<int64_t>(std::llround(std::ldexp(value, program.scales[f].frac)),
                                                   range.low, range.high));
      }
    }
  state.bonds = bond_numbers(program, text_of(scene), start);
  return state;
}

std::vector<uint64_t> program_memory(const State& state) {
  std::vector<uint64_t> numbers(state.fields.begin(), state.fields.end());
  numbers.insert(numbers.end(), state.bonds.begin(), state.bonds.end());
  return numbers;
}

IntegerRun::IntegerRun(const Scene& scene, const ProgramSetting& setting, const State& from,
                       const MakeIntegerEngine& make)
    : RoundsRun(scene, scene.body, {.on_demand = true}, setting.fixed.cell_edge, from.step),
      setting_(setting),
      program_(made(setting, from, make)) {
  stale_ = true;
}

size_t program_words(const IntegerProgram& program, size_t particles) {
  const size_t bonds = program.rows ? program.rows->other.size() : 0;
  return static_cast<size_t>(program.program.numbers()) * particles +
         bonds * static_cast<size_t>(program.program.bond_numbers());
}

State state_of_checkpoint(State particles, const IntegerProgram& program,
                          const std::vector<uint64_t>& memory) {
  const auto numbers = static_cast<size_t>(program.program.numbers());
  const size_t fields = numbers * particles.particles.size();
  if (memory.size() != program_words(program, particles.particles.size()))
    throw InputError("the checkpoint does not hold the fields of this rule");
  for (const Particle& particle : particles.particles)
    for (size_t f = 0; f < numbers; ++f)
      particles.fields.push_back(static_cast<int64_t>(memory[particle.id * numbers + f]));
  particles.bonds.assign(memory.begin() + static_cast<ptrdiff_t>(fields), memory.end());
  return particles;
}

void IntegerRun::advance(uint64_t steps, std::vector<uint64_t>* hashes) {
  const auto look = [&] {
    step_ = program_->step_count();
    stale_ = true;
  };
  try {
    program_->advance(steps, hashes);
  } catch (...) {
    look();
    throw;
  }
  look();
}

EngineMemory IntegerRun::memory() {
  std::vector<uint64_t> own = program_memory(program_->state());
  const std::vector<uint64_t> clocks = program_->clocks();
  own.insert(own.end(), clocks.begin(), clocks.end());
  return {{}, std::move(own)};
}

Momentum IntegerRun::momentum() {
  return {cuboct::momentum(setting_.fixed, program_->state()), RoundsRun::momentum().real};
}

template <typename Work>
auto IntegerRun::together(const Work& work) {
  std::optional<decltype(work())> made;
  std::exception_ptr error;
  try {
    made = work();
  } catch (...) {
    error = std::current_exception();
  }
  const bool failed = agreed(error != nullptr, false).first;
  if (error) std::rethrow_exception(error);
  if (failed) throw RoundsError("the process that leads cannot read the state");
  return std::move(*made);
}

Reading IntegerRun::read(const Asked& asked) {
  return together([&] {
    body();
    if (takes_velocities(asked)) next_velocities_ = program_->next_velocities();
    return leads() ? RoundsRun::read(asked) : Reading{};
  });
}

RunState IntegerRun::frame(bool forces) {
  return together([&] {
    body();
    return leads() ? RoundsRun::frame(forces) : RunState(RealFrame{});
  });
}

const Body* IntegerRun::saved_body() {
  const Body& now = body();
  return leads() ? RoundsRun::saved_body() : &now;
}

double IntegerRun::largest_speed() {
  body();
  return fastest_ * scene_.rule.dt / setting_.fixed.cell_edge;
}

// Those of the two half steps around the positions have their mean there, to the last bit of what the step
// adds. What is imposed does not change within a step, but for the one that imposes it.
std::vector<Vec3> IntegerRun::velocities(const std::vector<Vec3>& force) {
  const std::vector<Int3> next = std::exchange(next_velocities_, {});
  if (next.empty()) return RoundsRun::velocities(force);  // no step follows
  const Vec3 unit = velocity_units(setting_.fixed);
  std::vector<Vec3> v = body_.v;
  for (size_t i = 0; i < v.size(); ++i)
    for (size_t a = 0; a < 3; ++a)
      if (!scene_.rule.types[body_.type[i]].imposed[a])
        v[i][static_cast<int>(a)] =
            (v[i][static_cast<int>(a)] + static_cast<double>(next[i][a]) * unit[static_cast<int>(a)]) / 2;
  return v;
}

std::vector<std::vector<double>> IntegerRun::fields() {
  if (!hands_on_fields()) return RoundsRun::fields();
  std::vector<std::vector<double>> shown;
  const graph::FixedProgram& program = setting_.program.program;
  for (size_t k = 0; k < text_of(scene_).particle.size(); ++k) {
    const ProgramField& field = text_of(scene_).particle[k];
    if (!field.shown) continue;
    const auto f =
        static_cast<size_t>(std::ranges::find(setting_.program.field, k) - setting_.program.field.begin());
    const auto first = static_cast<size_t>(program.place(static_cast<int>(f)));
    std::vector<double>& values = shown.emplace_back();
    for (size_t i = 0; i < body_.size(); ++i)
      for (uint32_t n = 0; n < field.numbers(); ++n)
        values.push_back(real_of(setting_.program.scales[f],
                                 field_numbers_[i * static_cast<size_t>(program.numbers()) + first + n]));
  }
  if (text_of(scene_).shows_damage) shown.push_back(damage());
  return shown;
}

void IntegerRun::renew() {
  State state = program_->state();
  if (!leads()) return;
  body_ = with_bonds(scene_.rule, to_real(state, setting_.fixed, setting_.lattice, setting_.origin), body_);
  for (const Vec3& v : body_.v) fastest_ = std::max(fastest_, v.cwiseAbs().maxCoeff());
  field_numbers_ = std::move(state.fields), bond_numbers_ = std::move(state.bonds);
}

// What the rule keeps of each particle and bond, as its terms in doubles take it.
void IntegerRun::follow(RealEngine& reference) {
  const IntegerProgram& program = setting_.program;
  std::vector<uint64_t> kept = reference.kept_terms()->memory();
  auto to = kept.begin();
  // The numbers of a field, where it goes on: of the particles, or of the bonds, one number after another.
  const auto recall = [&](const ProgramField& field, const FieldScale& scale,
                          const std::vector<int64_t>& from, size_t place, size_t stride) {
    for (uint32_t n = 0; n < field.numbers(); ++n)
      for (size_t k = place + n; k < from.size(); k += stride)
        *to++ = std::bit_cast<uint64_t>(real_of(scale, from[k]));
  };
  for (size_t f = 0; f < program.field.size(); ++f) {
    const ProgramField& field = text_of(scene_).particle[program.field[f]];
    if (field.kept)
      recall(field, program.scales[f], field_numbers_,
             static_cast<size_t>(program.program.place(static_cast<int>(f))),
             static_cast<size_t>(program.program.numbers()));
  }
  for (size_t k = 0; program.rows && k < text_of(scene_).bond.size(); ++k) {
    const ProgramField& field = text_of(scene_).bond[k];
    const auto at = std::ranges::find(program.bond_field, k);
    const auto f = at - program.bond_field.begin();
    if (at != program.bond_field.end())
      recall(field, program.bond_scales[static_cast<size_t>(f)], bond_numbers_,
             static_cast<size_t>(program.program.bond_place(static_cast<int>(f))),
             static_cast<size_t>(program.program.bond_numbers()));
    else if (field.kept)
      to += static_cast<ptrdiff_t>(field.numbers() * program.rows->other.size());
  }
  reference.place(body_, step_);
  reference.recall(kept);
}

Counters IntegerRun::counters_of_state() {
  if (!setting_.program.rows) return {};
  body();
  return leads() ? RoundsRun::counters_of_state() : Counters();
}

Notes IntegerRun::notes() {
  Notes notes = program_->notes();
  notes.emplace_back("rule", scene_.rule.rounds->declaration().name);
  return notes;
}

}  // namespace cuboct
