// SPDX-License-Identifier: MIT
#include "model/program/lowering.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "model/base/error.h"

namespace cuboct {
namespace {

using Source = RealSource;

constexpr double kSteepest =
    512;  // a table begins where its function is so many times what it is further out
constexpr double kFurther = 0.55;  // of the reach
constexpr double kNearest = 1.0 / 64;
constexpr int kBeyondBits = 28;  // a value of a table has less
constexpr int64_t kBeyond = int64_t{1} << (kBeyondBits - 1);

bool is_product(RealOp op) { return op == RealOp::multiply || op == RealOp::divide || op == RealOp::negate; }
bool is_comparison(RealOp op) { return op == RealOp::below || op == RealOp::at_most; }
bool is_truth(RealOp op) {
  return is_comparison(op) || op == RealOp::equal || op == RealOp::both || op == RealOp::either ||
         op == RealOp::inverse;
}

}  // namespace

void refuse_rule(const std::string& what, const std::string& hint) {
  throw InputError(what, hint).about({"rule.file", "rule"});
}

Lowering::Lowering(const RealGraph& graph, graph::Builder& builder,
                   std::function<Scaled(const RealInput&)> input, int factor_bits)
    : graph_(graph),
      b_(builder),
      integers_(builder, factor_bits),
      input_(std::move(input)),
      made_(graph.nodes().size()) {}

void Lowering::pairs(const Radial& radial, const Scaled& r2, double reach2) {
  radial_ = &radial, r2_ = r2, reach2_ = reach2;
}

void Lowering::bonds(const Radial& radial, const Scaled& r2, BondGraph& bond) {
  radial_ = &radial, r2_ = r2, bond_ = &bond;
  windowed_.assign(graph_.nodes().size(), 0);
  for (NodeId id = 0; id < windowed_.size(); ++id) {
    const RealNode& node = graph_.at(id);
    // A comparison of r is a threshold, and so are the parts of a truth that is made of such.
    if (fixed(id) || radial.is_r2(id) || (of_r(id) && is_comparison(node.op))) continue;
    windowed_[id] = of_r(id) && !is_truth(node.op);
    for (size_t k = 0; k < static_cast<size_t>(arity(node.op)); ++k)
      if (windowed_[node.of[k]] != 0) windowed_[id] = 1;
  }
}

Scaled Lowering::value(NodeId id, double unit) {
  if (unit > 0 && wants(id)) return made(id, unit);
  if (!made_[id]) made_[id] = made(id, 0);
  return *made_[id];
}

// Whether a table of r is a factor of it, or of each part of a sum.
bool Lowering::wants(NodeId id) const {
  const RealNode& node = graph_.at(id);
  if (of_r(id)) return !radial_->is_r2(id);
  if (node.op == RealOp::add || node.op == RealOp::subtract) return wants(node.of[0]) && wants(node.of[1]);
  if (!is_product(node.op)) return false;
  Factors factors;
  gather(id, false, factors);
  return !factors.of_r.empty();
}

void Lowering::gather(NodeId id, bool divides, Factors& to) const {
  const RealNode& node = graph_.at(id);
  if (node.op == RealOp::constant) {
    to.constant *= divides ? 1 / node.value : node.value;
  } else if (fixed(id)) {
    to.fixed.emplace_back(id, divides);
  } else if (of_r(id)) {
    to.of_r.emplace_back(id, divides);
  } else if (node.op == RealOp::negate) {
    to.constant = -to.constant;
    gather(node.of[0], divides, to);
  } else if (is_product(node.op)) {
    gather(node.of[0], divides, to);
    gather(node.of[1], divides != (node.op == RealOp::divide), to);
  } else {
    to.others.emplace_back(id, divides);
  }
}

Scaled Lowering::made(NodeId id, double unit) {
  const RealNode& node = graph_.at(id);
  if (node.op == RealOp::constant) return Scaled::of(node.value);
  if (radial_ != nullptr && radial_->is_r2(id)) return r2_;
  if (fixed(id)) return fixed_product({{id, false}});
  if (bond_ != nullptr && of_r(id) && is_comparison(node.op))
    return bond_->threshold(
        [&](const RealRange& r2, size_t length) { return certain(radial_->over(id, r2, length)); });
  if (of_r(id) && !is_truth(node.op)) return table({{id, false}}, unit);
  const auto of = [&](size_t k) { return value(node.of[k], 0); };
  switch (node.op) {
    case RealOp::input:
      return input_(node.input);
    case RealOp::subtract:
      if (is_relative(node)) return relative_(graph_.at(node.of[0]).input.index);
      [[fallthrough]];
    case RealOp::add:
      return of_several(node, unit);
    case RealOp::multiply:
    case RealOp::divide:
    case RealOp::negate:
      return product(id, unit);
    case RealOp::absolute:
      return integers_.absolute(of(0));
    case RealOp::inverse:
      return integers_.inverse(of(0));
    case RealOp::least:
    case RealOp::most:
    case RealOp::below:
    case RealOp::at_most:
    case RealOp::equal:
    case RealOp::both:
    case RealOp::either:
    case RealOp::select:
      return of_several(node, 0);
    case RealOp::curve:
    case RealOp::curve_slope:
      return tabled(node, of(0));
    case RealOp::power:
    default:
      return of_one(node, of(0));
  }
}

Scaled Lowering::of_several(const RealNode& node, double unit) {
  std::array<Scaled, 3> of;
  for (auto k = static_cast<size_t>(arity(node.op)); k-- > 0;) of[k] = value(node.of[k], unit);
  switch (node.op) {
    case RealOp::add:
      return integers_.add(of[0], of[1]);
    case RealOp::subtract:
      return integers_.subtract(of[0], of[1]);
    case RealOp::least:
    case RealOp::most:
      return integers_.chosen(node.op == RealOp::least, of[0], of[1]);
    case RealOp::below:
    case RealOp::at_most:
      return integers_.below(of[0], of[1], node.op == RealOp::at_most);
    case RealOp::equal:
      return integers_.equal(of[0], of[1]);
    case RealOp::both:
      return integers_.both(of[0], of[1]);
    case RealOp::either:
      return integers_.either(of[0], of[1]);
    default:
      return integers_.select(of[0], of[1], of[2]);
  }
}

// v_j - v_i of one axis.
bool Lowering::is_relative(const RealNode& node) const {
  const RealNode &a = graph_.at(node.of[0]), &b = graph_.at(node.of[1]);
  return relative_ && node.op == RealOp::subtract && a.op == RealOp::input && b.op == RealOp::input &&
         a.input.source == Source::other_velocity && b.input.source == Source::own_velocity &&
         a.input.index == b.input.index;
}

// One table for all that depends on r, last, in what is left of the unit.
Scaled Lowering::product(NodeId id, double unit) {
  Factors factors;
  gather(id, false, factors);
  if (!std::isfinite(factors.constant)) refuse_rule("the rule divides by 0");
  Scaled all = Scaled::of(factors.constant);
  for (const auto& [of, divides] : factors.others) {
    const Scaled x = value(of);
    all = integers_.multiply(all, divides ? of_one({RealOp::divide, {}, 0, {}, nullptr}, x) : x);
  }
  // A table takes in what all bonds of one length have alike.
  if (!factors.of_r.empty())
    std::erase_if(factors.fixed, [&](const Factor& factor) {
      const bool alike = radial_->is_of_length(factor.first);
      if (alike) factors.of_r.push_back(factor);
      return alike;
    });
  if (!factors.fixed.empty()) all = integers_.multiply(all, fixed_product(factors.fixed));
  if (factors.of_r.empty()) return all;
  if (all.constant() && all.number == 0) return all;
  const double left = all.constant() ? unit / std::abs(all.number) : unit / all.unit;
  return integers_.multiply(all, table(factors.of_r, left));
}

Scaled Lowering::fixed_product(const std::vector<Factor>& factors) {
  std::vector<double> by_class;
  for (size_t c = 0; c < radial_->classes(); ++c) {
    double made = 1;
    for (const auto& [of, divides] : factors) {
      const double x = radial_->fixed_at(of, c);
      made *= divides ? 1 / x : x;
    }
    by_class.push_back(made);
  }
  return bond_->constant(by_class);
}

// A function of one value that is no function of r: by a table of 14 octaves below the value's largest, or
// from its least on.
Scaled Lowering::of_one(const RealNode& node, const Scaled& a) {
  if (!a.constant() && b_.range(a.node).low < 0)
    refuse_rule(
        "a root, a power, a quotient, exp, log, sin, cos or erfc of what may be negative is not in integers "
        "yet");
  const double exponent = node.op == RealOp::power ? graph_.at(node.of[1]).value : 0;
  const auto f = [&](double x) {
    return node.op == RealOp::divide ? 1 / x : applied(node.op, x, exponent, 0);
  };
  if (a.constant()) return Scaled::of(f(a.number));
  const double unit = std::ldexp(a.unit, -a.frac), most = unit * static_cast<double>(b_.range(a.node).high);
  const double least = unit * static_cast<double>(b_.range(a.node).low);
  // The bin of 64 an octave that holds the largest value is f to its end.
  const int64_t high = b_.range(a.node).high;
  const int64_t bin =
      int64_t{1} << std::max(0, static_cast<int>(std::bit_width(static_cast<uint64_t>(high))) - 7);
  const double end = unit * static_cast<double>((high / bin + 1) * bin);
  return integers_.function(a, f, std::max(least, std::ldexp(most, -14)), end, 0);
}

// A table of the rule, of what is no function of r: below 0 as at 0, beyond its end a fault.
Scaled Lowering::tabled(const RealNode& node, const Scaled& a) {
  const auto f = [&](double x) { return applied(node, x, 0, 0); };
  if (a.constant()) return Scaled::of(f(a.number));
  const double end = node.table->end();
  if (node.table->begin() < 0 || !(end > 0))
    refuse_rule(fmt::format("the table '{}' begins below 0", node.table->what()));
  const Scaled x = integers_.chosen(true, integers_.chosen(false, a, Scaled::of(0)), Scaled::of(end));
  Scaled value = integers_.function(x, f, std::ldexp(end, -14), end, 0);
  const Scaled beyond = integers_.below(Scaled::of(end), a, false);
  if (node.table->bounded() && !beyond.constant())
    value.node = b_.check(b_.select(beyond.node, b_.constant(kBeyond), value.node), kBeyondBits, Fault::sum,
                          radial_ != nullptr ? b_.when() : -1);
  return value;
}

// Of a product of what depends on r alone; the axes of a vector share it.
Scaled Lowering::table(const std::vector<Factor>& factors, double unit) {
  const auto [at, fresh] = tables_.try_emplace({factors, unit});
  if (!fresh) return at->second;
  const auto product = [&](double r2, size_t length) {
    double made = 1;
    for (const auto& [of, divides] : factors) {
      const double x = radial_->at(of, r2, length);
      made *= divides ? 1 / x : x;
    }
    return made;
  };
  at->second = bond_ != nullptr ? bond_->table(integers_, product, unit)
                                : fitted([&](double r2) { return product(r2, 0); }, unit);
  return at->second;
}

// From where the function is not too steep. Nearer pairs are a fault, not a wrong force.
Scaled Lowering::fitted(const std::function<double(double)>& f, double unit) {
  double usual = 0;
  constexpr int kSamples = 64;
  const auto at = [&](double part) { return f(part * part * reach2_); };
  for (int k = 0; k <= kSamples; ++k)
    usual = std::max(usual, std::abs(at(kFurther + (1 - kFurther) * k / kSamples)));
  double from = kFurther;
  while (from > kNearest && std::isfinite(at(0.97 * from)) && std::abs(at(0.97 * from)) <= kSteepest * usual)
    from *= 0.97;
  const Scaled of_r2 = r2_;
  const double core2 = from > kNearest ? from * from * reach2_ : 0;
  const auto kept = [&](double r2) {
    return f(std::max(r2, std::max(core2, kNearest * kNearest * reach2_)));
  };
  Scaled value =
      integers_.function(of_r2, kept, std::max(core2, kNearest * kNearest * reach2_), reach2_, unit);
  if (core2 > 0) value.node = guarded(value.node, core2);
  return value;
}

int Lowering::guarded(int node, double core2) {
  const int core = integers_.node_in(Scaled::of(core2), r2_.unit, r2_.frac);
  const int near = b_.lt(r2_.node, core);
  return b_.check(b_.select(near, b_.constant(kBeyond), node), kBeyondBits, Fault::strength, b_.when());
}

}  // namespace cuboct
