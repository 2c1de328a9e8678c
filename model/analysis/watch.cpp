// SPDX-License-Identifier: MIT
#include "model/analysis/watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "model/analysis/motion.h"
#include "model/analysis/strain.h"
#include "model/analysis/unstable.h"
#include "model/base/parallel.h"
#include "model/contract/fixed_step.h"
#include "model/contract/law.h"
#include "model/contract/neighbours.h"
#include "model/real/near_walk.h"
#include "model/scene/scene_parts.h"

namespace cuboct {
namespace {

// Bonds of a particle in the packing. What presses harder than all of them pull at their strongest is beyond
// what the body could ever transmit in tension.
constexpr int kBonds = 12;

constexpr size_t kWatchedPerThread = 4096;  // particles

constexpr double kCreep = 1e-3;  // of the pitch: where a law's stiffness begins to change

// Where a bond is at rest, m; of a law that only pushes the core, where it is stiffest.
double bond_length(const PairLaw& law) {
  const double rest = stiffest_rest_distance(law);
  return rest > 0 ? rest : law.core();
}

double strongest_pull(const PairLaw& law) {
  constexpr int kSamples = 4096;
  double most = 0;
  for (int k = 1; k < kSamples; ++k) most = std::max(most, -law.force(law.cutoff() * k / kSamples));
  return most;
}

double largest_of(const std::vector<std::vector<double>>& strength) {
  double most = 0;
  for (const auto& row : strength) most = std::max(most, *std::max_element(row.begin(), row.end()));
  return most;
}

double least_of(const std::vector<std::vector<double>>& strength) {
  double least = largest_of(strength);
  for (const auto& row : strength) least = std::min(least, *std::min_element(row.begin(), row.end()));
  return least;
}

// The limit of dt, s: that of the scene, or where it has none of a packing of such bonds.
double limit_of(const Scene& scene) {
  if (scene.dt_limit > 0) return scene.dt_limit;
  // Three digits are more than the looks at it need.
  constexpr double kTolerance = 1e-6;
  const double limit = stable_time_step(scene.rule, bond_length, kTolerance);
  return limit > 0 ? limit : std::numeric_limits<double>::infinity();
}

// Whether every pair force of the body is 0, to what `law` of a scene may lack of it at its pitch.
bool in_balance(const Rule& rule, const Body& body, const Periodic& periodic, double pull) {
  std::vector<Vec3> force(body.size(), Vec3::Zero());
  CellList cells(rule.cutoff(), periodic);
  cells.build(body.x);
  cells.for_each_pair(body.x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    if (r >= rule.reach(body.type[i], body.type[j])) return;
    const int type_i = body.type[i], type_j = body.type[j];
    const Vec3 f = rule.law_of(type_i, type_j).force(r) / r * rule.strength_of(type_i, type_j) * d;
    force[i] -= f;
    force[j] += f;
  });
  return std::all_of(force.begin(), force.end(), [&](const Vec3& f) { return f.norm() <= 1e-4 * pull; });
}

// Of a body some pair is as near as a bond at rest, or few are at all: those are looked for first.
ClosestPair closest_of(const Rule& rule, const std::vector<Vec3>& x, const Periodic& periodic) {
  const double bond = std::min(1.01 * bond_length(rule.law_at(0)), rule.cutoff());
  ClosestPair closest;
  for (const double range : {bond, rule.cutoff()}) {
    CellList cells(range, periodic);
    cells.build(x);
    const std::span<const uint32_t> ids = cells.order();
    NearWalk(cells, x, periodic)(range, 0, x.size(), [&](size_t slot, std::span<const uint64_t> near) {
      for (const uint64_t one : near) {
        const uint32_t i = ids[slot], j = static_cast<uint32_t>(one >> 32);
        if (j <= i) continue;
        const double r = cells.difference(x[i], x[j]).norm();
        const auto is_less = std::tuple(r, i, j) < std::tuple(closest.r, closest.i, closest.j);
        if (r > 0 && is_less) closest = {i, j, r};
      }
    });
    if (std::isfinite(closest.r)) break;
  }
  return closest;
}

bool imposed_all(const ParticleType& type) { return type.imposed[0] && type.imposed[1] && type.imposed[2]; }

std::string place_text(const Vec3& x) { return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", x[0], x[1], x[2]); }

}  // namespace

Watch::Watch(const Scene& scene, double table_error, int threads)
    : scene_(scene),
      resolution_(scene),
      table_error_(table_error),
      threads_(threads),
      type_(scene.body.type) {
  const Rule& rule = scene.rule;
  const PairLaw& law = rule.law_at(0);
  for (size_t k = 0; k < rule.laws(); ++k) {
    const PairLaw& one = rule.law_at(k);
    pull_ = std::max(pull_, strongest_pull(one));
    jump_ = std::max(jump_, std::abs(one.force(one.cutoff() * (1 - 1e-12))));
  }
  // A box that deforms works on what is in it.
  keeps_energy_ = !scene.deforms() && cuboct::keeps_energy(rule, scene.periodic);
  Rule undamped = rule;
  undamped.damping.coefficient = 0;
  only_loses_ = !scene.deforms() && cuboct::keeps_energy(undamped, scene.periodic);

  // The energy of a leapfrog run, with v of half a step later, swings by theta^2/4 of a mode's energy, theta
  // = omega dt; it starts at one end where all starts as kinetic. The mean over the modes of the packing is
  // half the largest theta^2 = 4 (dt/limit)^2: (dt/limit)^2/4 is to be expected. Twice that, and 2 % for a
  // run far below the limit.
  const double limit = limit_of(scene);
  energy_limit_ = 0.02 + 0.5 * (rule.dt / limit) * (rule.dt / limit);
  faint_ = 0.5 * static_cast<double>(type_.size()) * std::max(0.0, -law.slope(bond_length(law))) *
           std::pow(kCreep * (scene.pitch > 0 ? scene.pitch : law.cutoff()), 2);
  near_limit_ = rule.dt > 0.5 * limit;

  bool weighs = false, led = false;
  for (const ParticleType& type : rule.types) {
    const bool leads = type.pd || type.imposed != std::array<bool, 3>{};
    drives_ |= leads && !type.velocity.isZero(0);
    led |= type.pd;
    weighs |= !type.gravity.isZero(0);
  }
  if (drives_)
    for (uint32_t id = 0; id < type_.size(); ++id) {
      const ParticleType& type = rule.types[type_[id]];
      if (driven(type)) driven_.push_back(id);
    }
  const bool still =
      !drives_ && !weighs && !led && !scene.deforms() &&
      std::all_of(scene.body.v.begin(), scene.body.v.end(), [](const Vec3& v) { return v.isZero(0); });
  if (still && in_balance(rule, scene.body, scene.periodic, pull_)) rest_ = scene.body.x;
}

bool Watch::found(Failure failure) const {
  return std::any_of(findings_.begin(), findings_.end(),
                     [&](const Finding& f) { return f.failure == failure; });
}

void Watch::find(Failure failure, const Moment& moment, std::optional<uint32_t> particle, double number,
                 double limit, const std::string& what) {
  if (found(failure)) return;
  Finding finding{failure, moment.step, particle, Vec3::Zero(), number, limit, {}};
  std::string where;
  if (particle) {
    finding.place = moment.x(*particle);
    where = fmt::format("particle {} at {}: ", *particle, place_text(finding.place));
  }
  finding.text = fmt::format("step {}: {}: {}{}", moment.step, to_string(failure), where, what);
  findings_.push_back(std::move(finding));
}

Watch::Motion Watch::motion_of(const Moment& moment) const {
  const Rule& rule = scene_.rule;
  std::vector<char> imposed;  // by type: along all axes
  for (const ParticleType& type : rule.types) imposed.push_back(imposed_all(type));
  // Summed by blocks, so that no bit depends on the number of threads.
  constexpr size_t kBlock = 4096;
  const size_t count = type_.size(), blocks = (count + kBlock - 1) / kBlock;
  const auto by_block = [&](auto work) {
    for_each_range(
        blocks, 8,
        [&](size_t first, size_t last) {
          for (size_t b = first; b < last; ++b)
            for (size_t i = b * kBlock; i < std::min(count, (b + 1) * kBlock); ++i)
              work(b, static_cast<uint32_t>(i));
        },
        threads_);
  };
  struct Part {
    Vec3 sum = Vec3::Zero();
    double mass = 0, carried = 0, flipped = 0, swing = 0, most = 0, fastest = 0;
    size_t free = 0;
  };
  std::vector<Part> parts(blocks);
  by_block([&](size_t b, uint32_t id) {
    const Vec3 v = moment.v(id);
    const double relative = rule.relative_mass(type_[id]);
    if (imposed[type_[id]])
      parts[b].carried += relative * v.squaredNorm();
    else
      parts[b].sum += relative * v, parts[b].mass += relative, ++parts[b].free;
  });
  Motion motion;
  size_t free = 0;
  double mass = 0;  // of the free, over the lightest
  for (const Part& part : parts) {
    motion.mean += part.sum, motion.carried += part.carried;
    free += part.free, mass += part.mass;
  }
  if (free == 0) return motion;
  motion.mean /= mass;
  motion.carried += mass * motion.mean.squaredNorm();
  motion.carried *= 0.5 * rule.mass;
  by_block([&](size_t b, uint32_t id) {
    if (imposed[type_[id]]) return;
    const Vec3 before = moment.v(id) - motion.mean, after = moment.v_next(id) - motion.mean;
    const double turned = -before.dot(after), speed2 = before.squaredNorm();
    Part& part = parts[b];
    part.flipped += std::max(0.0, turned);
    part.swing += 0.5 * (speed2 + after.squaredNorm());
    part.most = std::max(part.most, turned);
    part.fastest = std::max(part.fastest, speed2);
  });
  double most = 0;
  for (const Part& part : parts) {
    motion.flipped += part.flipped;
    motion.swing += part.swing;
    most = std::max(most, part.most);
    motion.fastest = std::max(motion.fastest, part.fastest);
  }
  const double noise = moment.noise * moment.noise;
  if (motion.swing < noise * static_cast<double>(free)) motion.flipped = 0;
  motion.sudden = most > motion.swing / static_cast<double>(free) && most > noise;
  motion.fastest = std::sqrt(motion.fastest);
  return motion;
}

void Watch::see(const Moment& moment) {
  last_step_ = moment.step;
  const Motion motion = motion_of(moment);
  if (!first_) {
    first_ = moment.energies;
    first_carried_ = motion.carried;
  }
  see_flips(moment, motion);
  see_core(moment, motion);
  see_driven(moment);
  see_rest(moment);
  take(moment.step, resolution_.see(moment));
  see_energy(moment, motion);
}

void Watch::take(uint64_t step, std::optional<Resolution::Lack> lack) {
  if (!lack || found(Failure::resolution)) return;
  Finding finding{Failure::resolution, step, lack->particle, lack->place, lack->number, lack->limit, {}};
  const std::string where =
      lack->particle ? fmt::format("particle {} at {}: ", *lack->particle, place_text(lack->place)) : "";
  finding.text = fmt::format("step {}: {}: {}{}", step, to_string(finding.failure), where, lack->text);
  findings_.push_back(std::move(finding));
}

void Watch::conclude() {
  if (last_step_) take(*last_step_, resolution_.conclude());
}

// Where a mode is unstable, z < -1: its velocity turns over in each step. A mode at 0.2 of the limit turns
// over near the ends of its swing alone, where it has less than theta^2/4 = 4 % of its kinetic energy. Either
// way the flip is only a suspicion; what is told is proven by the quotient. Near the limit the fastest mode
// is looked for at once, and told where it turns over.
void Watch::see_flips(const Moment& moment, const Motion& motion) {
  constexpr double kShare = 0.05;
  if (motion.sudden || motion.flipped > kShare * motion.swing)
    prove_unstable(moment, motion, Suspicion::flips);
  else if (near_limit_)
    prove_unstable(moment, motion, Suspicion::near_limit);
}

bool Watch::prove_unstable(const Moment& moment, const Motion& motion, Suspicion suspicion) {
  std::vector<Vec3> x(type_.size()), y(type_.size(), Vec3::Zero());
  for (uint32_t id = 0; id < type_.size(); ++id) {
    x[id] = moment.x(id);
    if (!x[id].allFinite()) return false;
    const Vec3 before = moment.v(id) - motion.mean, after = moment.v_next(id) - motion.mean;
    // Kicks hold more of the fast modes than velocities do.
    if (suspicion != Suspicion::flips)
      y[id] = after - before;
    else if (before.dot(after) < 0)
      y[id] = after;
  }
  const Rule& rule = scene_.rule;
  const Quotient q = stability_quotient(rule, scene_.box_at(moment.step), x, type_, std::move(y));
  if (!(q.total() > 4)) return false;
  if (suspicion == Suspicion::near_limit) {
    // One per cent beyond, and a mode needs hundreds of steps to matter.
    if (q.total() < 4.04) return false;
    double before = 0, after = 0;
    for (uint32_t id = 0; id < type_.size(); ++id) {
      before += q.mode[id].dot(moment.v(id) - motion.mean);
      after += q.mode[id].dot(moment.v_next(id) - motion.mean);
    }
    if (!(before * after < 0 && std::abs(after) > std::abs(before) && std::abs(after) > moment.noise))
      return false;
  }
  const Failure failure = q.hold > std::max(q.law, q.damping) ? Failure::stiff_hold
                          : q.damping > q.law                 ? Failure::damping
                                                              : Failure::time_step;
  find(failure, moment, q.particle, q.total(), 4,
       fmt::format(
           "{}: dt^2 K + 2 dt C is {:.3g}, stable below 4 "
           "(law {:.3g}, damping {:.3g}, held by force {:.3g}); dt = {:.3g} s would be at the limit, "
           "it is {:.3g} s",
           suspicion == Suspicion::energy ? "the energy runs away" : "velocities turn over from step to step",
           q.total(), q.law, q.damping, q.hold, q.stable_dt(rule.dt), rule.dt));
  return true;
}

void Watch::see_core(const Moment& moment, const Motion& motion) {
  if (found(Failure::tunnelling)) return;
  const Rule& rule = scene_.rule;
  const ClosestPair& closest = moment.closest;
  if (!std::isfinite(closest.r)) return;
  const PairLaw& law = rule.law_of(type_[closest.i], type_[closest.j]);
  if (closest.r < law.core()) {
    find(Failure::tunnelling, moment, closest.i, closest.r, law.core(),
         fmt::format("{:.4g} m from particle {}: the law rolls off below its core, {:.4g} m", closest.r,
                     closest.j, law.core()));
    return;
  }
  // Two particles with w between them have the energy m_i m_j/(m_i + m_j) w^2/2 along their line, at most m
  // w^2/4 of the heaviest, and w is at most twice the fastest. Damping may stop them all the same.
  double barrier = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < rule.laws(); ++k)
    barrier = std::min(barrier, rule.law_at(k).energy(0) - rule.law_at(k).energy(closest.r));
  if (rule.damping.coefficient > 0 ||
      rule.heaviest() * motion.fastest * motion.fastest < least_of(rule.strength) * barrier)
    return;
  std::vector<Vec3> x(type_.size());
  for (uint32_t id = 0; id < type_.size(); ++id) x[id] = moment.x(id);
  CellList cells(rule.cutoff(), scene_.box_at(moment.step));
  cells.build(x);
  double most = 1;
  uint32_t a = 0, b = 0;
  cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    const double approach = -(moment.v(j) - moment.v(i)).dot(d) / r;
    const PairLaw& between = rule.law_of(type_[i], type_[j]);
    const double wall = (between.energy(0) - between.energy(r)) * rule.strength_of(type_[i], type_[j]);
    const double r_i = rule.relative_mass(type_[i]), r_j = rule.relative_mass(type_[j]);
    const double share = 0.5 * (rule.mass * r_i * r_j / (r_i + r_j)) * approach * approach / wall;
    if (approach > 0 && share > most) most = share, a = i, b = j;
  });
  if (most > 1)
    find(Failure::tunnelling, moment, a, most, 1,
         fmt::format("meets particle {} with {:.3g} times the energy that the law's core can stop: they can "
                     "pass through each other",
                     b, most));
}

void Watch::see_driven(const Moment& moment) {
  if (driven_.empty() || found(Failure::constraint_work)) return;
  double most = 1, force = 0, limit = 0;
  uint32_t worst = 0;
  for (const uint32_t id : driven_) {
    const std::vector<double>& strengths = scene_.rule.strength[scene_.rule.types[type_[id]].material];
    const double bears = kBonds * pull_ * *std::max_element(strengths.begin(), strengths.end());
    const double f = moment.force(id).norm();
    if (f > most * bears) most = f / bears, force = f, limit = bears, worst = id;
  }
  if (most > 1)
    find(Failure::constraint_work, moment, worst, force, limit,
         fmt::format("it is led, and the pairs press on it with {:.3g} N: {:.3g} times what {} bonds pull at "
                     "most",
                     force, most, kBonds));
}

void Watch::see_energy(const Moment& moment, const Motion& motion) {
  thermal_ = std::max(thermal_, moment.energies.kinetic - motion.carried);
  const double change = moment.energies.total() - first_->total();
  if (drives_ && first_->potential < 0) {
    const double fed = change - (motion.carried - first_carried_), held = -first_->potential;
    if (fed > held)
      find(Failure::constraint_work, moment, std::nullopt, fed, held,
           fmt::format("led particles have fed in {:.3g} J: more than the {:.3g} J that would take all bonds "
                       "apart",
                       fed, held));
  }
  if (!(keeps_energy_ || (only_loses_ && change > 0))) return;
  if (!(thermal_ > faint_)) {
    take(moment.step, resolution_.see_energy(moment, change, thermal_));
    return;
  }
  const double share = std::abs(change) / thermal_;
  if (!(share > energy_limit_) || found(Failure::force_jump) || found(Failure::heating)) return;
  // What comes of another failure is told as that.
  for (const Failure cause : {Failure::time_step, Failure::damping, Failure::stiff_hold, Failure::creep,
                              Failure::tunnelling, Failure::resolution})
    if (found(cause)) return;
  if (prove_unstable(moment, motion, Suspicion::energy)) return;
  const std::string what = fmt::format(
      "the energy is off by {:.3g} J: {:.3g} of the largest kinetic energy, "
      "{:.3g} is to be expected; ",
      change, share, energy_limit_);
  const auto of_pull = [&](double force, const char* whose) {
    return pull_ > 0 ? fmt::format(", {:.2g} of {} strongest pull", force / pull_, whose) : std::string();
  };
  if (jump_ > table_error_)
    find(
        Failure::force_jump, moment, std::nullopt, share, energy_limit_,
        what + fmt::format("the law's force jumps by {:.3g} N at its cutoff", jump_) + of_pull(jump_, "its"));
  else
    find(Failure::heating, moment, std::nullopt, share, energy_limit_,
         what + fmt::format("the table's force is off by up to {:.3g} N", table_error_) +
             of_pull(table_error_, "the law's"));
}

void Watch::see_rest(const Moment& moment) {
  if (rest_.empty() || found(Failure::creep)) return;
  const double pitch = scene_.pitch > 0 ? scene_.pitch : scene_.rule.cutoff();
  double most = 0;
  uint32_t worst = 0;
  for (uint32_t id = 0; id < rest_.size(); ++id) {
    const double moved = nearest_image(moment.x(id) - rest_[id], scene_.periodic).norm();
    if (moved > most) most = moved, worst = id;
  }
  if (most > kCreep * pitch)
    find(Failure::creep, moment, worst, most, kCreep * pitch,
         fmt::format("it has moved {:.3g} m out of a body at rest, {:.2g} of the pitch", most, most / pitch));
}

void Watch::see(const FixedRule& rule, const Lattice& lattice, const Vec3& origin, const State& state,
                const std::vector<Int3>& kicks, const Energies& energies, const ClosestPair& closest) {
  const Vec3 speed = velocity_units(rule);
  const auto real = [speed](const Int3& v) {
    return Vec3(speed[0] * static_cast<double>(v[0]), speed[1] * static_cast<double>(v[1]),
                speed[2] * static_cast<double>(v[2]));
  };
  Moment moment;
  moment.step = state.step;
  moment.x = [&](uint32_t id) { return position_of(rule, lattice, origin, state.particles[id]); };
  std::vector<Vec3> v(state.particles.size()), next(v.size());
  const auto move = [&](size_t begin, size_t end) {
    for (size_t id = begin; id < end; ++id) {
      const Particle& p = state.particles[id];
      v[id] = real(p.v);
      // In place, so that what is not used is not computed.
      next[id] = real(finish_of<FinishResult>(rule, kicks[id], p.x, p.v, p.u, p.type).v);
    }
  };
  for_each_range(v.size(), kWatchedPerThread, move, threads_);
  moment.v = [&](uint32_t id) { return v[id]; };
  moment.v_next = [&](uint32_t id) { return next[id]; };
  moment.force = [&](uint32_t id) { return force_of(rule, kicks[id]); };
  moment.u = [&](uint32_t id) -> Vec3 { return rule.dt * real(state.particles[id].u); };
  moment.fixed = &rule;
  // Four units of a position per step: below, kicks are those of rounded positions.
  moment.noise = 4 * std::ldexp(speed.maxCoeff(), rule.widths.guard);
  moment.energies = energies;
  moment.closest = closest;
  see(moment);
}

void Watch::see(uint64_t step, const Body& body, const std::vector<Vec3>& force, const Energies& energies) {
  const Rule& rule = scene_.rule;
  Moment moment;
  moment.step = step;
  moment.x = [&](uint32_t id) { return body.x[id]; };
  moment.v = [&](uint32_t id) { return body.v[id]; };
  moment.v_next = [&](uint32_t id) {
    const ParticleType& type = rule.types[body.type[id]];
    Vec3 v = body.v[id] + rule.dt * acceleration(rule, body, id, force[id]);
    for (int a = 0; a < 3; ++a)
      if (type.imposed[a]) v[a] = type.velocity[a];
    return v;
  };
  if (!body.u.empty()) moment.u = [&](uint32_t id) { return body.u[id]; };
  moment.force = [&](uint32_t id) { return force[id]; };
  moment.energies = energies;
  moment.closest = closest_of(rule, body.x, scene_.box_at(step));
  see(moment);
}

std::optional<Finding> find_far_origin(const Scene& scene) {
  double farthest = 0;
  for (const Vec3& x : scene.body.x) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  const double pitch = scene.pitch > 0 ? scene.pitch : scene.rule.cutoff();
  const auto nearest = static_cast<float>(farthest);
  const double spacing = std::nextafter(nearest, std::numeric_limits<float>::infinity()) - nearest;
  // 1e-4 of the pitch: a tenth of what counts as creep, for each of some ten bonds.
  const double limit = 1e-4 * pitch;
  if (spacing <= limit) return std::nullopt;
  Finding finding{Failure::far_origin, 0, std::nullopt, Vec3::Zero(), spacing, limit, {}};
  finding.text = fmt::format(
      "{}: float32 positions are {:.3g} m apart at {:.4g} m from the origin, more than "
      "{:.3g} m, 1e-4 of the pitch",
      to_string(finding.failure), spacing, farthest, limit);
  return finding;
}

}  // namespace cuboct
