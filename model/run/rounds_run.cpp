// SPDX-License-Identifier: MIT
#include "model/run/rounds_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/analysis/body_reading.h"
#include "model/base/error.h"
#include "model/program/rule_program.h"
#include "model/real/rounds_engine.h"
#include "model/run/bond_counters.h"
#include "model/run/reference_engine.h"

namespace cuboct {
namespace {

RealOptions from_step(RealOptions options, uint64_t step) {
  options.first_step = step;
  return options;
}

}  // namespace

Body completed(const Scene& scene, const Body& start) {
  Body body = with_bonds(scene.rule, start, start);
  const bool pd = std::ranges::any_of(scene.rule.types, &ParticleType::pd);
  if (pd && body.u.empty()) body.u.assign(body.size(), Vec3::Zero());
  return body;
}

RoundsRun::RoundsRun(const Scene& scene, const Body& body, const RealOptions& options, double cell_edge,
                     uint64_t step)
    : scene_(scene),
      step_(step),
      body_(completed(scene, body)),
      engine_(make_rounds_engine(scene.rule, body_, scene.periodic, from_step(options, step))),
      options_(std::make_unique<RealOptions>(options)),
      cell_edge_(cell_edge) {}
RoundsRun::~RoundsRun() = default;

void RoundsRun::advance(uint64_t steps, std::vector<uint64_t>*) {
  for (; steps > 0; --steps) {
    try {
      engine_->step(step_);
    } catch (const std::runtime_error& error) {
      throw StepError({Fault::none, step_, 0, 0, 0, error.what()});
    }
    ++step_;
    stale_ = true;
  }
}

void RoundsRun::renew() { engine_->read(body_); }

const Body& RoundsRun::body() {
  if (stale_) renew();
  stale_ = false;
  return body_;
}

uint64_t RoundsRun::hash() { throw std::logic_error("states in real numbers have no hash"); }

RunState RoundsRun::frame(bool forces) {
  const Body& now = body();
  return RealFrame{step_,
                   now.x,
                   now.v,
                   forces ? engine_->forces() : std::vector<Vec3>(),
                   now.u,
                   scene_.rule.rounds->declaration().shown.empty() ? std::vector<std::vector<double>>()
                                                                   : engine_->terms()->shown()};
}

Reading RoundsRun::read(const Asked& asked) {
  const bool half_step = options_->integrator == Integrator::semi_implicit_euler;
  const double late = half_step ? scene_.rule.dt / 2 : 0;
  const Body& now = body();
  std::vector<Vec3> force;
  if (asked.forces || asked.velocities || asked.energies) force = engine_->forces();
  Reading reading = read_body(scene_.rule, now, force, late, asked);
  reading.step = step_;
  if (asked.fields) reading.fields = fields_of(asked.ids);
  if (!asked.energies) return reading;
  reading.energies.potential = engine_->terms()->energy();
  if (asked.watch) asked.watch->see(step_, now, force, reading.energies);
  if (asked.volume > 0)
    for (size_t i = 0; i < now.size(); ++i) reading.stress += engine_->terms()->stress(i, asked.volume);
  return reading;
}

std::vector<std::vector<double>> RoundsRun::fields_of(std::span<const uint32_t> ids) {
  // Fields that steps hand on are there without an evaluation of the rounds.
  const RuleProgram* text = scene_.rule.rounds->text();
  const bool kept = text && std::ranges::all_of(text->particle,
                                                [](const auto& field) { return field.kept || !field.shown; });
  const std::vector<std::vector<double>> all = (kept ? engine_->kept_terms() : engine_->terms())->shown();
  std::vector<std::vector<double>> fields;
  for (const std::vector<double>& values : all) {
    const size_t numbers = values.size() / body_.size();
    std::vector<double>& of = fields.emplace_back();
    for (const uint32_t id : ids)
      of.insert(of.end(), values.begin() + static_cast<ptrdiff_t>(numbers * id),
                values.begin() + static_cast<ptrdiff_t>(numbers * (id + 1)));
  }
  return fields;
}

Momentum RoundsRun::momentum() {
  Vec3 sum = Vec3::Zero();
  const Body& now = body();
  for (size_t i = 0; i < now.size(); ++i) sum += scene_.rule.mass_of(now.type[i]) * now.v[i];
  return {{}, sum};
}

double RoundsRun::largest_speed() { return engine_->largest_speed() * scene_.rule.dt / cell_edge_; }

Counters RoundsRun::counters() { return {{"threads", options_->threads}}; }

Counters RoundsRun::counters_of_state() {
  body();
  return bond_counters(scene_.rule, *engine_->terms(), body_.size());
}

Notes RoundsRun::notes() {
  return {{"precision", "double"},
          {"integrator",
           options_->integrator == Integrator::velocity_verlet ? "velocity Verlet" : "semi-implicit Euler"},
          {"rule", scene_.rule.rounds->declaration().name}};
}

const Body* RoundsRun::saved_body() {
  body();
  keep_bonds(body_, *engine_->kept_terms());
  return &body_;
}

EngineMemory RoundsRun::memory() { return {{static_cast<uint64_t>(options_->precision)}, {}}; }

bool RoundsRun::breaks() const {
  const RoundsRule& rule = *scene_.rule.rounds;
  return rule.declaration().bonds == BondRange::reference && std::isfinite(rule.bond_reach());
}

std::vector<double> RoundsRun::damage() const {
  std::vector<double> damage(body_.size());
  for (size_t i = 0; i < damage.size(); ++i) damage[i] = engine_->terms()->damage(i);
  return damage;
}

std::vector<std::pair<std::string, std::vector<double>>> RoundsRun::shown() {
  std::vector<std::pair<std::string, std::vector<double>>> fields;
  const std::vector<RuleField>& names = scene_.rule.rounds->declaration().shown;
  std::vector<std::vector<double>> values;
  body();
  if (!names.empty()) values = engine_->terms()->shown();
  for (size_t k = 0; k < names.size(); ++k) fields.emplace_back(names[k].name, std::move(values[k]));
  if (breaks() && std::ranges::none_of(names, [](const RuleField& f) { return f.name == "damage"; }))
    fields.emplace_back("damage", damage());
  return fields;
}

EngineKind rounds_kind(const Scene& scene, const Body& start, const RealOptions& options, double cell_edge) {
  EngineKind kind;
  kind.name = "reference";
  kind.particles = start.size();
  kind.fixed = kind.keeps_state = false;
  kind.displaced = std::ranges::any_of(scene.rule.types, &ParticleType::pd);
  kind.initial = [&scene](uint32_t id) { return scene.packing().x[id]; };
  kind.saves = options.integrator == Integrator::semi_implicit_euler;
  kind.make = [&scene, &start, options, cell_edge](CheckpointReader* from, bool) {
    if (!from) return std::make_unique<RoundsRun>(scene, start, options, cell_edge);
    return std::make_unique<RoundsRun>(scene, saved_body(*from, scene.rule, start, options.precision),
                                       options, cell_edge, from->head().step);
  };
  return kind;
}

}  // namespace cuboct
