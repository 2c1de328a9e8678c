// SPDX-License-Identifier: MIT
#include "model/analysis/probe_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/analysis/bond_error.h"
#include "model/analysis/clusters.h"
#include "model/analysis/expected_strain.h"
#include "model/analysis/motion.h"
#include "model/analysis/synopsis.h"
#include "model/analysis/tension.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

// Beyond so many particles no bonds are followed: what is free is then taken to hang on what is held.
constexpr size_t kMostFollowed = 1'000'000;
constexpr double kConcentration = 3;  // of strains at a round hole (G. Kirsch, 1898)
constexpr double kSlender = 3;        // longest side over the one across

bool imposed_alone(const ParticleType& type) { return !type.pd && driven(type); }

Vec3 in_doubles(const Int3& fixed) {
  return {static_cast<double>(fixed[0]), static_cast<double>(fixed[1]), static_cast<double>(fixed[2])};
}

// The parts of a scene that bonds join.
struct Parts {
  std::vector<uint32_t> root;  // by particle: one of its part
  std::vector<char> hangs;     // by root: on a particle that is held, led or steered
  bool hanging(uint32_t id) const { return hangs[root[id]] != 0; }
};

Parts parts_of(const Scene& scene) {
  const Body& body = scene.body;
  Parts parts{std::vector<uint32_t>(body.size()), std::vector<char>(body.size(), 0)};
  Clusters joined(body.size());
  const double range = bond_range(scene);
  const bool followed = body.size() <= kMostFollowed && range > 0;
  if (followed) {
    CellList cells(range, scene.periodic);
    cells.build(body.x);
    cells.for_each_pair(body.x, [&](uint32_t i, uint32_t j, const Vec3&, double) {
      if (!scene.rule.only_touch(body.type[i], body.type[j])) joined.join(i, j);
    });
  }
  for (uint32_t i = 0; i < body.size(); ++i) {
    if (followed) parts.root[i] = joined.find(i);
    if (driven(scene.rule.types[body.type[i]])) parts.hangs[parts.root[i]] = 1;
  }
  return parts;
}

// Whether initial velocities lie across the longest side of a body that is one, and so bend it.
bool swings(const Scene& scene, const Parts& parts, const Vec3& size) {
  if (std::ranges::any_of(parts.root, [&](uint32_t root) { return root != parts.root.front(); }))
    return false;
  int along = 0, across = 0;
  const double longest = size.maxCoeff(&along);
  Vec3 square = Vec3::Zero();
  for (uint32_t id = 0; id < scene.body.size(); ++id)
    if (!driven(scene.rule.types[scene.body.type[id]])) square += scene.body.v[id].cwiseAbs2();
  square.maxCoeff(&across);
  return across != along && longest > kSlender * size[across] && square[along] < 0.1 * square[across];
}

}  // namespace

// What no format changes.
struct ProbeErrors::Facts {
  explicit Facts(const Scene& scene) : motion(motion_of(scene)), parts(parts_of(scene)) {
    const Vec3 size = body_size(scene);
    length = std::max(size.maxCoeff(), motion.rest_distance);
    sections = std::max(1.0, static_cast<double>(scene.body.size()) * motion.rest_distance / length);
    initial = motion.cause == StrainCause::initial || motion.cause == StrainCause::rotation;
    bends = motion.cause == StrainCause::bending ||
            (motion.cause == StrainCause::initial && swings(scene, parts, size));
  }

  Motion motion;
  Parts parts;
  double length = 0, sections = 1;
  bool initial = false, bends = false;
};

class ProbeErrors::Estimate {
 public:
  Estimate(const Scene& scene, const Facts& facts, const FixedRule& fixed)
      : scene_(scene),
        fixed_(fixed),
        motion_(facts.motion),
        bond_(bond_error(scene, fixed, motion_)),
        length_(facts.length),
        sections_(facts.sections),
        parts_(facts.parts) {
    const auto count = static_cast<double>(scene.body.size());
    time_ = scene.planned_duration();
    // Of a ramp the root mean square is 1/sqrt(3) of its end, of a vibration 1/sqrt(2) of its largest.
    const double of_curve = std::sqrt(facts.initial ? 2 : 3);
    // A part steps between its two signs as the strain passes units: twice its size. A wave of that stress is
    // doubled where the body is held. Across a body that bends, strains differ, and units are passed at
    // different times.
    force_ = facts.bends ? 2 * of_curve * bond_.together(sections_, count) : 4 * of_curve * bond_.together();
    breaks_ = bond_.peak_strain > 0 && kConcentration * bond_.strain >= bond_.peak_strain;
    for (size_t t = 0; t < fixed.types.size(); ++t) add_type(t);
  }

  ProbeError of(const Probe& probe) const {
    ProbeError error{probe.name, {}, {}, breaks_};
    if (scene_.steps == 0) return refused(std::move(error), "the run has no steps");
    if (probe.kind == Probe::Kind::crack) return crack(std::move(error));
    if (probe.kind == Probe::Kind::stress)
      return refused(std::move(error), "by the law in doubles at the places of the run");
    if (scene_.thermal) return thermal(probe, std::move(error));
    const ParticleSet& set = probe.kind == Probe::Kind::stress_strain ? probe.grip : probe.set;
    if (set.ids.empty()) return refused(std::move(error), "its region has no particles");
    switch (probe.kind) {
      case Probe::Kind::stress_strain:
        return tension(probe, std::move(error));
      case Probe::Kind::force:
        return of_force(std::move(error));
      case Probe::Kind::displacement:
        return moved(set, "displacement", 1, std::move(error));
      case Probe::Kind::velocity:
        return moved(set, "velocity", 1, std::move(error));
      case Probe::Kind::kinetic_energy:
        return moved(set, "kinetic energy", 2, std::move(error));
      case Probe::Kind::temperature:
        return moved(set, "temperature", 2, std::move(error));
      default:
        return refused(std::move(error), "a field of a rule of text");
    }
  }

 private:
  void add_type(size_t t) {
    const ParticleType& type = scene_.rule.types[t];
    const FixedType& fixed = fixed_.types[t];
    const double dt = scene_.rule.dt;
    Vec3 unit;
    for (int a = 0; a < 3; ++a) unit[a] = std::ldexp(fixed_.edges()[a], -fixed_.widths.velocity_frac()) / dt;
    const auto off = [](const Vec3& kept, const Vec3& asked) {
      return asked.isZero(0) ? 0 : (kept - asked).norm() / asked.norm();
    };
    led_.push_back(driven(type) ? off(in_doubles(fixed.velocity).cwiseProduct(unit), type.velocity) : 0);
    leading_ = std::max(leading_, led_.back());
    loads_ = std::max(loads_, off(in_doubles(fixed.gravity).cwiseProduct(unit) / dt, type.gravity));
  }

  static ProbeError refused(ProbeError error, const std::string& why) {
    error.until_breaks = false;
    error.why = why;
    return error;
  }

  bool has_strain() const { return bond_.strain > 0; }
  double loaded() const { return leading_ + loads_; }

  std::string part() const {
    if (loaded() > force_)
      return leading_ > loads_ ? "the imposed velocity" : "gravity, or a force on particles";
    return fmt::format("{} at {:.2g} % strain", bond_.largest(), 100 * bond_.strain);
  }

  static ProbeError unknown(ProbeError error) {
    return refused(std::move(error), "nothing tells the scene's strain: run.expected_strain does");
  }

  ProbeError of_force(ProbeError error) const {
    if (!has_strain()) return unknown(std::move(error));
    error.curves = {{"force", force_ + loaded()}};
    error.why = part();
    return error;
  }

  bool all(const ParticleSet& set, auto is) const {
    return std::ranges::all_of(set.ids,
                               [&](uint32_t id) { return is(scene_.rule.types[scene_.body.type[id]]); });
  }

  // Grips that are led fix the length between them: a part of it is off by what the rest takes. No held end
  // doubles its waves.
  ProbeError tension(const Probe& probe, ProbeError error) const {
    if (!has_strain()) return unknown(std::move(error));
    const auto mean = [&](const ParticleSet& set) {
      double sum = 0;
      for (const uint32_t id : set.ids) sum += scene_.body.x[id].dot(probe.axis);
      return sum / static_cast<double>(set.ids.size());
    };
    double share = 1;
    if (all(probe.grip, imposed_alone) && !probe.lower.ids.empty() && !probe.upper.ids.empty()) {
      const double gauge = mean(probe.upper) - mean(probe.lower), between = pulled_length(scene_, probe);
      share = std::clamp(1 - gauge / between, std::min(1.0, motion_.rest_distance / between), 1.0) / 2;
    }
    error.curves = {{"stress", force_ + loaded()}, {"strain", share * force_ + loaded()}};
    error.why = part();
    return error;
  }

  // Displacement, velocity, or what goes as the square of it.
  ProbeError moved(const ParticleSet& set, const std::string& quantity, double power,
                   ProbeError error) const {
    const auto add = [&](double off, const std::string& why) {
      error.curves = {{quantity, power * off}};
      error.why = why;
      return error;
    };
    if (all(set, imposed_alone)) {
      double off = 0;
      bool moves = false;
      for (const uint32_t id : set.ids) {
        const uint8_t type = scene_.body.type[id];
        off = std::max(off, led_[type]);
        moves = moves || !scene_.rule.types[type].velocity.isZero(0);
      }
      error.until_breaks = false;
      return moves ? add(off, "the imposed velocity") : refused(std::move(error), "its particles are held");
    }
    if (parts_.hanging(set.ids.front())) {
      if (!has_strain()) return unknown(std::move(error));
      // Between led ends a displacement is off by half at most of what a free end is.
      const bool between = quantity == "displacement" && motion_.cause == StrainCause::imposed &&
                           std::ranges::none_of(scene_.rule.types, &ParticleType::pd);
      return add((between ? 0.5 : 1) * force_ + loaded(), part());
    }
    return floating(set, quantity, power, std::move(error));
  }

  // What nothing holds flies, and meets others: of a blow it is off by what the mean over its section is.
  ProbeError floating(const ParticleSet& set, const std::string& quantity, double power,
                      ProbeError error) const {
    const Body& body = scene_.body;
    const uint32_t root = parts_.root[set.ids.front()];
    const bool turns = motion_.cause == StrainCause::rotation;
    Vec3 v = Vec3::Zero(), weight = Vec3::Zero();
    double count = 0;
    bool others = false;
    const auto take = [&](uint32_t id) {
      v += body.v[id], ++count;
      weight += scene_.rule.types[body.type[id]].gravity;
    };
    for (uint32_t id = 0; id < body.size(); ++id) {
      others = others || parts_.root[id] != root;
      if (!turns && parts_.root[id] == root) take(id);
    }
    for (const uint32_t id : set.ids)
      if (turns) take(id);
    const bool far = quantity == "displacement";
    const double start = v.norm() / count, fall = weight.norm() / count * time_ / (far ? 2 : 1),
                 speed = start + fall;
    const double strained = bond_.strain * (far ? length_ / time_ : motion_.sound_speed);
    // It vibrates where it is.
    if (strained >= speed) {
      if (!has_strain()) return unknown(std::move(error));
      error.curves = {{quantity, power * (force_ + loaded())}};
      error.why = part();
      return error;
    }
    const double unit = std::ldexp(fixed_.cell_edge, -fixed_.widths.velocity_frac() - 1) / scene_.rule.dt;
    // Alone, a body strains about a motion that is exact, unless its particles begin to move against others.
    double blow = motion_.cause == StrainCause::initial ? force_ : force_ * strained / speed;
    if (others) {
      // Of two alike that meet each is strained by half of what their speed makes.
      const double half = motion_.sound_speed > 0 ? start / (2 * motion_.sound_speed) : 0,
                   met = std::max(bond_.strain, half);
      error.until_breaks = bond_.peak_strain > 0 && kConcentration * met >= bond_.peak_strain;
      blow = error.until_breaks ? force_ : force_ / std::sqrt(sections_);
    }
    const double flight = (unit + loads_ * fall) / speed;
    error.curves = {{quantity, power * (blow + flight)}};
    error.why = flight > blow || !has_strain() ? "the rounding of velocities" : part();
    return error;
  }

  // Single trajectories part; the energy that bonds and motion exchange differs then. Of a crystal in the
  // harmonic limit the mean square of T's fluctuation is T^2/g of g degrees of freedom at constant energy
  // (J. L. Lebowitz, J. K. Percus and L. Verlet, Phys. Rev. 153 (1967) 250, with a heat capacity of 3 k_B per
  // particle); of a gas it is less.
  ProbeError thermal(const Probe& probe, ProbeError error) const {
    error.until_breaks = false;
    const bool energy = probe.kind == Probe::Kind::kinetic_energy;
    if (probe.kind != Probe::Kind::temperature && !energy)
      return refused(std::move(error), "particles move at random: only means over many runs compare");
    const double swing = 1 / std::sqrt(3 * static_cast<double>(std::max<size_t>(1, probe.set.ids.size())));
    double speed = 0;
    for (const uint32_t id : probe.set.ids) speed += scene_.body.v[id].squaredNorm();
    speed = std::sqrt(speed / static_cast<double>(std::max<size_t>(1, probe.set.ids.size())));
    if (!(speed > 0) || !(motion_.rest_distance > 0))
      return refused(std::move(error), "its particles begin at rest");
    const double period = 2 * M_PI * motion_.rest_distance / std::max(motion_.sound_speed, speed);
    const double times = std::max(1.0, time_ / period);
    // In a crystal phases of vibrations drift apart by a part in each period; in a fluid they are lost.
    const double parted = has_strain() ? std::min(1.0, force_ * times) : 1;
    const std::string name = energy ? "kinetic energy" : "temperature";
    error.curves = {{name, swing * parted}, {name, swing * parted / std::sqrt(times), {}, true}};
    error.why =
        fmt::format("single trajectories part: {} particles, {:.2g} vibrations", probe.set.ids.size(), times);
    return error;
  }

  // A bond that breaks a reading sooner or later.
  ProbeError crack(ProbeError error) const {
    error.curves = {{"length", motion_.rest_distance, "m"}};
    error.why = "a crack goes on by a spacing at a time";
    return error;
  }

  const Scene& scene_;
  const FixedRule& fixed_;
  const Motion& motion_;
  BondError bond_;
  double length_, sections_, time_ = 0;
  double force_ = 0;                // of forces and what they make, over the size at the expected strain
  double leading_ = 0, loads_ = 0;  // worst of velocities that are imposed, of gravity and forces
  std::vector<double> led_;         // by type
  bool breaks_ = false;
  const Parts& parts_;
};

ProbeErrors::ProbeErrors(const Scene& scene)
    : scene_(scene), facts_(scene.probes.empty() ? nullptr : std::make_unique<Facts>(scene)) {}
ProbeErrors::~ProbeErrors() = default;

std::vector<ProbeError> ProbeErrors::of(const FixedRule& rule) const {
  std::vector<ProbeError> errors;
  if (facts_ == nullptr) return errors;
  const Estimate estimate(scene_, *facts_, rule);
  for (const Probe& probe : scene_.probes) errors.push_back(estimate.of(probe));
  return errors;
}

std::vector<ProbeError> probe_errors(const Scene& scene, const FixedRule& rule) {
  return ProbeErrors(scene).of(rule);
}

}  // namespace cuboct
