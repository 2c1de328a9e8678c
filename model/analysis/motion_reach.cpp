// SPDX-License-Identifier: MIT
#include "model/analysis/motion_reach.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "model/analysis/motion.h"
#include "model/analysis/pieces.h"
#include "model/analysis/shadow.h"
#include "model/base/quantity_text.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

constexpr size_t kMostPieces = 24;      // that are followed one by one
constexpr double kUnknownStrain = 0.1;  // at which a rule of rounds pulls most
constexpr double kMelts =
    0.2;  // v/c: an atom swings by v/(2 c) of its distance, a tenth where a crystal melts
constexpr double kAcrossWhole = 0.02, kAcross = 1, kAhead = 2.5, kBack = 0.25;  // of the speed of an impact
constexpr double kSoftest = 2.0 / 3;  // (Y/c^2) along [100] of a packing, the softest direction

// The strain at which the law pulls most.
double strongest_strain(const Scene& scene, double rest) {
  if (scene.rule.rounds != nullptr || !(rest > 0)) return kUnknownStrain;
  const PairLaw& law = scene.rule.law_at(0);
  constexpr int kSamples = 2000;
  double least = 0, at = rest;
  for (int k = 1; k <= kSamples; ++k) {
    const double r = rest + (law.cutoff() - rest) * k / kSamples;
    if (const double force = law.force(r); force < least) least = force, at = r;
  }
  return at > rest ? at / rest - 1 : kUnknownStrain;
}

void widen(Ranges& bounds, int axis, double low, double high) {
  bounds.low[axis] = std::min(bounds.low[axis], low), bounds.high[axis] = std::max(bounds.high[axis], high);
}

// Of a piece by a wall, below (side 0) or above.
struct Stop {
  const Piece* wall;
  int axis, side;
};

struct Moving {
  const Piece* piece;
  Flight flight;
  Ranges sway;  // m, beside the flight
  bool tumbles = false, breaks = false;
  std::vector<Stop> stops;
  PieceReach found;

  void because(const std::string& reason) {
    if (std::ranges::find(found.reasons, reason) == found.reasons.end()) found.reasons.push_back(reason);
  }
  Ranges until(double t) const {
    Ranges all = flight.until(t);
    return {all.low + sway.low, all.high + sway.high};
  }
};

class Motions {
 public:
  Motions(const Scene& scene, const std::vector<Piece>& pieces)
      : scene_(scene), motion_(motion_of(scene)), duration_(scene.planned_duration()) {
    spacing_ = motion_.rest_distance;
    strain_ = strongest_strain(scene, spacing_);
    for (const Piece& piece : pieces)
      all_.push_back({.piece = &piece, .flight = {}, .sway = {}, .stops = {}, .found = {}});
  }

  std::vector<PieceReach> found() {
    for (Moving& m : all_) begin(m);
    impacts();
    std::vector<PieceReach> reaches;
    for (Moving& m : all_) {
      end(m);
      reaches.push_back(std::move(m.found));
    }
    return reaches;
  }

 private:
  double wave() const { return motion_.sound_speed; }
  bool is_static() const { return scene_.loading.has_value(); }
  // Whether a speed breaks what it meets.
  bool breaks(double speed) const { return !is_static() && speed > wave() * strain_; }

  // How far velocities of this size carry parts of a piece to and fro, m.
  double swing(const Piece& piece, int axis, double speed) const {
    const double most = speed * duration_, length = piece.size().maxCoeff() + spacing_,
                 high = piece.size()[axis] + spacing_;
    return wave() > 0 ? std::min(most, 2 * speed * length * length / (wave() * high)) : most;
  }

  void begin(Moving& m) {
    const Piece& piece = *m.piece;
    m.found.name = piece.name, m.found.pieces = piece.pieces, m.found.duration = duration_;
    if (piece.pieces > 1 && !piece.driven && !is_static()) return begin_loose(m);
    Ranges v = piece.led;
    Vec3 g = Vec3::Zero();
    if (!v.zero()) m.because("the imposed velocity");
    bool moves = false;
    for (int axis = 0; axis < 3 && !is_static(); ++axis) {
      if (piece.steers(axis)) continue;
      v.low[axis] = v.high[axis] = piece.velocity[axis], g[axis] = piece.acceleration[axis];
      moves = moves || piece.velocity[axis] != 0;
    }
    m.flight = Flight(v, g);
    if (piece.fixed) return;
    if (moves) m.because("the initial velocity");
    if (!g.isZero(0)) m.because(piece.pulled ? "the force" : "gravity");
    if (piece.driven) load(m), break_led(m);
    if (is_static()) return;
    m.found.spin = piece.spin, m.found.centre = piece.centre;
    if (!piece.spin.isZero(0)) m.because("the rotation");
    inner(m);
  }

  // Many pieces that meet one another go anywhere at the speed of the fastest.
  void begin_loose(Moving& m) {
    const Piece& piece = *m.piece;
    const double fastest = piece.velocities.low.cwiseAbs().cwiseMax(piece.velocities.high.cwiseAbs()).norm();
    m.flight = Flight({Vec3::Constant(-fastest), Vec3::Constant(fastest)}, piece.acceleration);
    m.breaks = true;
    if (fastest > 0) m.because("the initial velocities");
    if (!piece.acceleration.isZero(0)) m.because(piece.pulled ? "the force" : "gravity");
  }

  // What gravity and forces do to a piece along axes along which it is held or led.
  void load(Moving& m) {
    const Piece& piece = *m.piece;
    Vec3 a = piece.acceleration;
    for (int axis = 0; axis < 3; ++axis)
      if (!piece.steers(axis)) a[axis] = 0;
    if (a.isZero(0)) return;
    m.because(piece.pulled ? "the force" : "gravity");
    const double modulus = kSoftest * wave() * wave(), length = piece.size().maxCoeff() + spacing_;
    const double falls = is_static() ? INFINITY : 0.5 * piece.most_acceleration * duration_ * duration_;
    for (int axis = 0; axis < 3; ++axis) {
      if (a[axis] == 0) continue;
      const double g = std::abs(a[axis]), h = piece.size()[axis] + spacing_;
      const Piece::Hold& hold = piece.hold[static_cast<size_t>(axis)];
      double l = 0, across = 0;
      for (int b = 0; b < 3; ++b) {
        if (b == axis) continue;
        l = std::max({l, hold.low[b] - piece.low[b], piece.high[b] - hold.high[b]});
        across = std::max(across, piece.size()[b]);
      }
      // Held at both ends: no softer than a cantilever of half the length.
      if (l < spacing_) l = across / 2;
      double rest = modulus > 0 ? g * h * h / (2 * modulus) : INFINITY, strain = g * h / modulus;
      if (l > h) {
        rest += (piece.pulled ? 4 : 1.5) * g * std::pow(l, 4) / (modulus * h * h);
        strain = std::max(strain, 3 * g * l * l / (modulus * h));
      }
      if (!is_static() && strain > strain_) {  // it tears off
        m.flight = Flight(m.flight.velocity(0), a + m.flight.acceleration());
        m.breaks = true;
        return;
      }
      const double most = std::min({(is_static() ? 1 : 2) * rest, falls, 2 * length});
      widen(m.sway, axis, a[axis] < 0 ? -most : 0, a[axis] > 0 ? most : 0);
    }
  }

  void break_led(Moving& m) {
    const Piece& piece = *m.piece;
    const Vec3 apart = piece.led.high - piece.led.low;
    const double length = piece.size().maxCoeff() + spacing_, speed = apart.norm();
    if (speed == 0) return;
    const double strain =
        std::max(wave() > 0 && !is_static() ? speed / wave() : 0, speed * duration_ / length);
    const double springs = strain_ * length;
    if (strain > strain_) m.because("a break");
    for (int axis = 0; axis < 3; ++axis) {
      const double share = std::abs(apart[axis]) / speed;
      const double most =
          strain > strain_ ? springs * std::max(share, 0.5) : std::min(strain, strain_) * length * share;
      widen(m.sway, axis, -most, most);
    }
  }

  // Velocities that are none of a rigid body.
  void inner(Moving& m) {
    const Piece& piece = *m.piece;
    Vec3 speed = piece.inner;
    for (int axis = 0; axis < 3 && !scene_.thermal; ++axis)
      if (piece.steers(axis)) speed[axis] += std::abs(piece.velocity[axis]);
    // A rotation strains by (V/c)^2, V the speed of its rim.
    const double rim = 0.5 * piece.spin.norm() * piece.size().norm();
    const bool flies = (scene_.thermal ? piece.inner_rms > kMelts * wave() : breaks(speed.norm())) ||
                       rim * rim > strain_ * wave() * wave();
    if (flies && !(speed.isZero(0) && rim == 0)) {
      m.flight.hit(0, piece.velocities);  // those of the rotation among them
      m.found.spin = Vec3::Zero();
      m.breaks = true;
      m.because("the initial velocities");
      return;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double most = scene_.thermal ? 0 : swing(piece, axis, speed[axis]);
      if (most > 0) m.because(piece.steers(axis) ? "the initial velocity" : "the initial velocities");
      widen(m.sway, axis, -most, most);
    }
  }

  // Whether the boxes of two pieces, within a cutoff, may touch by t. `gaps`: between them, by axis.
  bool may_meet(const Moving& a, const Moving& b, double t, Vec3* gaps = nullptr) const {
    const Ranges of_a = a.until(t), of_b = b.until(t);
    bool meet = true;
    for (int axis = 0; axis < 3; ++axis) {
      const double gap =
          scene_.periodic.extent[axis] > 0
              ? 0
              : std::max(b.piece->low[axis] + of_b.low[axis] - a.piece->high[axis] - of_a.high[axis],
                         a.piece->low[axis] + of_a.low[axis] - b.piece->high[axis] - of_b.high[axis]) -
                    scene_.rule.cutoff();
      if (gaps) (*gaps)[axis] = gap;
      meet = meet && gap <= 0;
    }
    return meet;
  }

  // When they may meet first, s.
  std::optional<double> meeting(const Moving& a, const Moving& b) const {
    double early = std::max(a.flight.latest_hit(), b.flight.latest_hit()), late = duration_;
    if (!may_meet(a, b, late)) return std::nullopt;
    if (may_meet(a, b, early)) return early;
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (early + late);
      (may_meet(a, b, middle) ? late : early) = middle;
    }
    return late;
  }

  // All meetings in the order of time, each pair once.
  void impacts() {
    const size_t n = all_.size();
    std::vector<char> met(n * n, 0);
    while (true) {
      double first = INFINITY;
      size_t one = 0, other = 0;
      for (size_t i = 0; i < n; ++i)
        for (size_t j = i + 1; j < n; ++j) {
          if (met[i * n + j] || (all_[i].piece->fixed && all_[j].piece->fixed)) continue;
          if (const auto t = meeting(all_[i], all_[j]); t && *t < first) first = *t, one = i, other = j;
        }
      if (std::isinf(first)) return;
      met[one * n + other] = 1;
      meet(all_[one], all_[other], first);
    }
  }

  struct Meeting {
    double t;                     // s
    int axis;                     // of the normal
    double normal;                // m/s, along it
    double speed;                 // m/s
    bool first_strikes, upwards;  // the first of the two; it is below the other
  };

  void meet(Moving& a, Moving& b, double t) {
    const Ranges of_a = a.flight.velocity(t), of_b = b.flight.velocity(t);
    Vec3 speed = (of_a.high - of_b.low).cwiseAbs().cwiseMax((of_b.high - of_a.low).cwiseAbs());
    Vec3 gaps;
    may_meet(a, b, t * (1 - 1e-6), &gaps);
    int axis = 0;
    if (gaps.maxCoeff(&axis) <= 0) speed.maxCoeff(&axis);  // their boxes overlap from the first step on
    const auto centre = [&](const Moving& m) { return 0.5 * (m.piece->low[axis] + m.piece->high[axis]); };
    const bool upwards = centre(a) < centre(b);
    if (a.piece->fixed || b.piece->fixed) stop(a.piece->fixed ? b : a, a.piece->fixed ? a : b, axis, speed);
    const auto fastest = [](const Ranges& v) { return v.low.cwiseAbs().cwiseMax(v.high.cwiseAbs()).norm(); };
    const Meeting meeting{t, axis, speed[axis], speed.norm(), fastest(of_a) >= fastest(of_b), upwards};
    if (!(meeting.speed > 0)) return;
    answer(a, b, meeting, meeting.first_strikes, !upwards);
    answer(b, a, meeting, !meeting.first_strikes, upwards);
  }

  // Where the wall is on a piece's way along the axis, wherever the piece flies across it until the end.
  std::optional<Gap> gap_on_way(const Moving& m, const Piece& wall, int axis, int side) const {
    const Ranges way = m.until(duration_);
    const auto ends = [&](int across) {
      std::vector<double> both;
      if (way.low[across] < 0) both.push_back(way.low[across]);
      if (way.high[across] > 0 || both.empty()) both.push_back(way.high[across]);
      return both;
    };
    const int p = (axis + 1) % 3, q = (axis + 2) % 3;
    Gap all{INFINITY, 0};
    for (const double of_p : ends(p))
      for (const double of_q : ends(q)) {
        Vec3 drift = Vec3::Zero();
        drift[p] = of_p, drift[q] = of_q;
        const auto gap = gap_to(scene_.body.x, m.piece->ids, wall.ids, axis, side, drift, spacing_);
        if (!gap) return std::nullopt;
        all = {std::min(all.least, gap->least), std::max(all.most, gap->most)};
      }
    return all;
  }

  // Where the wall stops the piece. What falls towards it comes the faster the further it is: sqrt(v^2 + 2 g
  // d).
  void stop(Moving& m, const Moving& wall, int axis, Vec3& speed) {
    const int side =
        m.piece->low[axis] + m.piece->high[axis] > wall.piece->low[axis] + wall.piece->high[axis] ? 0 : 1;
    const auto gap = gap_on_way(m, *wall.piece, axis, side);
    if (!gap) {
      m.tumbles = true;
      return;
    }
    const double g = (side == 0 ? -1 : 1) * m.flight.acceleration()[axis];
    speed[axis] = std::max(
        speed[axis], std::sqrt(std::pow(m.piece->velocity[axis], 2) + 2 * std::max(0.0, g) * gap->least));
    const bool whole = !m.breaks && !breaks(speed.norm());
    m.flight.stop(axis, side, whole ? gap->least : gap->most, speed[axis]);
    m.stops.push_back({wall.piece, axis, side});
    m.found.stopped_by[static_cast<size_t>(axis)][static_cast<size_t>(side)] = wall.piece->name;
  }

  // Drops the stops that a blow carries a piece past. A wall that has stopped it is on its way as it bounces.
  void keep_stops(Moving& m, const Moving& by) {
    const auto past = [&](const Stop& stop) {
      return stop.wall != by.piece && !gap_on_way(m, *stop.wall, stop.axis, stop.side);
    };
    // Each that goes may make the way wider.
    for (auto lost = std::ranges::find_if(m.stops, past); lost != m.stops.end();
         lost = std::ranges::find_if(m.stops, past)) {
      const Stop gone = *lost;
      m.stops.erase(lost);
      const auto at = [&](const Stop& stop) { return stop.axis == gone.axis && stop.side == gone.side; };
      m.tumbles = true;
      if (std::ranges::any_of(m.stops, at)) continue;
      m.flight.drop_stop(gone.axis, gone.side);
      m.found.stopped_by[static_cast<size_t>(gone.axis)][static_cast<size_t>(gone.side)].clear();
    }
  }

  // What an impact does to one of the two, which it pushes up or down along the normal.
  void answer(Moving& m, const Moving& by, const Meeting& at, bool strikes, bool up) {
    const Piece& piece = *m.piece;
    if (piece.fixed) return;
    m.because("an impact");
    const double rest = duration_ - at.t;
    Ranges v = m.flight.velocity(at.t);
    const double sign = up ? 1 : -1;
    const auto push = [&](double ahead, double back, const Vec3& across) {
      for (int a = 0; a < 3; ++a)
        if (a != at.axis)
          v.low[a] -= across[a], v.high[a] += across[a];
        else
          (up ? v.high[a] : v.low[a]) += sign * ahead, (up ? v.low[a] : v.high[a]) -= sign * back;
    };
    if (breaks(at.speed) || m.breaks) {
      if (strikes)
        push(at.speed * (1 + kBack), 0, Vec3::Constant(kAcross * at.speed));
      else
        push(kAhead * at.speed, kBack * at.speed, Vec3::Constant(kAcross * at.speed));
      m.breaks = true;
      m.flight.hit(at.t, v);
      keep_stops(m, by);
      return;
    }
    const bool heavy = by.piece->steers(at.axis);
    const double share = is_static() ? 1 : heavy ? 2 : 2 * by.piece->mass / (by.piece->mass + piece.mass);
    if (piece.steers(at.axis)) {
      // What is led goes on pushing; what is free bounces off.
      const double pushed = heavy ? at.normal * rest : 0,
                   swings =
                       heavy ? 0
                             : std::min(share * at.normal * rest, swing(piece, at.axis, share * at.normal));
      widen(m.sway, at.axis, up ? -swings : -std::max(pushed, swings),
            up ? std::max(pushed, swings) : swings);
      return;
    }
    Vec3 across = Vec3::Constant(is_static() ? 0 : kAcrossWhole * at.speed);
    for (int a = 0; a < 3; ++a)
      if (piece.steers(a)) across[a] = 0;
    push(share * at.normal, 0, across);
    m.flight.hit(at.t, v);
    keep_stops(m, by);
    if (!is_static() && off_middle(piece, at.axis, up ? 0 : 1)) m.tumbles = true;
  }

  // Whether the particles of a piece's face do not stand about its middle.
  bool off_middle(const Piece& piece, int axis, int side) const {
    Vec3 sum = Vec3::Zero();
    double count = 0;
    const double face = side == 0 ? piece.low[axis] : piece.high[axis];
    for (const uint32_t i : piece.ids)
      if (std::abs(scene_.body.x[i][axis] - face) <= spacing_) sum += scene_.body.x[i], ++count;
    Vec3 off = sum / count - piece.centre;
    // Off along an axis it turns along that and the normal.
    for (int a = 0; a < 3; ++a)
      if (a == axis || piece.steers(a)) off[a] = 0;
    return off.norm() > 0.5 * spacing_;
  }

  void end(Moving& m) {
    const Piece& piece = *m.piece;
    m.found.beyond = piece.fixed ? Ranges{} : m.until(duration_);
    int free = 0;
    for (int a = 0; a < 3; ++a) free += piece.steers(a) ? 0 : 1;
    if (!m.tumbles || free < 2) return;
    m.because("tumbling");
    const double radius = 0.5 * piece.size().norm();
    const Vec3 more = Vec3::Constant(radius) - 0.5 * piece.size();
    for (int a = 0; a < 3; ++a) {
      if (piece.steers(a)) continue;
      if (m.found.stopped_by[a][0].empty()) m.found.beyond.low[a] -= more[a];
      if (m.found.stopped_by[a][1].empty()) m.found.beyond.high[a] += more[a];
    }
  }

  const Scene& scene_;
  Motion motion_;
  double duration_;     // s
  double spacing_ = 0;  // m, between nearest neighbours
  double strain_ = 0;   // at which the law pulls most
  std::vector<Moving> all_;
};

// All but those that repeat, and those along which all particles begin at one place and nothing moves them.
std::array<bool, 3> axes_of_motion(const Scene& scene) {
  std::array<bool, 3> live{};
  const Body& body = scene.body;
  for (int a = 0; a < 3; ++a)
    for (size_t i = 0; i < body.size() && scene.periodic.extent[a] == 0 && !live[static_cast<size_t>(a)];
         ++i) {
      const ParticleType& type = scene.rule.types[body.type[i]];
      live[static_cast<size_t>(a)] = std::abs(body.x[i][a] - body.x[0][a]) > 1e-9 * scene.rule.cutoff() ||
                                     body.v[i][a] != 0 || type.gravity[a] != 0 || type.velocity[a] != 0;
    }
  return live;
}

// Lengths; plain numbers in reduced units.
std::string length_text(const Scene& scene, double metres) {
  return quantity_text(metres, scene.boltzmann == 1 ? "" : "m");
}

// "x 4 mm", "-z 48 mm to 'ground'" of an axis, none where it is less than a hundredth of an edge.
std::vector<std::string> ways_along(const Scene& scene, const PieceReach& piece, int axis, double edge) {
  const auto at = static_cast<size_t>(axis);
  const std::array<double, 2> way{-piece.beyond.low[axis], piece.beyond.high[axis]};
  const std::array<std::string, 2>& stopped = piece.stopped_by[at];
  const char name = "xyz"[at];
  if (stopped[0].empty() && stopped[1].empty() && way[0] > 0.01 * edge &&
      std::abs(way[0] - way[1]) < 0.01 * way[1])
    return {fmt::format("{} {}", name, length_text(scene, way[1]))};
  std::vector<std::string> texts;
  for (size_t side = 0; side < 2; ++side)
    if (way[side] > 0.01 * edge)
      texts.push_back(fmt::format("{}{} {}{}", "-+"[side], name, length_text(scene, way[side]),
                                  stopped[side].empty() ? "" : fmt::format(" to '{}'", stopped[side])));
  return texts;
}

}  // namespace

Ranges PieceReach::of(const Vec3& x, const ParticleType& type) const {
  Ranges bounds = beyond;
  if (const double rate = spin.norm(); rate > 0) {
    const Vec3 axis = spin / rate, from = x - centre, middle = axis * axis.dot(from);
    const double radius = (from - middle).norm(), turned = radius * rate * duration;
    for (int a = 0; a < 3; ++a) {
      // Of the circle about the axis, and of the arc's length.
      const double share = std::sqrt(std::max(0.0, 1 - axis[a] * axis[a])), to = middle[a] - from[a];
      bounds.low[a] += std::min(0.0, std::max(to - radius * share, -turned * share));
      bounds.high[a] += std::max(0.0, std::min(to + radius * share, turned * share));
    }
  }
  for (int a = 0; a < 3; ++a)
    if (!is_free(type, a)) bounds.low[a] = bounds.high[a] = 0;
  return bounds;
}

MotionReach motion_reach(const Scene& scene) {
  const std::vector<Piece> pieces = pieces_of(scene, kMostPieces);
  MotionReach reach;
  reach.pieces = Motions(scene, pieces).found();
  const std::array<bool, 3> live = axes_of_motion(scene);
  for (PieceReach& piece : reach.pieces)
    for (int a = 0; a < 3; ++a)
      if (!live[static_cast<size_t>(a)]) piece.beyond.low[a] = piece.beyond.high[a] = 0;
  reach.piece.resize(scene.body.size());
  for (size_t k = 0; k < pieces.size(); ++k)
    for (const uint32_t i : pieces[k].ids) reach.piece[i] = static_cast<uint32_t>(k);
  return reach;
}

Vec3 largest_beyond(const Scene& scene, const MotionReach& reach) {
  Vec3 most = Vec3::Zero();
  for (size_t i = 0; i < scene.body.size(); ++i) {
    const Ranges of = reach.pieces[reach.piece[i]].of(scene.body.x[i], scene.rule.types[scene.body.type[i]]);
    most = most.cwiseMax(-of.low).cwiseMax(of.high);
  }
  return most;
}

std::string reach_text(const Scene& scene, const MotionReach& reach, double edge) {
  std::string text = fmt::format("{} around each particle, a cell edge", length_text(scene, edge));
  for (const PieceReach& piece : reach.pieces) {
    std::vector<std::string> ways;
    for (int a = 0; a < 3; ++a)
      for (std::string& way : ways_along(scene, piece, a, edge)) ways.push_back(std::move(way));
    if (!piece.spin.isZero(0)) ways.emplace_back("the circle on which it turns");
    if (ways.empty()) continue;
    text += fmt::format("; {} '{}' {} more, by {}",
                        piece.pieces > 1 ? fmt::format("{} pieces of", piece.pieces) : std::string("of"),
                        piece.name, fmt::join(ways, ", "), fmt::join(piece.reasons, ", "));
  }
  return text;
}

}  // namespace cuboct
