// SPDX-License-Identifier: MIT
#include "model/program/step_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

constexpr int kPowers = 30;          // of the iteration: a band's edge is met to some 3 % of an eigenvalue
constexpr size_t kMost = 4000;       // particles that are looked at
constexpr double kChange = 1e-6;     // of the reach, of velocities, of a field's size
constexpr double kSafety = 0.2;      // the step at which formulas of dt are looked at, over the limit
constexpr int kSteps = 6;            // to find that step
constexpr double kFurther = 1e4;     // a step over one in which fields change too little to be seen
constexpr int kFurthest = 6;         // times that it is taken
constexpr double kAlike = 0.01;      // two steps, or rates
constexpr double kNoChange = 1e-13;  // of an update that rounds alone

// What is looked at, and which particles of it may be changed: all others are there to act on these.
struct Part {
  Body body;
  Periodic periodic;
  std::vector<bool> inner;
};

Part all_of(const Body& body, const Periodic& periodic) {
  return {body, periodic, std::vector<bool>(body.size(), true)};
}

// Of each type the particles that are nearest to the one nearest to their mean. Those at its rim lack
// neighbours, and are left as they are: what the inner ones do among themselves is no faster than the whole.
Part middle_of(const Body& body, double reach, size_t rounds) {
  std::vector<std::vector<size_t>> of_type(256);
  for (size_t i = 0; i < body.size(); ++i) of_type[body.type[i]].push_back(i);
  const auto types =
      static_cast<size_t>(std::ranges::count_if(of_type, [](const auto& t) { return !t.empty(); }));
  const size_t most = std::max<size_t>(kMost / types, 200);
  const double rim = reach * static_cast<double>(rounds);
  std::vector<bool> taken(body.size()), inner(body.size());
  for (const std::vector<size_t>& those : of_type) {
    if (those.empty()) continue;
    Vec3 mean = Vec3::Zero();
    for (const size_t i : those) mean += body.x[i] / static_cast<double>(those.size());
    const auto away = [&](const Vec3& from) {
      return [&body, from](size_t i) { return (body.x[i] - from).norm(); };
    };
    const Vec3 middle = body.x[*std::ranges::min_element(those, {}, away(mean))];
    std::vector<size_t> near(body.size());
    for (size_t i = 0; i < near.size(); ++i) near[i] = i;
    const size_t count = std::min(most, near.size());
    std::ranges::nth_element(near, near.begin() + static_cast<ptrdiff_t>(count) - 1, {}, away(middle));
    const double radius = away(middle)(near[count - 1]);
    for (size_t k = 0; k < count; ++k) {
      taken[near[k]] = true;
      if (away(middle)(near[k]) <= std::max(radius - rim, 0.0)) inner[near[k]] = true;
    }
  }
  Part part;
  for (size_t i = 0; i < body.size(); ++i) {
    if (!taken[i]) continue;
    part.body.x.push_back(body.x[i]), part.body.v.push_back(body.v[i]),
        part.body.type.push_back(body.type[i]);
    part.inner.push_back(inner[i]);
  }
  return part;
}

using Values = std::vector<double>;

double largest_of(const Values& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

// Of a linear map its largest eigenvalue, by magnitude, in the norm in which it is symmetric.
double power_iteration(Values y, const Values& weight, const std::function<Values(const Values&)>& map) {
  const auto norm = [&](const Values& of) {
    double sum = 0;
    for (size_t k = 0; k < of.size(); ++k) sum += weight[k] * of[k] * of[k];
    return std::sqrt(sum);
  };
  double grown = 0;
  for (int k = 0; k < kPowers; ++k) {
    const double most = largest_of(y);
    if (!(most > 0) || !std::isfinite(most)) break;
    for (double& value : y) value /= most;
    Values next = map(y);
    grown = norm(next) / norm(y);
    y = std::move(next);
  }
  return std::isfinite(grown) ? grown : 0;
}

// The rule at the start, with formulas of a time step.
class Start {
 public:
  Start(const RuleProgram& program, Rule rule, const Part& part, double dt)
      : program_(program), part_(part), rule_(std::move(rule)), dt_(dt) {
    rule_.dt = dt;
    terms_ = rule_.rounds->bind(rule_, part.body, part.periodic, 1);
    for (const uint8_t type : part.body.type)
      for (int a = 0; a < 3; ++a) mass_.push_back(rule_.mass_of(type));
  }

  // 1/s^2
  double stiffness() {
    const double shift = kChange * program_.reach;
    return power_iteration(any(mass_.size(), 3), mass_, [&](const Values& y) {
      return response([&](double way) { return forces(moved(part_.body.x, y, way * shift), part_.body.v); },
                      shift);
    });
  }
  // 1/s. `speed`: of particles, or of waves.
  double friction(double speed) {
    const double shift = kChange * speed;
    return power_iteration(any(mass_.size(), 3), mass_, [&](const Values& y) {
      return response([&](double way) { return forces(part_.body.x, moved(part_.body.v, y, way * shift)); },
                      shift);
    });
  }
  // What a step changes of the fields that rounds make, over what they differ by: dt R.
  double change_of_fields() {
    const std::vector<uint64_t> begin = terms_->memory();
    const size_t n = part_.body.size();
    Values size;  // of each field's number; 0: of a truth
    for (const ProgramField& field : program_.particle)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) {
        double most = 0;
        for (size_t i = 0; i < n; ++i)
          most = std::max(most, std::abs(std::bit_cast<double>(begin[size.size() * n + i])));
        if (field.range) most = std::max(most, field.range->second - field.range->first);
        size.push_back(field.kind == Value::Kind::truth ? 0 : most > 0 ? most : 1);
      }
    Values y = any(size.size() * n, 1);
    for (size_t k = 0; k < y.size(); ++k)
      if (size[k / n] == 0) y[k] = 0;
    const auto after = [&](const Values& of, double way) {
      std::vector<uint64_t> words = begin;
      for (size_t k = 0; k < of.size(); ++k)
        words[k] =
            std::bit_cast<uint64_t>(std::bit_cast<double>(words[k]) + way * kChange * size[k / n] * of[k]);
      terms_->recall(words);
      evaluate(part_.body.x, part_.body.v, true);
      return terms_->memory();
    };
    const double change = power_iteration(y, Values(y.size(), 1), [&](const Values& of) {
      const std::vector<uint64_t> there = after(of, 1), back = after(of, -1);
      Values next(of.size());
      for (size_t k = 0; k < of.size(); ++k)
        if (size[k / n] > 0 && part_.inner[k % n])
          next[k] = (std::bit_cast<double>(there[k]) - std::bit_cast<double>(back[k])) /
                        (2 * kChange * size[k / n]) -
                    of[k];
      return next;
    });
    terms_->recall(begin);
    return change > kNoChange / kChange ? change : 0;
  }
  double dt() const { return dt_; }

 private:
  // Some vector that leaves out no wave: from a fixed seed.
  Values any(size_t count, size_t numbers) const {
    Values values(count);
    uint64_t dice = 1;
    for (size_t k = 0; k < count; ++k) {
      dice = dice * 6364136223846793005u + 1442695040888963407u;
      const size_t particle = numbers == 1 ? k % part_.inner.size() : k / numbers;
      if (part_.inner[particle]) values[k] = static_cast<double>(dice >> 11) * 0x1p-52 - 1;
    }
    return values;
  }
  static std::vector<Vec3> moved(std::vector<Vec3> x, const Values& y, double shift) {
    for (size_t i = 0; i < x.size(); ++i)
      for (size_t a = 0; a < 3; ++a) x[i][static_cast<int>(a)] += shift * y[3 * i + a];
    return x;
  }
  void evaluate(const std::vector<Vec3>& x, const std::vector<Vec3>& v, bool keeps) {
    terms_->velocities(v);
    terms_->time(0);
    terms_->begin(x);
    run_rounds(*terms_, program_.rounds.size(), x.size(), keeps);
  }
  std::vector<Vec3> forces(const std::vector<Vec3>& x, const std::vector<Vec3>& v) {
    evaluate(x, v, false);
    return terms_->force();
  }
  Values response(const std::function<std::vector<Vec3>(double)>& forces, double shift) const {
    const std::vector<Vec3> there = forces(1), back = forces(-1);
    Values a(mass_.size());
    for (size_t k = 0; k < a.size(); ++k)
      if (part_.inner[k / 3])
        a[k] = (there[k / 3][static_cast<int>(k % 3)] - back[k / 3][static_cast<int>(k % 3)]) /
               (2 * shift * mass_[k]);
    return a;
  }

  const RuleProgram& program_;
  const Part& part_;
  Rule rule_;
  double dt_;
  std::unique_ptr<RoundsTerms> terms_;
  Values mass_;  // kg, of each number of a vector of all particles
};

bool reads(const RuleProgram& program, std::initializer_list<RealSource> sources) {
  return std::ranges::any_of(program.rounds, [&](const ProgramRound& round) {
    return std::ranges::any_of(
        sources, [&](RealSource source) { return round.pair.reads(source) || round.finish.reads(source); });
  });
}

double fastest(const Body& body) {
  double most = 0;
  for (const Vec3& v : body.v) most = std::max(most, v.cwiseAbs().maxCoeff());
  return most;
}

void meet(StepLimit& limit, double dt, const std::string& of) {
  if (dt > 0 && std::isfinite(dt) && (limit.dt == 0 || dt < limit.dt)) limit.dt = dt, limit.of = of;
}

void meet_motion(const RuleProgram& program, const Rule& rule, const Part& part, Start& start,
                 StepLimit& limit) {
  const double w2 = start.stiffness();
  double kp = 0, kd = 0;
  for (size_t k = 0; k < rule.types.size(); ++k) {
    const double mass = rule.mass_of(static_cast<int>(k));
    kp = std::max(kp, rule.types[k].kp / mass), kd = std::max(kd, rule.types[k].kd / mass);
  }
  if (!(w2 + kp > 0)) return;
  const bool damped = reads(program, {RealSource::own_velocity, RealSource::other_velocity});
  const double speed = std::max(fastest(part.body), program.reach * std::sqrt(w2 + kp));
  const double g = kd + (damped ? start.friction(speed) : 0);
  meet(limit, 4 / (std::sqrt(g * g + 4 * (w2 + kp)) + g), "the rule's forces at the start");
}

// A change that is no rate, as of a field that is made anew in each step, sets no limit.
void meet_fields(const RuleProgram& program, const Rule& rule, const Part& part, Start& start,
                 StepLimit& limit) {
  const auto field = std::ranges::find_if(program.particle, &ProgramField::kept);
  if (field == program.particle.end() || !reads(program, {RealSource::time_step})) return;
  const double whole = start.change_of_fields(),
               half = Start(program, rule, part, start.dt() / 2).change_of_fields();
  if (whole > 0 && std::abs(whole - 2 * half) < kAlike * whole)
    meet(limit, 2 * start.dt() / whole, fmt::format("the update of '{}' at the start", field->name));
}

StepLimit limit_at(const RuleProgram& program, const Rule& rule, const Part& part, double dt) {
  StepLimit limit;
  try {
    Start start(program, rule, part, dt);
    if (!program.still) meet_motion(program, rule, part, start, limit);
    meet_fields(program, rule, part, start, limit);
  } catch (const std::runtime_error& error) {
    return {0, "", fmt::format("at the start {}", error.what())};
  }
  if (limit.dt == 0)
    limit.unknown = program.still ? "no field of the rule changes at a rate: by dt, and with what it is"
                                  : "no force of the rule changes with where particles are at the start";
  return limit;
}

}  // namespace

StepLimit step_limit(const RuleProgram& program, const Rule& rule, const Body& body,
                     const Periodic& periodic) {
  const Part part =
      body.size() > kMost ? middle_of(body, program.reach, program.rounds.size()) : all_of(body, periodic);
  // Formulas of dt are looked at near the step that will be taken; others, with any.
  double dt = 1e-3 * program.reach / std::max(fastest(part.body), 1.0);
  StepLimit limit = limit_at(program, rule, part, dt);
  const StepLimit nearest = limit;
  for (int k = 0; k < kFurthest && limit.dt == 0 && reads(program, {RealSource::time_step}); ++k)
    limit = limit_at(program, rule, part, dt *= kFurther);
  if (limit.dt == 0) return nearest;
  for (int k = 0; k < kSteps; ++k) {
    if (k > 0) limit = limit_at(program, rule, part, dt);
    const double next = kSafety * limit.dt;
    if (limit.dt == 0 || !reads(program, {RealSource::time_step}) || std::abs(next - dt) < kAlike * dt) break;
    dt = next;
  }
  return limit;
}

}  // namespace cuboct
