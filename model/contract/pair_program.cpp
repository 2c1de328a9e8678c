// SPDX-License-Identifier: MIT
#include "model/contract/pair_program.h"

#include <array>
#include <functional>

namespace cuboct {
namespace {

using graph::Builder;
using graph::FixedProgram;
using graph::Interval;
using graph::Source;

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

Interval of_bits(int bits) { return {-(int64_t{1} << (bits - 1)), (int64_t{1} << (bits - 1)) - 1}; }

std::string along(const char* what, int axis) {
  return std::string(what) + "." + kAxes[static_cast<size_t>(axis)];
}

// The number of these constants, which may be there already.
int add_constants(std::vector<graph::Constants>& all, graph::Constants one) {
  for (size_t k = 0; k < all.size(); ++k)
    if (all[k].name == one.name) return static_cast<int>(k);
  all.push_back(std::move(one));
  return static_cast<int>(all.size()) - 1;
}

// What a pair of types has, for all pairs.
template <class T, class Value>
std::vector<int64_t> by_pair(const std::vector<std::vector<T>>& table, Value value) {
  std::vector<int64_t> all;
  for (const auto& row : table)
    for (const T entry : row) all.push_back(value(entry));
  return all;
}

class PairGraph {
 public:
  PairGraph(const FixedRule& rule, FixedProgram& program) : rule_(rule), program_(program) {}

  graph::Round made() {
    std::vector<int> d, apart;
    for (int a = 0; a < program_.axes; ++a) apart.push_back(difference(a));
    for (int a = 0; a < program_.axes; ++a)
      d.push_back(shaped_difference(b_, rule_, a, apart[static_cast<size_t>(a)]));
    const int r2 = b_.named(b_.dot(d, d), "r2");
    b_.counts(b_.named(b_.lt(r2, reach()), "when"));
    for (int& part : d) part = b_.within(part);
    const int s = b_.named(scaled(strength(b_.within(r2), d)), "s");
    graph::Sum force{"force", {}};
    for (int a = 0; a < program_.axes; ++a) {
      const int part =
          rule_.cubic() ? d[static_cast<size_t>(a)] : within_reach(a, apart[static_cast<size_t>(a)]);
      const int kick = b_.neg(b_.mul(s, part, rule_.kick_shift));
      force.terms.push_back(b_.named(kick, along("kick", a)));
    }
    const int when = b_.when();
    return {.name = "force", .pair = b_.take(), .when = when, .sums = {force}};
  }

 private:
  int difference(int axis) {
    return b_.named(b_.round(read_apart(b_, program_, axis), rule_.difference_shift), along("d", axis));
  }

  // Of a pair that counts the difference is the same: shaped it is below 2^D.
  int within_reach(int axis, int along) {
    const int64_t most =
        (int64_t{1} << (rule_.widths.difference_frac + kShapeFrac)) / rule_.shape_of(axis) + 1;
    return b_.clamp(along, {-most, most});
  }

  int pair_constant(const std::string& name, int frac, std::vector<int64_t> values) {
    const int constant = add_constants(program_.pair_constants, {name, std::move(values), frac});
    return read_constant(b_, program_, Source::pair_constant, constant);
  }

  int reach() {
    const int frac = 2 * rule_.widths.difference_frac;
    const auto cutoff2 = static_cast<int64_t>(rule_.cutoff2), contact2 = static_cast<int64_t>(rule_.contact2);
    if (!rule_.scaled) return b_.constant(cutoff2, frac);
    return pair_constant("reach2", frac,
                         by_pair(rule_.scale, [=](int32_t scale) { return scale < 0 ? contact2 : cutoff2; }));
  }

  int law() {
    if (rule_.law_bits == 0) return -1;
    return pair_constant("law", 0, by_pair(rule_.law, [](uint8_t law) { return int64_t{law}; }));
  }

  int strength(int r2, const std::vector<int>& d) {
    const int s = b_.lookup(b_.table(rule_.force), r2, law());
    if (!rule_.damped) return s;
    const int q = b_.named(b_.within(b_.dot(relative_velocity(), d, rule_.q_shift)), "q");
    const int c = b_.lookup(b_.table(rule_.damp), r2);
    return b_.check(b_.sub(s, b_.mul(c, q, rule_.damp_shift)), rule_.widths.strength_bits, Fault::strength);
  }

  std::vector<int> relative_velocity() {
    std::vector<int> w;
    for (int a = 0; a < program_.axes; ++a) {
      const int other = read_velocity(b_, program_, Source::other_v, a);
      const int own = read_velocity(b_, program_, Source::own_v, a);
      const int apart = b_.round(b_.sub(other, own), rule_.w_shift);
      const int checked = b_.check(apart, rule_.widths.relative_velocity_bits, Fault::relative_velocity);
      w.push_back(shaped(b_, rule_, a, checked));
      b_.named(w.back(), along("w", a));
    }
    return w;
  }

  int scaled(int s) {
    if (!rule_.scaled) return s;
    const auto size = [](int32_t scale) { return int64_t{std::abs(scale)}; };
    const int scale = pair_constant("scale", rule_.widths.scale_frac, by_pair(rule_.scale, size));
    return b_.mul(s, scale, rule_.widths.scale_frac);
  }

  const FixedRule& rule_;
  FixedProgram& program_;
  Builder b_;
};

class MotionGraph {
 public:
  MotionGraph(const FixedRule& rule, FixedProgram& program, Builder& builder)
      : rule_(rule), program_(program), b_(builder) {}

  void add_axis(int axis, int kick) {
    const auto a = static_cast<size_t>(axis);
    const int frac = rule_.widths.velocity_frac();
    const int target = constant(along("target", axis), frac, [=](auto& type) { return type.velocity[a]; });
    const int imposed = constant(along("imposed", axis), 0, [=](auto& type) { return type.imposed[a]; });
    const int gravity = constant(along("gravity", axis), frac, [=](auto& type) { return type.gravity[a]; });
    const int free = b_.negate(imposed), v = read_velocity(b_, program_, Source::own_v, axis);
    const int dv = gain(axis, kick, free, b_.sub(v, target));
    const int sum = b_.add(b_.add(v, dv), gravity);
    const int moved = b_.check(sum, rule_.widths.velocity_bits, Fault::velocity, free);
    const int next = b_.named(b_.select(imposed, target, moved), along("v", axis));
    program_.motion.v.push_back(next);
    program_.motion.drift.push_back(next);
    if (rule_.pd) program_.motion.u.push_back(displacement(axis, b_.sub(next, target)));
  }

 private:
  int constant(const std::string& name, int frac, const std::function<int64_t(const FixedType&)>& value) {
    std::vector<int64_t> values;
    for (const FixedType& type : rule_.types) values.push_back(value(type));
    const int constant = add_constants(program_.type_constants, {name, std::move(values), frac});
    return read_constant(b_, program_, Source::own_constant, constant);
  }

  // What kicks and controllers add to a velocity. The sum of an imposed axis may be of any size.
  int gain(int axis, int kick, int free, int off) {
    int dv = b_.check(kick, rule_.widths.sum_bits, Fault::sum, free);
    if (rule_.weighted)
      dv = b_.mul(dv, constant("weight", kWeightFrac, [](auto& type) { return type.weight; }), kWeightFrac);
    if (!rule_.pd) return dv;
    const int frac = rule_.widths.gain_frac;
    const int kp = constant("kp", frac, [](auto& type) { return type.pd ? type.kp : 0; });
    const int kd = constant("kd", frac, [](auto& type) { return type.pd ? type.kd : 0; });
    return b_.sub(dv, b_.dot({kp, kd}, {read_displacement(b_, program_, axis), off}, frac));
  }

  int displacement(int axis, int moved) {
    const int held = constant("held", 0, [](auto& type) { return type.pd; });
    const int next = b_.add(read_displacement(b_, program_, axis), moved);
    const int kept = b_.check(next, rule_.widths.displacement_bits, Fault::displacement, held);
    return b_.named(b_.select(held, kept, b_.constant(0)), along("u", axis));
  }

  const FixedRule& rule_;
  FixedProgram& program_;
  Builder& b_;
};

}  // namespace

int shaped(Builder& builder, const FixedRule& rule, int axis, int node) {
  if (rule.shape[static_cast<size_t>(axis)] == 1) return node;
  return builder.mul(node, builder.constant(rule.shape_of(axis), kShapeFrac), kShapeFrac);
}

int shaped_difference(Builder& builder, const FixedRule& rule, int axis, int node) {
  if (rule.cubic()) return node;
  const int64_t most = (int64_t{5} << rule.widths.difference_frac) / 4;
  return builder.clamp(shaped(builder, rule, axis, node), {-most, most});
}

void add_motion(Builder& builder, FixedProgram& program, const FixedRule& rule,
                const std::vector<int>& kicks) {
  MotionGraph motion(rule, program, builder);
  for (int a = 0; a < program.axes; ++a) motion.add_axis(a, kicks[static_cast<size_t>(a)]);
}

FixedProgram begun_program(const std::string& name, const FixedRule& rule, int capacity) {
  FixedProgram program;
  program.name = name;
  program.axes = rule.axes;
  program.types = static_cast<int>(rule.types.size());
  program.partners = 27 * capacity - 1;
  program.position_frac = rule.widths.position_frac;
  program.guard = rule.widths.guard;
  program.velocity = of_bits(rule.widths.velocity_bits);
  program.displacement = of_bits(rule.widths.displacement_bits);
  return program;
}

FixedProgram pair_program(const FixedRule& rule, int capacity) {
  FixedProgram program = begun_program("pair", rule, capacity);
  program.rounds.push_back(PairGraph(rule, program).made());
  graph::Round& round = program.rounds.back();
  Builder finish;
  std::vector<int> kicks;
  for (int a = 0; a < program.axes; ++a) kicks.push_back(read_sum(finish, program, round, 0, a));
  add_motion(finish, program, rule, kicks);
  round.finish = finish.take();
  graph::check(program);
  return program;
}

}  // namespace cuboct
