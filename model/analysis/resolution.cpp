// SPDX-License-Identifier: MIT
#include "model/analysis/resolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/contract/law.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

// Half of the 1 % to which probes are to be right.
constexpr double kAchieved = 5e-3;
// A staircase of n steps is off by up to 1/(2n): 6 % at 8, below 1 % at 64.
constexpr double kFew = 8, kEnough = 64;
// Of the energy that would shake every bond as far as the scene stretches any: then noise hides the strain.
constexpr double kEnergy = 0.5;

// The widest that formats may be: docs/user/arch.md.
constexpr int kMostPosition = 30, kMostDifference = 24, kMostStrength = 27, kMostVelocityFrac = 50;

bool leads(const ParticleType& type) { return type.pd || type.imposed != std::array<bool, 3>{}; }

// Particles of a type that are looked at, bonds of that many particles.
constexpr size_t kSample = 512;

// Additional bits that make a unit at most `wanted`.
int more_bits(double unit, double wanted) {
  return unit > wanted ? static_cast<int>(std::ceil(std::log2(unit / wanted))) : 0;
}

}  // namespace

Resolution::Resolution(const Scene& scene) : scene_(scene), type_(scene.body.type) {
  const Rule& rule = scene.rule;
  const Body& body = scene.body;
  bool held = false, moved = false, weighs = false, pulled = false;
  std::vector<char> is_free;
  for (size_t t = 0; t < rule.types.size(); ++t) {
    const ParticleType& type = rule.types[t];
    held |= leads(type);
    weighs |= !type.gravity.isZero(0);
    pulled |= !type.pull.isZero(0);
    is_free.push_back(!leads(type));
    if (!leads(type) || type.velocity.isZero(0)) continue;
    moved = true;
    led_.push_back({static_cast<uint8_t>(t), {}, {}});
  }
  loaded_ = moved || pulled || (weighs && held);
  for (Led& led : led_) {
    for (uint32_t id = 0; id < body.size(); ++id)
      if (body.type[id] == led.type) led.ids.push_back(id);
    const size_t every = led.ids.size() / kSample + 1;
    for (size_t k = 0; k * every < led.ids.size(); ++k) led.ids[k] = led.ids[k * every];
    led.ids.resize((led.ids.size() + every - 1) / every);
    for (const uint32_t id : led.ids) led.start.push_back(body.x[id]);
  }

  Vec3 mean = Vec3::Zero();
  double free = 0, moving = 0, speed2 = 0, energy2 = 0;
  for (uint32_t id = 0; id < body.size(); ++id) {
    if (!is_free[body.type[id]]) continue;
    const double relative = rule.relative_mass(body.type[id]);
    mean += relative * body.v[id];
    free += relative;
    speed2 += body.v[id].squaredNorm();
    energy2 += relative * body.v[id].squaredNorm();
    moving += body.v[id].isZero(0) ? 0 : 1;
  }
  if (moving > 0) {
    speed_ = std::sqrt(speed2 / moving);
    vibration_ = 0.5 * rule.mass * (held ? energy2 : energy2 - mean.squaredNorm() / free);
  }
  if (loaded_ || vibration_ > 0) choose_bonds();
  shown_ = bonds_.empty() || !(loaded_ || vibration_ > 0);
}

// All bonds of some particles, and whether initial velocities stretch them: a body that moves or turns as a
// whole is not strained by that, unless something holds it.
void Resolution::choose_bonds() {
  const Rule& rule = scene_.rule;
  const Body& body = scene_.body;
  const double range = bond_range(scene_);
  rest_ = scene_.pitch > 0 ? scene_.pitch : stiffest_rest_distance(rule.law_at(0));
  if (range > 0 && rest_ > 0) stiffness_ = stiffest_bond(rule, rest_);
  double apart = 0;
  if (stiffness_ > 0) {
    CellList cells(range, scene_.periodic);
    cells.build(body.x);
    const std::span<const uint32_t> order = cells.order();
    for (size_t k = 0; k < order.size(); k += order.size() / kSample + 1) {
      const uint32_t i = order[k];
      cells.for_each_near(cells.cell_at(body.x[i]), [&](int64_t cell) {
        for (uint32_t at = cells.begin_of(cell); at < cells.end_of(cell); ++at) {
          const uint32_t j = order[at];
          const Vec3 d = cells.difference(body.x[i], body.x[j]);
          const double length = d.norm();
          if (length == 0 || length >= range) continue;
          bonds_.push_back({i, j, length});
          if (!leads(rule.types[type_[i]]) || !leads(rule.types[type_[j]]))
            apart = std::max(apart, std::abs((body.v[j] - body.v[i]).dot(d)) / length);
        }
      });
    }
  }
  if (apart <= 1e-9 * speed_) vibration_ = 0;
  const size_t stride = body.size() / kSample + 1, looked = body.size() / stride + 1;
  bond_count_ = 0.5 * static_cast<double>(bonds_.size()) / static_cast<double>(looked) *
                static_cast<double>(body.size());
  if (vibration_ > 0) vibrated_ = std::sqrt(2 * vibration_ / (stiffness_ * bond_count_));
}

std::vector<Resolution::Unit> Resolution::units(const FixedRule& rule, double rest, double stiffness) {
  const Widths& w = rule.widths;
  const double edge = rule.cell_edge;
  // A stretch r of a bond changes a kick by kick r/edge, in cells per step, and an entry of the force table,
  // which is a kick over a distance, by kick r/rest.
  const double kick = stiffness * rule.dt * rule.dt / rule.mass;
  // The heaviest particles' velocities change least.
  int64_t weight = FixedType{}.weight;
  for (const FixedType& type : rule.types) weight = std::min(weight, type.weight);
  const double slowest = std::ldexp(kick * static_cast<double>(weight), -kWeightFrac);
  return {{"difference_frac", w.difference_frac, std::ldexp(edge, -w.difference_frac)},
          {"position_frac", w.position_frac, std::ldexp(edge, -w.position_frac)},
          {"guard", w.guard, std::ldexp(edge, -w.velocity_frac()) / slowest},
          {"strength_bits", w.strength_bits, std::ldexp(rest, -rule.force.value_frac) / kick}};
}

namespace {

const Resolution::Unit& coarsest(const std::vector<Resolution::Unit>& units) {
  return *std::max_element(units.begin(), units.end(),
                           [](const auto& a, const auto& b) { return a.stretch < b.stretch; });
}

}  // namespace

// Widths with which `stretch` has enough units.
std::string Resolution::remedy(double stretch) const {
  const double wanted = stretch / kEnough;
  const Widths& now = widths_;
  const auto unit = [&](int k) { return units_[static_cast<size_t>(k)].stretch; };
  const int difference = now.difference_frac + more_bits(unit(0), wanted),
            position = std::max(difference, now.position_frac + more_bits(unit(1), wanted)),
            most_guard = kMostVelocityFrac - position,
            guard = std::max(now.guard, now.velocity_frac() + more_bits(unit(2), wanted) - position);
  // A kick is no coarser than velocities: an entry and a difference have P + G fractional bits together, or
  // more.
  const int strength =
      now.strength_bits +
      std::max(more_bits(unit(3), wanted), position + std::min(guard, most_guard) - difference - value_frac_);
  std::string text;
  bool fits = true;
  const auto name = [&](const char* key, int from, int to, int most) {
    if (to == from) return;
    fits &= to <= most;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key, std::min(to, most));
  };
  name("difference_frac", now.difference_frac, difference, kMostDifference);
  name("position_frac", now.position_frac, position, kMostPosition);
  name("guard", now.guard, std::min(guard, std::max(now.guard, most_guard)), most_guard);
  name("strength_bits", now.strength_bits, strength, kMostStrength);
  const int wider = std::min(position, kMostPosition) + std::min(guard, most_guard) - now.velocity_frac();
  if (wider > 0) text += fmt::format(", velocity_bits, sum_bits and displacement_bits {} wider", wider);
  return text + (fits ? " would do" : ": the widest that formats may be, and not enough for 64 units");
}

std::optional<Resolution::Lack> Resolution::see(const Moment& moment) {
  if (moment.fixed && units_.empty()) {
    widths_ = moment.fixed->widths;
    value_frac_ = moment.fixed->force.value_frac;
    if (stiffness_ > 0) units_ = units(*moment.fixed, rest_, stiffness_);
  }
  see_stretch(moment);
  if (auto lack = see_led(moment)) return lack;
  return moment.fixed ? see_speed(*moment.fixed) : std::nullopt;
}

// A controller leads its anchor, and what it leads lags behind by u.
std::optional<Resolution::Lack> Resolution::see_led(const Moment& moment) const {
  if (scene_.deforms()) return std::nullopt;  // the box carries them besides
  const double time = static_cast<double>(moment.step) * scene_.rule.dt;
  for (const Led& led : led_) {
    const ParticleType& type = scene_.rule.types[led.type];
    if (led.ids.empty() || (type.pd && !moment.u)) continue;
    Vec3 displacement = time * type.velocity, off = Vec3::Zero();
    for (size_t k = 0; k < led.ids.size(); ++k) {
      Vec3 moved = moment.x(led.ids[k]) - led.start[k];
      if (type.pd) moved -= moment.u(led.ids[k]);
      off += nearest_image(moved - displacement, scene_.periodic);
    }
    off /= static_cast<double>(led.ids.size());
    for (int a = 0; a < 3; ++a)
      if (!type.pd && !type.imposed[a]) off[a] = displacement[a] = 0;
    const double length = displacement.norm();
    // Where a particle stood at first is rounded too.
    const double unit = moment.fixed
                            ? std::ldexp(moment.fixed->cell_edge, -moment.fixed->widths.velocity_frac())
                            : 1e-6 * scene_.rule.cutoff();
    if (!(off.norm() > kAchieved * length + 2 * unit)) continue;
    Lack lack{led.ids[0], moment.x(led.ids[0]), off.norm() / length, kAchieved, {}};
    lack.text = fmt::format("what '{}' moves has gone {:.4g} m and should have gone {:.4g} m", type.name,
                            (displacement + off).dot(displacement) / length, length);
    if (!moment.fixed) {
      lack.text += "; the numbers of this engine do not hold such short steps, doubles do";
      return lack;
    }
    // The velocity is a whole number of units; so many guard bits round it by less than the tenth of the
    // limit.
    const FixedRule& rule = *moment.fixed;
    double error = 0, least = 0;
    for (int a = 0; a < 3; ++a) {
      const double units =
          std::ldexp(type.velocity[a] * rule.dt / rule.edges()[a], rule.widths.velocity_frac());
      error = std::hypot(error, units - static_cast<double>(rule.types[led.type].velocity[a]));
      least = std::hypot(least, units);
    }
    const int more = more_bits(0.5, 0.1 * kAchieved * least);
    if (error > 0.5 * lack.number * least)
      lack.text += fmt::format(
          "; its velocity is {:.4g} units of 2^-(position_frac + guard) cells per step, rounded to whole "
          "ones; "
          "guard = {} would do, velocity_bits, sum_bits and displacement_bits {} wider",
          least, rule.widths.guard + more, more);
    else
      lack.text += "; its velocity is not rounded by that much: the engine loses motion in the drift";
    return lack;
  }
  return std::nullopt;
}

std::optional<Resolution::Lack> Resolution::see_speed(const FixedRule& rule) const {
  const double unit = std::ldexp(rule.cell_edge / rule.dt, -rule.widths.velocity_frac());
  if (!(speed_ > 0) || speed_ >= kFew * unit) return std::nullopt;
  const int more = more_bits(unit, speed_ / kEnough);
  return Lack{
      std::nullopt, Vec3::Zero(), speed_ / unit, kFew,
      fmt::format("initial velocities of {:.3g} m/s are {:.2g} units of a velocity, {:.3g} m/s at guard "
                  "= {}; guard = {} would do, velocity_bits and sum_bits {} wider",
                  speed_, speed_ / unit, unit, rule.widths.guard, rule.widths.guard + more, more)};
}

void Resolution::see_stretch(const Moment& moment) {
  if (shown_ || units_.empty()) return;
  for (const Bond& b : bonds_) {
    const double length = nearest_image(moment.x(b.j) - moment.x(b.i), scene_.periodic).norm();
    stretched_ = std::max(stretched_, std::abs(length - b.length));
  }
  shown_ = stretched_ >= kFew * coarsest(units_).stretch;
  if (shown_)
    latest_ = {};
  else if (moment.step > 0) {
    latest_.resize(type_.size());
    for (uint32_t id = 0; id < type_.size(); ++id) latest_[id] = moment.x(id);
  }
}

const ExpectedStrain& Resolution::expected(const std::vector<Vec3>& x) {
  if (!expected_)
    expected_ = loaded_
                    ? expected_strain(scene_, x, type_, static_cast<double>(scene_.steps) * scene_.rule.dt)
                    : ExpectedStrain{};
  return *expected_;
}

std::optional<Resolution::Lack> Resolution::see_energy(const Moment& moment, double change, double kinetic) {
  if (units_.empty() || !(std::abs(change) > 0.1 * kEnergy * kinetic)) return std::nullopt;
  // Sums of doubles.
  if (std::abs(change) < 1e-13 * std::abs(moment.energies.potential)) return std::nullopt;
  std::vector<Vec3> x(type_.size());
  if (!expected_ && loaded_)
    for (uint32_t id = 0; id < x.size(); ++id) x[id] = moment.x(id);
  const double stretch = std::max(expected(x).stretch, vibrated_),
               held = 0.5 * bond_count_ * stiffness_ * stretch * stretch;
  if (!(held > 0) || !(std::abs(change) > kEnergy * held)) return std::nullopt;
  const Unit& unit = coarsest(units_);
  // The energy of a staircase goes as the square of its unit.
  const double wanted =
      std::min(stretch, kEnough * unit.stretch * std::sqrt(0.1 * kEnergy * held / std::abs(change)));
  return Lack{
      std::nullopt, Vec3::Zero(), std::abs(change) / held, kEnergy,
      fmt::format(
          "the energy is off by {:.3g} J, the scene's motion has {:.3g} J: bonds shake by {:.3g} m, "
          "and the scene stretches them by {:.3g} m at most; they are told apart by {:.3g} m, of {} = "
          "{}; {}",
          change, std::max(expected_->energy, vibration_),
          std::sqrt(2 * std::abs(change) / (bond_count_ * stiffness_)), stretch, unit.stretch, unit.key,
          unit.bits, remedy(wanted))};
}

std::optional<Resolution::Lack> Resolution::conclude() {
  if (shown_ || units_.empty() || latest_.empty()) return std::nullopt;
  const ExpectedStrain& load = expected(latest_);
  const Unit& unit = coarsest(units_);
  const double stretch = std::max(load.stretch, vibrated_);
  if (!(stretch > 0) || stretch >= kFew * unit.stretch) return std::nullopt;
  Lack lack{std::nullopt, Vec3::Zero(), stretch / unit.stretch, kFew, {}};
  if (load.stretch >= vibrated_) lack.particle = load.particle, lack.place = latest_[load.particle];
  lack.text = fmt::format(
      "bonds are to stretch by {:.3g} m and have stretched by {:.3g} m: {:.2g} units of what is told apart, "
      "{:.3g} m "
      "of {} = {}; {}",
      stretch, stretched_, stretch / unit.stretch, unit.stretch, unit.key, unit.bits, remedy(stretch));
  return lack;
}

}  // namespace cuboct
