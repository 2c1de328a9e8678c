// SPDX-License-Identifier: MIT
#include "tests/rtl/block_stimuli.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>

#include "model/base/fixed_math.h"

namespace cuboct::test {
namespace {

class Draw {
 public:
  explicit Draw(uint64_t seed) : random_(seed) {}
  int64_t operator()(int64_t low, int64_t high) {
    return low + static_cast<int64_t>(random_() % static_cast<uint64_t>(high - low + 1));
  }
  bool chance(int percent) { return (*this)(0, 99) < percent; }
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  int64_t of_bits(int bits) { return (*this)(-(int64_t{1} << (bits - 1)), (int64_t{1} << (bits - 1)) - 1); }
  // Any of so many bits, often an end of the range or next to one.
  int64_t edgy(int bits) {
    const int64_t high = (int64_t{1} << (bits - 1)) - 1;
    switch ((*this)(0, 7)) {
      case 0:
        return high - (*this)(0, 1);
      case 1:
        return -high - (*this)(0, 1);
      case 2:
        return (*this)(-2, 2);
      default:
        return of_bits(bits);
    }
  }

 private:
  std::mt19937_64 random_;
};

bool negative_half(int64_t a, int shift) {
  return shift > 0 && a < 0 && (a & ((int64_t{1} << shift) - 1)) == int64_t{1} << (shift - 1);
}

// A value that round_odd(., shift) takes to `d`: often a half.
int64_t unrounded(Draw& draw, int64_t d, int shift) {
  if (shift == 0) return d;
  const int64_t half = int64_t{1} << (shift - 1);
  const int64_t low = d > 0 ? -half : -half + 1, high = d < 0 ? half : half - 1;
  const int64_t rest = draw.chance(80) ? draw(low, high) : draw.chance(50) ? low : high;
  return (d << shift) + rest;
}

uint64_t root(uint64_t a) {
  auto r = static_cast<uint64_t>(std::sqrt(static_cast<double>(a)));
  while (r * r > a) --r;
  while ((r + 1) * (r + 1) <= a) ++r;
  return r;
}

// The longest d of one axis inside the cutoff.
int64_t cutoff_of(const FixedRule& rule) { return static_cast<int64_t>(root(rule.cutoff2 - 1)); }

// Whether the cutoff is one cell edge, 2^D, so that a d may be longer than the pipe's.
bool whole(const FixedRule& rule) { return rule.cutoff2 == uint64_t{1} << (2 * rule.widths.difference_frac); }

// The first r2 of an entry.
uint64_t entry_start(const FixedTable& table, uint32_t k) {
  if (table.shape == TableShape::uniform)
    return uint64_t{k} << (2 * table.difference_frac - table.index_bits);
  const uint32_t row = k >> table.bin_bits, bin = k & ((1u << table.bin_bits) - 1);
  if (k == 0) return 0;  // all that is below the first octave too
  const int octave = table.first_octave + static_cast<int>(row);
  return (uint64_t{1} << octave) + (uint64_t{bin} << octave >> table.bin_bits);
}

// Of the pair's types.
uint32_t law_of(const FixedRule& rule, const PairStimulus& p) {
  return rule.law_bits == 0 ? 0 : rule.law[static_cast<size_t>(p.type_i)][static_cast<size_t>(p.type_j)];
}
std::string law_class(uint32_t law) { return "inside, law " + std::to_string(law); }

class PairSource {
 public:
  PairSource(const FixedRule& rule, uint64_t seed) : rule_(rule), draw_(seed) {}

  // Of |d|^2 near `target`.
  bool near_target(uint64_t target, PairStimulus& p) {
    const double r = std::sqrt(static_cast<double>(target)), z = 2 * draw_.unit() - 1;
    const double angle = 6.283185307179586 * draw_.unit(), across = std::sqrt(1 - z * z);
    const Int3 d{std::llround(r * across * std::cos(angle)), std::llround(r * across * std::sin(angle)),
                 std::llround(r * z)};
    return with_difference(d, p);
  }
  bool exactly(uint64_t target, PairStimulus& p) {
    const auto x = static_cast<uint64_t>(draw_(0, static_cast<int64_t>(root(target))));
    const auto y = static_cast<uint64_t>(draw_(0, static_cast<int64_t>(root(target - x * x))));
    const uint64_t z = root(target - x * x - y * y);
    if (x * x + y * y + z * z != target) return false;
    const auto either = [&](uint64_t a) {
      return draw_.chance(50) ? static_cast<int64_t>(a) : -static_cast<int64_t>(a);
    };
    return with_difference({either(x), either(y), either(z)}, p);
  }
  bool any(PairStimulus& p) {
    // What the planar test lets pass may lie a little beyond the cutoff.
    const int finer = std::max(0, rule_.widths.difference_frac - rule_.widths.filter_frac);
    const int64_t reach = draw_.chance(10) ? 3 : cutoff_of(rule_) + (int64_t{2} << finer);
    Int3 d{draw_(-reach, reach), draw_(-reach, reach), draw_(-reach, reach)};
    if (draw_.chance(10)) d[static_cast<size_t>(draw_(0, 2))] = 0;
    if (draw_.chance(2)) d = {};
    return with_difference(d, p);
  }
  // A little longer than the pipe's d along one axis, and short along the others: what is left of it after it
  // wraps is inside the cutoff.
  bool beyond(PairStimulus& p) {
    const int finer = std::max(0, rule_.widths.difference_frac - rule_.widths.filter_frac);
    const int64_t step = int64_t{1} << finer;
    Int3 d{draw_(-step, step), draw_(-step, step), draw_(-step, step)};
    const int64_t length = (int64_t{1} << rule_.widths.difference_frac) + draw_(1, step);
    d[static_cast<size_t>(draw_(0, 2))] = draw_.chance(50) ? length : -length;
    return with_difference(d, p);
  }
  Draw& draw() { return draw_; }

 private:
  bool with_difference(const Int3& d, PairStimulus& p) {
    const Widths& w = rule_.widths;
    const int64_t last = (int64_t{1} << w.position_frac) - 1;
    const bool close = draw_.chance(85);
    for (size_t a = 0; a < 3; ++a) {
      p.x_i[a] = draw_.chance(20) ? draw_(0, 1) * last : draw_(0, last);
      p.x_j[a] = p.x_i[a] + unrounded(draw_, d[a], rule_.difference_shift);
      p.v_i[a] = draw_.edgy(w.velocity_bits);
      p.v_j[a] = draw_.edgy(w.velocity_bits);
      if (!close) continue;
      // A relative velocity that fits, or just does not.
      const int64_t edge = int64_t{1} << (w.relative_velocity_bits - 1);
      const int64_t relative = draw_.chance(6) ? (draw_.chance(50) ? edge - draw_(0, 1) : -edge - draw_(0, 1))
                               : draw_.chance(50) ? draw_(-edge, edge - 1)
                                                  : draw_(-edge / 32, edge / 32);
      p.v_j[a] = p.v_i[a] + unrounded(draw_, relative, rule_.w_shift);
      if (!fits(p.v_j[a], w.velocity_bits)) {
        p.v_i[a] = 0;
        p.v_j[a] = unrounded(draw_, relative, rule_.w_shift);
      }
      if (!fits(p.v_j[a], w.velocity_bits)) p.v_j[a] = 0;
    }
    const int64_t cell = int64_t{1} << w.position_frac;
    for (const int64_t x : p.x_j)
      if (x < -cell || x >= 2 * cell) return false;
    if (!may_interact(rule_, p.x_i, p.x_j)) return false;
    if (rule_.damped && draw_.chance(15)) almost_too_strong(d, p);
    const auto types = static_cast<int64_t>(rule_.types.size());
    p.type_i = static_cast<int>(draw_(0, types - 1));
    p.type_j = static_cast<int>(draw_(0, types - 1));
    p.d = d;
    return true;
  }

  // A velocity along d whose friction takes s to about its limit.
  void almost_too_strong(const Int3& d, PairStimulus& p) {
    const auto r2 = static_cast<uint64_t>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (r2 == 0 || r2 >= rule_.cutoff2) return;
    const double damp = static_cast<double>(rule_.damp.at(r2));
    if (damp == 0) return;
    const Widths& w = rule_.widths;
    const double limit = std::ldexp(draw_.chance(50) ? 1.0 : -1.0, w.strength_bits - 1);
    const double friction = static_cast<double>(rule_.force.at(r2, law_of(rule_, p))) - limit;
    const double along =
        std::ldexp(friction / damp, rule_.damp_shift + rule_.q_shift) / static_cast<double>(r2);
    Int3 wanted;
    for (size_t a = 0; a < 3; ++a) {
      const double component = along * static_cast<double>(d[a]);
      if (!(std::abs(component) < std::ldexp(1.0, w.relative_velocity_bits - 1) - 2)) return;
      wanted[a] = std::llround(component) + draw_(-1, 1);
    }
    for (size_t a = 0; a < 3; ++a) {
      const int64_t difference = unrounded(draw_, wanted[a], rule_.w_shift);
      p.v_i[a] = -difference / 2;
      p.v_j[a] = p.v_i[a] + difference;
    }
  }

  const FixedRule& rule_;
  Draw draw_;
};

// Fills in what the model says, and names the classes.
std::vector<std::string> look(const FixedRule& rule, PairStimulus& p) {
  std::vector<std::string> seen;
  const auto note = [&seen](bool is, const char* name) {
    if (is) seen.emplace_back(name);
  };
  const Widths& w = rule.widths;
  p.result = pair_kick(rule, p.x_i, p.v_i, p.type_i, p.x_j, p.v_j, p.type_j);
  p.d = difference(rule, p.x_i, p.x_j);
  p.r2 = static_cast<uint64_t>(p.d[0] * p.d[0] + p.d[1] * p.d[1] + p.d[2] * p.d[2]);
  note(p.result.inside, "inside");
  note(!p.result.inside, "outside");
  note(p.r2 + 1 == rule.cutoff2, "r2 = cutoff2 - 1");
  note(p.r2 == rule.cutoff2, "r2 = cutoff2");
  const bool touch =
      rule.scaled && rule.scale[static_cast<size_t>(p.type_i)][static_cast<size_t>(p.type_j)] < 0;
  note(touch && p.r2 + 1 == rule.contact2, "r2 = contact2 - 1, touch");
  note(touch && p.r2 == rule.contact2, "r2 = contact2, touch");
  note(!touch && p.r2 >= rule.contact2 && p.result.inside, "beyond contact2, inside");
  note(p.r2 == 0, "d = 0");
  // What the planar test lets pass may be longer than the pipe's d, which wraps; such a pair is outside.
  const int bits = w.difference_frac + 1;
  bool beyond = false;
  for (int64_t& d : p.d) beyond = beyond || !fits(d, bits), d = wrap(d, bits);
  note(beyond, "d beyond its bits");
  p.r2 = static_cast<uint64_t>(p.d[0] * p.d[0] + p.d[1] * p.d[1] + p.d[2] * p.d[2]);
  note(beyond && p.r2 < rule.cutoff2, "d beyond its bits, wrapped inside");
  const int64_t last = (int64_t{1} << w.position_frac) - 1;
  bool extreme = false;
  for (size_t a = 0; a < 3; ++a)
    extreme =
        extreme || ((p.x_i[a] == 0 || p.x_i[a] == last) && std::abs(p.d[a]) >= cutoff_of(rule) * 9 / 10);
  note(extreme, "x at an end, d long");
  for (size_t a = 0; a < 3; ++a) note(negative_half(p.x_j[a] - p.x_i[a], rule.difference_shift), "half of d");
  if (!p.result.inside) return seen;

  const uint32_t law = law_of(rule, p);
  if (rule.law_bits > 0) seen.push_back(law_class(law));
  const auto table = [&](const FixedTable& t, uint32_t first, const char* curve_half, const char* rise_half) {
    const auto [bin, f] = t.address(p.r2);
    const uint32_t k = first + bin;
    int64_t slope = t.c1[k];
    if (t.degree == 2) {
      note(negative_half(int64_t{t.c2[k]} * f, t.fraction_bits), curve_half);
      slope += round_odd(int64_t{t.c2[k]} * f, t.fraction_bits);
    }
    note(negative_half(slope * f, t.fraction_bits), rise_half);
  };
  table(rule.force, law << rule.force.index_bits, "half of c2 t, force", "half of slope t, force");
  p.force = rule.force.at(p.r2, law);
  int64_t s = p.force;
  if (rule.damped) {
    table(rule.damp, 0, "half of c2 t, damping", "half of slope t, damping");
    const int64_t edge = int64_t{1} << (w.relative_velocity_bits - 1);
    int64_t wd = 0;
    for (size_t a = 0; a < 3; ++a) {
      const int64_t full = p.v_j[a] - p.v_i[a], rounded = round_odd(full, rule.w_shift);
      note(negative_half(full, rule.w_shift), "half of w");
      note(rounded == edge - 1, "w at its upper limit");
      note(rounded == -edge, "w at its lower limit");
      note(rounded == edge, "w one above");
      note(rounded == -edge - 1, "w one below");
      wd += wrap(rounded, w.relative_velocity_bits) * p.d[a];
    }
    note(negative_half(wd, rule.q_shift), "half of q");
    p.q = round_odd(wd, rule.q_shift);
    const int64_t friction = rule.damp.at(p.r2) * p.q;
    note(negative_half(friction, rule.damp_shift), "half of the friction");
    s -= round_odd(friction, rule.damp_shift);
    const int64_t strong = int64_t{1} << (w.strength_bits - 1);
    note(s == strong - 1 || s == -strong, "s at a limit");
    note(s == strong || s == -strong - 1, "s one beyond");
    note(p.result.fault == Fault::relative_velocity && !fits(s, w.strength_bits), "w and s both wrong");
    s = wrap(s, w.strength_bits);
  }
  p.damped = s;
  if (rule.scaled) {
    const int64_t product =
        s * std::abs(rule.scale[static_cast<size_t>(p.type_i)][static_cast<size_t>(p.type_j)]);
    note(negative_half(product, w.scale_frac), "half of the scaled s");
    s = round_odd(product, w.scale_frac);
  }
  p.s = s;
  for (size_t a = 0; a < 3; ++a) note(negative_half(s * p.d[a], rule.kick_shift), "half of the kick");
  note(p.result.fault == Fault::relative_velocity, "fault of w");
  note(p.result.fault == Fault::strength, "fault of s");
  note(p.result.fault == Fault::none, "inside, no fault");
  return seen;
}

// The classes that a rule can show.
std::set<std::string> pair_classes(const FixedRule& rule) {
  std::set<std::string> names{
      "inside",    "inside, no fault",       "outside",         "d = 0", "x at an end, d long",
      "half of d", "half of slope t, force", "half of the kick"};
  // At a cutoff of one cell edge, 2^D, the integers below and at cutoff2 are of the form 4^a (8b + 7), or the
  // squares of one axis alone, which the planar test stops.
  if (whole(rule))
    names.merge(std::set<std::string>{"d beyond its bits", "d beyond its bits, wrapped inside"});
  if (three_squares(rule.cutoff2 - 1)) names.insert("r2 = cutoff2 - 1");
  if (three_squares(rule.cutoff2) && !whole(rule)) names.insert("r2 = cutoff2");
  // t is not negative, so a negative product takes a negative coefficient.
  const auto bends_down = [](const FixedTable& t) {
    return std::any_of(t.c2.begin(), t.c2.end(), [](int32_t c) { return c < 0; });
  };
  if (bends_down(rule.force)) names.insert("half of c2 t, force");
  if (rule.damped) {
    names.merge(std::set<std::string>{"half of slope t, damping", "half of w", "w at its upper limit",
                                      "w at its lower limit", "w one above", "w one below", "half of q",
                                      "half of the friction", "s at a limit", "s one beyond", "fault of w",
                                      "fault of s", "w and s both wrong"});
    if (bends_down(rule.damp)) names.insert("half of c2 t, damping");
  }
  if (rule.scaled) names.insert("half of the scaled s");
  for (const auto& row : rule.law)
    for (const uint8_t law : row) names.insert(law_class(law));
  if (rule.contact2 > 0) {
    names.insert("beyond contact2, inside");
    if (three_squares(rule.contact2 - 1)) names.insert("r2 = contact2 - 1, touch");
    if (three_squares(rule.contact2)) names.insert("r2 = contact2, touch");
  }
  return names;
}

constexpr uint64_t kPerClass = 40, kOrdinary = 10000, kCandidates = 3000000;

}  // namespace

bool three_squares(uint64_t n) {
  while (n > 0 && n % 4 == 0) n /= 4;
  return n % 8 != 7;
}

PairStimuli pair_stimuli(const FixedRule& rule, uint64_t seed) {
  PairStimuli result;
  PairSource source(rule, seed);
  for (const std::string& name : pair_classes(rule)) result.count[name] = 0;
  result.force_bins.resize(rule.force.address(rule.cutoff2 - 1).index + 1);
  if (rule.damped) result.damp_bins.resize(rule.damp.address(rule.cutoff2 - 1).index + 1);
  const auto offer = [&](PairStimulus& p, bool keep) {
    const std::vector<std::string> seen = look(rule, p);
    for (const std::string& name : seen)
      keep = keep || (result.count.contains(name) && result.count[name] < kPerClass);
    if (!keep) return;
    result.list.push_back(p);
    for (const std::string& name : seen)
      if (const auto at = result.count.find(name); at != result.count.end()) ++at->second;
    if (!p.result.inside) return;
    ++result.force_bins[rule.force.address(p.r2).index];
    if (rule.damped) ++result.damp_bins[rule.damp.address(p.r2).index];
  };
  PairStimulus p;
  const auto bins = [&](const FixedTable& table, const std::vector<uint64_t>& hits) {
    for (uint32_t k = 0; k < hits.size(); ++k) {
      const uint64_t low = entry_start(table, k);
      const uint64_t end = k + 1 < hits.size() ? entry_start(table, k + 1) : rule.cutoff2;
      for (int tries = 0; tries < 10000 && hits[k] < 4; ++tries) {
        const auto target = static_cast<uint64_t>(
            source.draw()(static_cast<int64_t>(low), static_cast<int64_t>(std::min(end, rule.cutoff2)) - 1));
        if (source.near_target(target, p)) offer(p, true);
      }
      // Few entries bend down, and half a unit of c2 t takes the middle of one.
      if (table.degree == 2 && table.c2[k] < 0)
        for (int tries = 0; tries < 10000; ++tries)
          if (source.near_target(low + (end - low) / 2, p)) offer(p, false);
    }
  };
  bins(rule.force, result.force_bins);
  if (rule.damped) bins(rule.damp, result.damp_bins);
  for (uint64_t k = 0; k < kCandidates; ++k) {
    const auto which = source.draw()(0, 9);
    const bool made = which == 0
                          ? source.exactly(rule.cutoff2 - static_cast<uint64_t>(source.draw()(0, 1)), p)
                      : which == 1 ? source.near_target(rule.cutoff2, p)
                      : which == 3 && rule.contact2 > 0
                          ? source.exactly(rule.contact2 - static_cast<uint64_t>(source.draw()(0, 1)), p)
                      : which == 2 && whole(rule) ? source.beyond(p)
                                                  : source.any(p);
    if (made) offer(p, k % (kCandidates / kOrdinary) == 0);
  }
  return result;
}

namespace {

std::vector<std::string> look(const FixedRule& rule, UpdateStimulus& s) {
  std::vector<std::string> seen;
  const auto note = [&seen](bool is, const char* name) {
    if (is) seen.emplace_back(name);
  };
  const Widths& w = rule.widths;
  const FixedType& kind = rule.types[static_cast<size_t>(s.type)];
  for (size_t a = 0; a < 3; ++a) s.seen[a] = s.x[a] >> w.guard;
  s.result = finish(rule, s.sum, s.x, s.v, s.u, s.type);
  const FinishResult& r = s.result;
  std::set<Fault> faults;
  const auto at_limit = [](int64_t a, int bits) {
    return fits(a, bits) && (!fits(a + 1, bits) || !fits(a - 1, bits));
  };
  const auto beyond = [&](int64_t a, int bits) {
    return !fits(a, bits) && (fits(a - 1, bits) || fits(a + 1, bits));
  };
  for (size_t a = 0; a < 3; ++a) {
    if (kind.imposed[a]) {
      note(!fits(s.sum[a], w.sum_bits), "imposed, sum of any size");
    } else {
      note(at_limit(s.sum[a], w.sum_bits), "sum at a limit");
      note(beyond(s.sum[a], w.sum_bits), "sum one beyond");
      if (!fits(s.sum[a], w.sum_bits)) faults.insert(Fault::sum);
      const int64_t sum = wrap(s.sum[a], w.sum_bits);
      note(rule.weighted && negative_half(sum * kind.weight, kWeightFrac), "half of the weighed sum");
      int64_t v = s.v[a] + weighed(rule, kind, sum) + kind.gravity[a];
      if (kind.pd) {
        const int64_t pull = kind.kp * s.u[a] + kind.kd * (s.v[a] - kind.velocity[a]);
        note(negative_half(pull, w.gain_frac), "half of the pull");
        v -= round_odd(pull, w.gain_frac);
      }
      note(at_limit(v, w.velocity_bits), "v at a limit");
      note(beyond(v, w.velocity_bits), "v one beyond");
      if (!fits(v, w.velocity_bits)) faults.insert(Fault::velocity);
    }
    if (kind.pd) {
      const int64_t u = s.u[a] + r.v[a] - kind.velocity[a];
      note(at_limit(u, w.displacement_bits), "u at a limit");
      note(beyond(u, w.displacement_bits), "u one beyond");
      if (!fits(u, w.displacement_bits)) faults.insert(Fault::displacement);
    }
    const bool slow = std::abs(r.v[a]) < int64_t{1} << w.guard, seen_to_move = r.x[a] >> w.guard != s.seen[a];
    note(slow && r.v[a] != 0 && !seen_to_move, "slow, seen to rest");
    note(slow && r.v[a] > 0 && seen_to_move, "slow, seen to rise");
    note(slow && r.v[a] < 0 && seen_to_move, "slow, seen to fall");
    note(r.x[a] < 0, "to the node below");
    note(r.x[a] >> w.velocity_frac() == 1, "to the node above");
    note(s.x[a] == 0, "x = 0");
    note(s.x[a] == (int64_t{1} << w.velocity_frac()) - 1, "x at its end");
  }
  note(r.fault == Fault::none, "no fault");
  note(r.fault == Fault::sum, "fault of the sum");
  note(r.fault == Fault::velocity, "fault of v");
  note(r.fault == Fault::displacement, "fault of u");
  note(faults.size() > 1, "several faults");
  return seen;
}

}  // namespace

UpdateStimuli update_stimuli(const FixedRule& rule, int sum_bits, uint64_t seed) {
  const Widths& w = rule.widths;
  UpdateStimuli result;
  bool imposed = false, pd = false;
  for (const FixedType& t : rule.types) {
    pd = pd || t.pd;
    for (const bool axis : t.imposed) imposed = imposed || axis;
  }
  std::set<std::string> names{"sum at a limit",
                              "sum one beyond",
                              "v at a limit",
                              "v one beyond",
                              "to the node below",
                              "to the node above",
                              "x = 0",
                              "x at its end",
                              "no fault",
                              "fault of the sum",
                              "fault of v",
                              "several faults",
                              "slow, seen to rest",
                              "slow, seen to rise",
                              "slow, seen to fall"};
  if (imposed) names.insert("imposed, sum of any size");
  if (pd)
    names.merge(std::set<std::string>{"half of the pull", "u at a limit", "u one beyond", "fault of u"});
  if (rule.weighted) names.insert("half of the weighed sum");
  for (const std::string& name : names) result.count[name] = 0;

  Draw draw(seed);
  for (uint64_t k = 0; k < kCandidates / 3; ++k) {
    UpdateStimulus s;
    s.type = static_cast<int>(draw(0, static_cast<int64_t>(rule.types.size()) - 1));
    const FixedType& kind = rule.types[static_cast<size_t>(s.type)];
    const int64_t last = (int64_t{1} << w.velocity_frac()) - 1;
    const bool calm = draw.chance(60);  // no sum out of its width
    const int64_t step = int64_t{1} << (w.velocity_bits - 1);
    for (size_t a = 0; a < 3; ++a) {
      s.x[a] = draw.chance(20) ? draw(0, 1) * last : draw(0, last);
      s.v[a] = draw.edgy(w.velocity_bits);
      if (draw.chance(50)) s.v[a] /= 4;
      s.sum[a] =
          calm ? draw.of_bits(w.sum_bits) / draw(1, 64) : draw.edgy(draw.chance(50) ? sum_bits : w.sum_bits);
      if (!calm && draw.chance(20))
        s.sum[a] = (draw.chance(50) ? 1 : -1) * (int64_t{1} << (w.sum_bits - 1)) - draw(0, 1);
      // An odd multiple of the unit whose product with the weight is a half.
      const int odd = kWeightFrac - 1 - std::countr_zero(static_cast<uint64_t>(kind.weight));
      if (rule.weighted && odd >= 0 && draw.chance(10))
        s.sum[a] = -(2 * draw(0, 20) + 1) * (int64_t{1} << odd);
      if (kind.pd) s.u[a] = draw.edgy(w.displacement_bits);
    }
    // One axis where v, or u, meets its limit exactly, or misses it by one; or where v is less than a unit of
    // X.
    const auto a = static_cast<size_t>(draw(0, 2));
    const int64_t slow = (int64_t{1} << w.guard) - 1;
    const int64_t end = draw.chance(30)   ? draw(-slow, slow)
                        : draw.chance(50) ? step - draw(0, 1)
                                          : -step - draw(0, 1);
    if (draw.chance(30) && !kind.imposed[a]) {
      const int64_t pull =
          kind.pd ? round_odd(kind.kp * s.u[a] + kind.kd * (s.v[a] - kind.velocity[a]), w.gain_frac) : 0;
      const int64_t room = weighed(rule, kind, (int64_t{1} << (w.sum_bits - 1)) - 1);
      s.v[a] = std::clamp(end - draw(-room, room), -step, step - 1);
      const int64_t pull_now =
          kind.pd ? round_odd(kind.kp * s.u[a] + kind.kd * (s.v[a] - kind.velocity[a]), w.gain_frac) : pull;
      // The sum that comes nearest: what it misses by is less than half a unit once it is weighed.
      const auto gain = static_cast<double>(end - s.v[a] - kind.gravity[a] + pull_now);
      const int64_t sum = std::llround(std::ldexp(gain, kWeightFrac) / static_cast<double>(kind.weight));
      if (fits(sum, w.sum_bits)) s.sum[a] = sum;
    }
    if (kind.pd && draw.chance(30)) {
      const int64_t wide = int64_t{1} << (w.displacement_bits - 1);
      const int64_t limit = draw.chance(50) ? wide - draw(0, 1) : -wide - draw(0, 1);
      for (int rounds = 0; rounds < 20; ++rounds) {
        const int64_t next = limit - finish(rule, s.sum, s.x, s.v, s.u, s.type).v[a] + kind.velocity[a];
        s.u[a] = std::clamp(next, -wide, wide - 1);
      }
    }
    const std::vector<std::string> seen = look(rule, s);
    bool keep = k % (kCandidates / 3 / kOrdinary) == 0;
    for (const std::string& name : seen)
      keep = keep || (result.count.contains(name) && result.count[name] < kPerClass);
    if (!keep) continue;
    result.list.push_back(s);
    for (const std::string& name : seen)
      if (const auto at = result.count.find(name); at != result.count.end()) ++at->second;
  }
  return result;
}

std::vector<uint64_t> table_stimuli(const FixedTable& table, uint64_t seed) {
  const uint64_t end = uint64_t{1} << (2 * table.difference_frac);
  const uint32_t entries = table.address(end - 1).index + 1;
  Draw draw(seed);
  std::vector<uint64_t> list;
  for (uint32_t k = 0; k < entries; ++k) {
    const uint64_t low = entry_start(table, k),
                   high = (k + 1 < entries ? entry_start(table, k + 1) : end) - 1;
    const uint64_t middle = low + (high - low + 1) / 2;
    for (const uint64_t r2 : {low, high, middle, middle - (middle > low ? 1 : 0)}) list.push_back(r2);
    for (int more = 0; more < 12; ++more)
      list.push_back(static_cast<uint64_t>(draw(static_cast<int64_t>(low), static_cast<int64_t>(high))));
  }
  return list;
}

}  // namespace cuboct::test
