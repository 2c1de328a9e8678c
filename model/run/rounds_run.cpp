// SPDX-License-Identifier: MIT
#include "model/run/rounds_run.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "model/analysis/body_reading.h"
#include "model/base/error.h"
#include "model/program/rule_program.h"
#include "model/real/rounds_engine.h"
#include "model/run/bond_counters.h"
#include "model/run/reference_engine.h"

namespace cuboct {
namespace {

// Of all particles' values those of some, field by field.
std::vector<std::vector<double>> rows_of(const std::vector<std::vector<double>>& all, size_t particles,
                                         std::span<const uint32_t> ids) {
  std::vector<std::vector<double>> rows;
  for (const std::vector<double>& values : all) {
    const size_t numbers = values.size() / particles;
    std::vector<double>& row = rows.emplace_back();
    for (const uint32_t id : ids)
      row.insert(row.end(), values.begin() + static_cast<ptrdiff_t>(numbers * id),
                 values.begin() + static_cast<ptrdiff_t>(numbers * (id + 1)));
  }
  return rows;
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
      options_(std::make_unique<RealOptions>(from_step(options, scene, step))),
      cell_edge_(cell_edge) {
  if (options.on_demand)
    start_ = body_;
  else
    make_reference(body_);
}
RoundsRun::~RoundsRun() = default;

void RoundsRun::make_reference(const Body& start) {
  engine_ = make_rounds_engine(scene_.rule, start, scene_.box_at(options_->first_step), *options_);
}

void RoundsRun::advance(uint64_t steps, std::vector<uint64_t>*) {
  for (; steps > 0; --steps) {
    refuse_box(scene_, step_);
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
  if (stale_) renew(), behind_ = true;
  stale_ = false;
  return body_;
}

RealEngine& RoundsRun::reference() {
  body();
  if (!engine_) {
    make_reference(std::exchange(start_, {}));
    behind_ = true;
  }
  if (std::exchange(behind_, false)) follow(*engine_);
  return *engine_;
}

std::vector<Vec3> RoundsRun::forces() { return reference().forces(); }

std::vector<Vec3> RoundsRun::velocities(const std::vector<Vec3>& force) {
  const bool half_step = options_->integrator == Integrator::semi_implicit_euler;
  const double late = half_step ? scene_.rule.dt / 2 : 0;
  return velocities_at(scene_.rule, body(), late != 0 && force.empty() ? forces() : force, late);
}

bool RoundsRun::hands_on_fields() const {
  const RuleProgram* text = scene_.rule.rounds->text();
  return text != nullptr &&
         std::ranges::all_of(text->particle, [](const auto& field) { return field.kept || !field.shown; });
}

std::vector<std::vector<double>> RoundsRun::fields() {
  if (scene_.rule.rounds->declaration().shown.empty()) return {};
  return (hands_on_fields() ? reference().kept_terms() : reference().terms())->shown();
}

RunState RoundsRun::frame(bool forces) {
  const Body& now = body();
  return RealFrame{step_, now.x, now.v, forces ? this->forces() : std::vector<Vec3>(), now.u, fields()};
}

Reading RoundsRun::read(const Asked& asked) {
  const Body& now = body();
  std::vector<Vec3> force, v;
  if (asked.forces || asked.watch) force = forces();
  if (takes_velocities(asked)) v = velocities(force);
  Reading reading = read_body(scene_.rule, now, force, v, asked);
  reading.step = step_;
  if (asked.fields) reading.fields = rows_of(fields(), now.size(), asked.ids);
  if (!asked.stress.empty()) {
    const RoundsTerms& terms = *reference().terms();
    std::vector<Mat3> virial(now.size());
    for (size_t i = 0; i < now.size(); ++i) virial[i] = terms.stress(i, 1);
    reading.stress_volume = summed_stress(scene_.rule, now.type, v, virial, asked.stress);
  }
  if (!asked.energies) return reading;
  const RoundsTerms& terms = *reference().terms();
  reading.energies.potential = terms.energy();
  if (asked.watch) asked.watch->see(step_, now, force, reading.energies);
  if (asked.volume > 0)
    for (size_t i = 0; i < now.size(); ++i) reading.stress += terms.stress(i, asked.volume);
  return reading;
}

Momentum RoundsRun::momentum() {
  Vec3 sum = Vec3::Zero();
  const Body& now = body();
  for (size_t i = 0; i < now.size(); ++i) sum += scene_.rule.mass_of(now.type[i]) * now.v[i];
  return {{}, sum};
}

double RoundsRun::largest_speed() { return reference().largest_speed() * scene_.rule.dt / cell_edge_; }

Counters RoundsRun::counters() { return {{"threads", options_->threads}}; }

Counters RoundsRun::counters_of_state() {
  // Bonds of the moment are counted by the rounds; what became of those that last is handed on.
  const bool last = has_reference_bonds(scene_.rule);
  return bond_counters(scene_.rule, last ? *reference().kept_terms() : *reference().terms(), body_.size());
}

Notes RoundsRun::notes() {
  return {{"precision", "double"},
          {"integrator",
           options_->integrator == Integrator::velocity_verlet ? "velocity Verlet" : "semi-implicit Euler"},
          {"rule", scene_.rule.rounds->declaration().name}};
}

const Body* RoundsRun::saved_body() {
  keep_bonds(body_, *reference().kept_terms());
  return &body_;
}

EngineMemory RoundsRun::memory() { return {{static_cast<uint64_t>(options_->precision)}, {}}; }

bool RoundsRun::breaks() const {
  const RoundsRule& rule = *scene_.rule.rounds;
  return rule.declaration().bonds == BondRange::reference && std::isfinite(rule.bond_reach());
}

std::vector<double> RoundsRun::damage() {
  std::vector<double> damage = reference().kept_terms()->damage();
  damage.resize(body_.size(), 0);
  return damage;
}

std::vector<std::pair<std::string, std::vector<double>>> RoundsRun::shown() {
  std::vector<std::pair<std::string, std::vector<double>>> shown;
  const std::vector<RuleField>& names = scene_.rule.rounds->declaration().shown;
  std::vector<std::vector<double>> values = fields();
  for (size_t k = 0; k < names.size(); ++k) shown.emplace_back(names[k].name, std::move(values[k]));
  return shown;
}

}  // namespace cuboct
