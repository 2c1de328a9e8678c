// SPDX-License-Identifier: MIT
#include "model/program/bond_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "model/base/error.h"
#include "model/program/fit_table.h"

namespace cuboct {
namespace {

constexpr size_t kMostLengths = 64;
constexpr int kConstantBits = 46;
constexpr int kMostLooks = 200000;  // for where a truth changes

// What the other end of each bond has.
graph::Parity parity_of(const BondClasses& classes, const std::vector<int64_t>& values) {
  bool even = true, odd = true;
  for (const auto& [own, other] : classes.ends()) {
    even = even && values[own] == values[other];
    odd = odd && values[own] == -values[other];
  }
  return even ? graph::Parity::even : odd ? graph::Parity::odd : graph::Parity::none;
}

// Where a truth of r2 changes, in units of r2.
class Turn {
 public:
  using Truth = std::function<std::optional<bool>(int64_t low, int64_t high)>;
  explicit Turn(Truth truth) : truth_(std::move(truth)) {}

  bool at(int64_t r2) const { return truth_(r2, r2).value_or(false); }
  // The last r2 up to `most` at which it is what it is at 1. InputError where it changes again.
  int64_t last(int64_t most) const {
    Search search{1, at(1), most};
    look(search, 1, most);
    return search.last;
  }

 private:
  struct Search {
    int64_t seen;  // so far
    bool now;      // there
    int64_t last;
    int changes = 0, looks = 0;
  };
  // sqrt(r2) counts digits of a difference: what changes to and fro within two of them is not told apart.
  void look(Search& search, int64_t low, int64_t high) const {
    if (++search.looks > kMostLooks) refuse("cannot be shown to change once at most as a bond grows");
    if (const auto all = truth_(low, high)) return see(search, high, *all);
    const auto a = static_cast<int64_t>(std::sqrt(static_cast<double>(low))),
               b = static_cast<int64_t>(std::sqrt(static_cast<double>(high)));
    if (b - a < 2) return see(search, high, at(high));
    const int64_t middle = (a + (b - a) / 2) * (a + (b - a) / 2);
    look(search, low, middle);
    look(search, middle, high);
  }
  void see(Search& search, int64_t r2, bool now) const {
    if (now != search.now) {
      if (++search.changes > 1) refuse("changes more than once as a bond grows");
      int64_t low = search.seen, high = r2;
      while (high - low > 1) {
        const int64_t middle = low + (high - low) / 2;
        (at(middle) == search.now ? low : high) = middle;
      }
      search.last = low;
    }
    search.seen = r2, search.now = now;
  }
  [[noreturn]] static void refuse(const std::string& what) {
    throw InputError("a comparison in the rule " + what,
                     "compare with each limit by itself; engine reference runs it as it is")
        .about({"rule.file", "rule"});
  }

  Truth truth_;
};

}  // namespace

BondFrame::BondFrame(const BondClasses& classes, const FixedRule& base, graph::FixedProgram& program)
    : classes_(classes),
      program_(program),
      unit2_(std::ldexp(base.cell_edge * base.cell_edge, -2 * base.widths.difference_frac)) {
  if (classes.lengths2().size() > kMostLengths)
    throw InputError(fmt::format("the bonds of the body have {} lengths: integers have tables for {}",
                                 classes.lengths2().size(), kMostLengths),
                     "engine reference runs it")
        .about({"rule.file", "rule"});
  int64_t widest = 1;
  for (const double c : classes.lengths2()) {
    from_.push_back(std::llround((1 - kBondStretch) * (1 - kBondStretch) * c / unit2_));
    width_.push_back(std::llround(4 * kBondStretch * c / unit2_));
    widest = std::max(widest, width_.back());
  }
  bits_ = static_cast<int>(std::bit_width(static_cast<uint64_t>(widest)));
  bits_ += bits_ % 2;
  constexpr int kLeastBits = 26;
  if (bits_ < kLeastBits)
    throw InputError(
        fmt::format("r^2 has {} bits about the length of a bond: tables need {}", bits_, kLeastBits),
        "more bits of difference_frac")
        .about({"widths.difference_frac", "rule.file", "rule"});
}

int BondFrame::read(graph::Builder& b, const std::vector<int64_t>& by_class, int frac,
                    const std::string& name) {
  auto at = std::ranges::find(constants_, by_class);
  while (at != constants_.end() &&
         program_.bond_constants[static_cast<size_t>(at - constants_.begin())].frac != frac)
    at = std::find(at + 1, constants_.end(), by_class);
  const auto constant = static_cast<int>(at - constants_.begin());
  if (at == constants_.end()) {
    const auto [low, high] = std::ranges::minmax(by_class);
    program_.bond_constants.push_back({name, {low, high}, frac, parity_of(classes_, by_class)});
    constants_.push_back(by_class);
  }
  return graph::read_bond_constant(b, program_, constant);
}

Scaled BondFrame::read(graph::Builder& b, const std::vector<double>& by_class, const std::string& name) {
  double most = 0;
  bool equal = true, truths = true;
  for (const double value : by_class) {
    most = std::max(most, std::abs(value));
    equal = equal && value == by_class.front();
    truths = truths && (value == 0 || value == 1);
  }
  if (!std::isfinite(most))
    throw InputError("what the rule makes of a bond of the body as packed is no number")
        .about({"rule.file", "rule"});
  if (by_class.empty() || equal) return Scaled::of(by_class.empty() ? 0 : by_class.front());
  int exponent = 0;
  std::frexp(most, &exponent);
  const int frac = truths ? 0 : kConstantBits - 1 - exponent;
  std::vector<int64_t> integers;
  for (const double value : by_class) integers.push_back(std::llround(std::ldexp(value, frac)));
  return {read(b, integers, frac, name), 0, frac, 1};
}

std::shared_ptr<const graph::BondRows> BondFrame::rows(const ReferenceBonds& bonds) const {
  auto rows = std::make_shared<graph::BondRows>();
  rows->first = bonds.first;
  rows->other = bonds.other;
  rows->kind = classes_.of_bond();
  for (size_t c = 0; c < classes_.size(); ++c)
    for (const std::vector<int64_t>& constant : constants_) rows->constants.push_back(constant[c]);
  return rows;
}

int BondGraph::above_window() {
  const int from = frame_.read(b_, frame_.by_class(frame_.from()), b_.frac(r2_), "from");
  return b_.sub(r2_, from);
}

Scaled BondGraph::table(Integers& integers, const std::function<double(double, size_t)>& f, double unit) {
  const Scaled values = Integers::scaled(0, 0, unit > 0 ? unit : 1);
  WindowRoom room{
      .bits = frame_.bits(), .step = frame_.unit2(), .from = {}, .width = {}, .unit = values.unit};
  std::vector<int64_t> laws;
  for (size_t k = 0; k < frame_.from().size(); ++k) {
    room.from.push_back(static_cast<double>(frame_.from()[k]) * frame_.unit2());
    room.width.push_back(static_cast<double>(frame_.width()[k]) * frame_.unit2());
    laws.push_back(static_cast<int64_t>(k));
  }
  const FittedTable fitted = fit_window(room, f);
  const int argument = b_.clamp(above_window(), {0, (int64_t{1} << room.bits) - 1});
  const int law = laws.size() < 2 ? -1 : frame_.read(b_, frame_.by_class(laws), 0, "length");
  return integers.looked_up(fitted, values.unit, argument, law);
}

Scaled BondGraph::threshold(const Truth& truth) {
  const int64_t most = b_.range(r2_).high;
  std::vector<int64_t> limit;  // the last r2 at which the truth is what it is at first
  std::vector<bool> first;
  for (size_t length = 0; length < frame_.from().size(); ++length) {
    const Turn turn([&](int64_t low, int64_t high) {
      return truth({static_cast<double>(low) * frame_.unit2(), static_cast<double>(high) * frame_.unit2()},
                   length);
    });
    first.push_back(turn.at(1));
    limit.push_back(turn.last(most));
  }
  // Of all lengths the same truth holds up to the limit; one that never changes has none, or all.
  bool below = !first.empty() && first.front();
  for (size_t k = 0; k < limit.size(); ++k)
    if (limit[k] < most) below = first[k];
  for (size_t k = 0; k < limit.size(); ++k)
    if (first[k] != below) {
      if (limit[k] < most)
        throw InputError("a comparison in the rule turns with the length of the bond",
                         "engine reference runs it")
            .about({"rule.file", "rule"});
      limit[k] = -1;
    }
  const int reached = b_.le(r2_, frame_.read(b_, frame_.by_class(limit), b_.frac(r2_), "limit"));
  return {below ? reached : b_.negate(reached), 0, 0, 1};
}

Scaled BondGraph::inside(int counts) {
  const int above = above_window();
  const int width = frame_.read(b_, frame_.by_class(frame_.width()), b_.frac(r2_), "width");
  const int beyond = b_.lt(width, above), zero = b_.constant(0),
            outside = b_.either(b_.lt(above, zero), beyond);
  // One bit holds 0 and -1.
  const int told = b_.check(b_.select(outside, b_.constant(1), zero), 1, Fault::strength, counts);
  return {b_.eq(told, b_.constant(0)), 0, 0, 1};
}

}  // namespace cuboct
