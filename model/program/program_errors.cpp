// SPDX-License-Identifier: MIT
#include "model/program/program_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "model/graph/noise.h"
#include "model/program/cubic_table.h"
#include "model/program/program_rule.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

// Roundings of an operation, in halves of an ulp. A quotient is a product with a reciprocal, which of a root
// is CUDA's rsqrt, of 2 ulps; a root is its argument times that. Functions have at most the ulps of CUDA's
// programming guide: exp 2, log 1, sin and cos 2, pow 4, erfc 5.
constexpr double kQuotient = 6, kRoot = 6, kFunction = 5, kPower = 9, kErrorFunction = 11;
// Of a table: the steps to its argument, and Horner's scheme over four powers.
constexpr double kArgument = 4, kHorner = 16;
// Equal bonds are of one kind, whose numbers are those of one of them: up to this part of the largest.
constexpr double kGrain = 1e-12;

double largest(const std::vector<Vec3>& of) {
  double most = 0;
  for (const Vec3& v : of) most = std::max(most, v.cwiseAbs().maxCoeff());
  return most;
}

// Of a number as a literal: its leading 24 bits, whatever its size.
double lost_by_float(double value) {
  if (value == 0 || !std::isfinite(value)) return 0;
  const double leading = std::ldexp(value, -std::ilogb(value));
  return std::ldexp(std::abs(leading - static_cast<float>(leading)), std::ilogb(value));
}

}  // namespace

ProgramErrors::ProgramErrors(const Rule& rule, const Body& body, const Periodic& periodic, bool floats)
    : rule_(rule),
      program_(*rule.rounds->text()),
      floats_(floats),
      u_(std::ldexp(1.0, floats ? -24 : -53)),
      both_(u_ + std::ldexp(1.0, -53)),
      least_(floats ? std::numeric_limits<float>::denorm_min() : 0),
      type_(body.type),
      packed_at_(body.bonds ? body.bonds->packed : body.x),
      off_(body.size()),
      fast_(body.size()),
      away_(body.size()),
      force_(body.size()),
      size_(body.size()) {
  const bool bonded = program_.declaration.bonds == BondRange::reference;
  // A position's unit is less than the rounding of the reference's coordinate, a double. Places of 32 bits
  // have units of 2^-28 of a reach.
  const double extent = largest(body.x) + periodic.extent.maxCoeff() + 16 * program_.reach;
  extent_ = extent;
  unit_ = std::ldexp(extent, -53);
  for (size_t i = 0; i < body.v.size(); ++i) fast_[i] = u_ * body.v[i].norm();
  for (size_t i = 0; i < body.u.size(); ++i) away_[i] = u_ * body.u[i].norm();
  places_ = 4 * unit_ + (floats && !bonded ? std::ldexp(program_.reach, -28) : 0);
  const ProgramStart start = starts_of(program_, rule, body, periodic);
  bonds_ = start.rows;
  if (bonded)
    grain_ = kGrain;
  else
    near_.emplace(program_.reach, periodic);
  const auto exact = [](const std::vector<std::vector<double>>& from, std::vector<Numbers>& to, double part) {
    for (const std::vector<double>& values : from) {
      double most = 0;
      for (const double value : values) most = std::max(most, std::abs(value));
      Numbers& numbers = to.emplace_back();
      for (const double value : values) numbers.push_back({value, part * most});
    }
  };
  exact(start.particle, fields_, u_);
  exact(start.bond, bond_, u_ + grain_);
  // Truths are exact.
  for (const ProgramField& field : program_.bond)
    if (field.kind == Value::Kind::truth)
      for (Number& number : bond_[field.first]) number.error = 0;
  std::fill(off_.begin(), off_.end(), 2 * unit_);
}

void ProgramErrors::place(uint32_t number, const std::vector<double>& values) {
  for (size_t i = 0; i < values.size(); ++i) fields_[number][i] = {values[i], 0};
}

ProgramErrors::Number ProgramErrors::input(const RealInput& input, const Pair& pair,
                                           const Numbers& sums) const {
  const auto rounded = [&](double value) { return Number{value, u_ * std::abs(value)}; };
  const auto axis = static_cast<int>(input.index);
  const auto particle = [&](uint32_t i) -> Number {
    switch (input.source) {
      case RealSource::own_velocity:
      case RealSource::other_velocity:
        return {v_[i][axis], fast_[i]};
      case RealSource::own_mass:
      case RealSource::other_mass:
        return rounded(rule_.mass_of(type_[i]));
      case RealSource::own_element:
      case RealSource::other_element:
        return {program_.element.empty() ? 1 : program_.element[type_[i]], 0};
      default:
        return fields_[input.index][i];
    }
  };
  switch (input.source) {
    case RealSource::difference:
      return {pair.d[axis], off_[pair.i] + off_[pair.j] + places_ + 4 * u_ * std::abs(pair.d[axis])};
    case RealSource::packed: {
      const double d = bonds_.vector[pair.bond][axis];
      return {d, grain_ * program_.reach + u_ * std::abs(d)};
    }
    case RealSource::other_velocity:
    case RealSource::other_mass:
    case RealSource::other_element:
    case RealSource::other_field:
      return particle(pair.j);
    case RealSource::bond_field:
      return bond_[input.index][pair.bond];
    case RealSource::position:
      // The device has it from where its space begins.
      return {x_[pair.i][axis], off_[pair.i] + 4 * u_ * (std::abs(x_[pair.i][axis]) + extent_)};
    case RealSource::sum:
      return sums[input.index];
    case RealSource::time_step:
      return rounded(rule_.dt);
    case RealSource::made:
      return {makes_ ? 1.0 : 0.0, 0};
    case RealSource::noise: {
      const int64_t drawn = graph::noise_of(input.index, pair.i, pair.j, time_, graph::kNoiseBits);
      const double value = static_cast<double>(2 * drawn + 1) * graph::kNoiseUnit;
      return {value, 3 * u_ * std::abs(value)};
    }
    default:
      return particle(pair.i);
  }
}

ProgramErrors::Number ProgramErrors::curve(const RealNode& node, const Number& at) const {
  const bool slope = node.op == RealOp::curve_slope;
  const auto f = [&](double x) { return slope ? node.table->slope(x) : node.table->at(x); };
  const double value = f(at.value), d = at.error + kArgument * both_ * std::abs(at.value);
  double size = std::abs(value);
  if (const auto* cubics = dynamic_cast<const CubicTable*>(node.table)) {
    const double steps = std::clamp(at.value / cubics->step(), 0.0, static_cast<double>(cubics->bins() - 1));
    const double* c = cubics->cubic(static_cast<size_t>(steps));
    size = slope ? (std::abs(c[1]) + 2 * std::abs(c[2]) + 3 * std::abs(c[3])) / cubics->step()
                 : std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]) + std::abs(c[3]);
  } else {
    const auto [low, high] = node.table->range(slope);
    size = std::max(std::abs(low), std::abs(high));
  }
  const double turn = std::max(std::abs(f(at.value - d) - value), std::abs(f(at.value + d) - value));
  return {value, 2 * turn + kHorner * both_ * size};
}

ProgramErrors::Number ProgramErrors::result(const RealNode& node, const Numbers& values) const {
  const auto of = [&](size_t k) -> const Number& { return values[node.of[k]]; };
  if (is_curve(node.op)) return curve(node, of(0));
  const Number a = of(0), b = arity(node.op) > 1 ? of(1) : Number(),
               c = arity(node.op) > 2 ? of(2) : Number();
  const double r = applied(node.op, a.value, b.value, c.value);
  const auto told = [&](double by_inputs, double roundings) {
    return Number{r, by_inputs + roundings * both_ * std::abs(r)};
  };
  // Whether errors could turn a comparison.
  const auto near = [&] { return a.error + b.error > 0 && std::abs(a.value - b.value) <= a.error + b.error; };
  const auto truth = [&](bool uncertain) { return Number{r, uncertain ? 1.0 : 0.0}; };
  switch (node.op) {
    case RealOp::add:
    case RealOp::subtract:
      return told(a.error + b.error, 1);
    case RealOp::multiply:
      return told(std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error, 1);
    case RealOp::divide:
      return told((a.error + std::abs(r) * b.error) / std::max(std::abs(b.value) - b.error, 0.0), kQuotient);
    case RealOp::square_root:
      return told(a.value > 2 * a.error ? a.error / (2 * std::sqrt(a.value - a.error))
                                        : std::sqrt(std::max(a.value, 0.0) + a.error),
                  kRoot);
    case RealOp::exponential:
      return told(r * std::expm1(a.error) + least_, kFunction);
    case RealOp::logarithm:
      return told(a.error / std::max(a.value - a.error, 0.0), kFunction);
    case RealOp::sine:
    case RealOp::cosine:
      return {r, a.error + kFunction * both_};
    case RealOp::error_function: {
      const double least = std::max(std::abs(a.value) - a.error, 0.0);
      return told(2 * std::numbers::inv_sqrtpi * std::exp(-least * least) * a.error + least_, kErrorFunction);
    }
    case RealOp::power: {
      // Between both ends of its argument; an exponent is a constant.
      const double low = std::max(a.value - a.error, 0.0), high = a.value + a.error;
      const double by_base =
          std::max(std::abs(std::pow(low, b.value) - r), std::abs(std::pow(high, b.value) - r));
      const double by_exponent = r != 0 ? std::abs(r * std::log(a.value)) * b.error : 0;
      return told(by_base + by_exponent, kPower);
    }
    case RealOp::negate:
    case RealOp::absolute:
      return told(a.error, 0);
    case RealOp::least:
    case RealOp::most:
      return told(std::max(a.error, b.error), 0);
    case RealOp::below:
    case RealOp::at_most:
    case RealOp::equal:
      return truth(near());
    case RealOp::both:
      return truth((a.error > 0 && (b.value != 0 || b.error > 0)) || (b.error > 0 && a.value != 0));
    case RealOp::either:
      return truth((a.error > 0 && (b.value == 0 || b.error > 0)) || (b.error > 0 && a.value == 0));
    case RealOp::inverse:
      return truth(a.error > 0);
    case RealOp::select: {
      if (a.error == 0) return {r, a.value != 0 ? b.error : c.error};
      return {r, std::abs(b.value - c.value) + std::max(b.error, c.error)};
    }
    default:
      return {r, 0};
  }
}

void ProgramErrors::run(const RealGraph& graph, Numbers& values, const Pair& pair,
                        const Numbers& sums) const {
  values.resize(graph.nodes().size());
  for (NodeId id = 0; id < values.size(); ++id) {
    const RealNode& node = graph.at(id);
    values[id] = node.op == RealOp::constant ? Number{node.value, floats_ ? lost_by_float(node.value) : 0}
                 : node.op == RealOp::input  ? input(node.input, pair, sums)
                                             : result(node, values);
  }
}

void ProgramErrors::meet(const ProgramRound& round, const Pair& pair, Numbers& values, Numbers& sums,
                         Numbers& sizes) {
  run(round.pair, values, pair, sums);
  for (const ProgramWrite& write : round.bonds) bond_next_[write.number][pair.bond] = values[write.node];
  for (size_t n = 0; n < round.terms.size(); ++n) {
    const Number term = values[round.terms[n]], when = values[round.when[n]];
    const bool certain = pair.certain && when.error == 0;
    if (certain && when.value == 0) continue;
    if (when.value != 0) sums[n].value += term.value;
    sums[n].error += term.error + (certain ? 0 : std::abs(term.value));
    sizes[n].value += std::abs(term.value), sizes[n].error += 1;
  }
}

ProgramErrors::Pair ProgramErrors::near_pair(uint32_t i, uint32_t j) const {
  const Vec3 d = near_->difference(x_[i], x_[j]);
  const double apart = std::abs(d.norm() - near_->reach());
  const double off = 2 * (off_[i] + off_[j] + places_ + 4 * both_ * program_.reach);
  return {i, j, 0, d, apart > off};
}

void ProgramErrors::round(const ProgramRound& round) {
  std::vector<Numbers> made(round.made.size(), Numbers(type_.size()));
  bond_next_ = bond_;
  Numbers values, finished;
  for (uint32_t i = 0; i < type_.size(); ++i) {
    Numbers sums(round.terms.size()), sizes(round.terms.size());
    if (near_) {
      for (const uint32_t j : near_->row(i)) {
        const Pair pair = near_pair(i, j);
        if (pair.d.norm() < near_->reach() || !pair.certain) meet(round, pair, values, sums, sizes);
      }
    } else {
      for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b) {
        const uint32_t j = bonds_.other[b];
        const Vec3 d = bonds_.vector[b] + ((x_[j] - packed_at_[j]) - (x_[i] - packed_at_[i]));
        meet(round, {i, j, b, d, true}, values, sums, sizes);
      }
    }
    for (size_t n = 0; n < sums.size(); ++n) sums[n].error += sizes[n].error * both_ * sizes[n].value;
    run(round.finish, finished, {i, i, 0, Vec3::Zero(), true}, sums);
    for (size_t n = 0; n < made.size(); ++n) made[n][i] = finished[round.made[n].node];
  }
  for (size_t n = 0; n < made.size(); ++n) fields_[round.made[n].number].swap(made[n]);
  bond_.swap(bond_next_);
}

void ProgramErrors::look(const std::vector<Vec3>& x, const std::vector<Vec3>& v, uint64_t step, bool makes) {
  x_ = x, v_ = v, makes_ = makes;
  time_ = static_cast<int64_t>(program_.first_step + step);
  if (near_) near_->update(x_);
  const std::vector<Numbers> fields = fields_, bonds = bond_;
  for (const ProgramRound& of : program_.rounds) round(of);
  shown_ = fields_;
  for (size_t i = 0; i < force_.size() && !program_.still; ++i) {
    double error = 0, size = 0;
    for (uint32_t a = 0; a < 3; ++a) {
      const Number& number = fields_[program_.force + a][i];
      error += number.error * number.error, size += number.value * number.value;
    }
    force_[i] = std::sqrt(error), size_[i] = std::sqrt(size);
  }
  for (const ProgramField& field : program_.particle)
    for (uint32_t k = 0; field.kept && k < field.numbers(); ++k)
      if (!makes) shown_[field.first + k] = fields[field.first + k];
  if (makes) return;
  fields_ = fields, bond_ = bonds;
}

void ProgramErrors::step(const std::vector<Vec3>& x, const std::vector<Vec3>& v, uint64_t step) {
  look(x, v, step, true);
  if (program_.still) return;
  for (size_t i = 0; i < off_.size(); ++i) {
    const ParticleType& type = rule_.types[type_[i]];
    const double per_mass = rule_.dt / rule_.mass_of(type_[i]), speed = v[i].norm();
    const double held = type.pd ? type.kp * away_[i] + type.kd * fast_[i] : 0;
    const double gain = per_mass * size_[i] + rule_.dt * type.gravity.norm();
    fast_[i] += per_mass * (force_[i] + held) + 6 * both_ * (speed + gain + type.velocity.norm());
    const double moved = rule_.dt * fast_[i] + 3 * both_ * rule_.dt * (speed + gain) + 2 * unit_;
    off_[i] += moved, away_[i] += moved;
  }
}

double ProgramErrors::field_share() const {
  double share = 0;
  for (const ProgramField& field : program_.particle)
    for (uint32_t k = 0; k < field.numbers(); ++k) {
      double error = 0, size = 0;
      for (const Number& number : shown_[field.first + k])
        error = std::max(error, number.error), size = std::max(size, std::abs(number.value));
      if (size > 0) share = std::max(share, error / size);
    }
  return share;
}

double ProgramErrors::position() const { return *std::ranges::max_element(off_) * std::sqrt(3.0); }

}  // namespace cuboct
