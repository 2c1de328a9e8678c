// SPDX-License-Identifier: MIT
#include "model/program/integer_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <optional>

#include "model/base/error.h"
#include "model/contract/pair_program.h"
#include "model/graph/noise.h"
#include "model/graph/parity.h"
#include "model/program/bond_graph.h"
#include "model/program/for_ever.h"
#include "model/program/lowering.h"

namespace cuboct {
namespace {

using graph::Builder;
using graph::FixedProgram;
using Source = RealSource;

constexpr int kFieldBits = 46;      // of a field that goes on, where it names no resolution
constexpr int kLeastFieldBits = 8;  // where it does
constexpr int kLeastFactorBits = 15;
constexpr int kSumBits = 50;  // of a sum
constexpr int64_t kMostIds = int64_t{1} << 32, kMostSteps = int64_t{1} << 48;

class Program {
 public:
  Program(const RuleProgram& rule, const FixedRule& base, int capacity, const ProgramStart& start)
      : rule_(rule), base_(base), start_(start) {
    out_.program = begun_program(rule.declaration.name, base, capacity);
    fields();
    if (rule.declaration.bonds == BondRange::reference) begin_bonds();
    for (size_t k = 0; k < rule.rounds.size(); ++k) add_round(k);
  }

  IntegerProgram take() {
    if (frame_) out_.rows = frame_->rows(start_.rows);
    refuse_writes_of_one_end();
    check(out_.program);
    return std::move(out_);
  }

 private:
  static graph::Interval of_bits(int bits) {
    return {-(int64_t{1} << (bits - 1)), (int64_t{1} << (bits - 1)) - 1};
  }

  struct Format {
    graph::Interval room;
    int frac = 0;
  };
  static Format format_of(const ProgramField& field, double low, double high) {
    if (field.kind == Value::Kind::truth) return {{0, 1}, 0};
    const double most = std::max({std::abs(low), std::abs(high), 1e-300});
    int exponent = 0;
    std::frexp(most, &exponent);
    if (field.resolution == 0) return {of_bits(kFieldBits), kFieldBits - 1 - exponent};
    const int frac = -std::ilogb(field.resolution), bits = frac + exponent + 1;
    if (bits < kLeastFieldBits || bits > kFieldBits)
      refuse_rule(
          fmt::format("integers of '{}' would have {} bits, of units of 2^{} and numbers up to {:.4g} "
                      "(SI): they have {} to {}",
                      field.name, bits, -frac, most, kLeastFieldBits, kFieldBits),
          fmt::format("a resolution that is {}", bits > kFieldBits ? "less fine" : "finer"));
    return {of_bits(bits), frac};
  }
  static int bits_of(const graph::Interval& room) {
    return static_cast<int>(std::bit_width(static_cast<uint64_t>(room.high))) + 1;
  }
  // Fields that are resolved coarsely need no finer factors.
  int factor_bits() const {
    int most = 0;
    for (const auto* fields : {&rule_.particle, &rule_.bond})
      for (const ProgramField& field : *fields) {
        if (field.name == kForceField || field.kind == Value::Kind::truth) continue;
        if (field.resolution == 0 || !field.range) return Integers::kFactorBits;
        most = std::max(most, bits_of(format_of(field, field.range->first, field.range->second).room));
      }
    return most == 0 ? Integers::kFactorBits : std::clamp(most - 1, kLeastFactorBits, Integers::kFactorBits);
  }

  // Fields that a round makes have the range that the text gives; others that of what they begin with.
  void fields() {
    place_.assign(rule_.particle_numbers, -1);
    for (size_t k = 0; k < rule_.particle.size(); ++k) {
      const ProgramField& field = rule_.particle[k];
      if (field.name == kForceField) continue;
      const auto [low, high] = range_of(field);
      auto [room, frac] = format_of(field, low, high);
      if (!is_made(field)) room = held_by(field, frac);
      out_.program.fields.push_back({field.name, static_cast<int>(field.numbers()), room, frac});
      out_.scales.push_back({1, frac});
      out_.field.push_back(k);
      for (uint32_t n = 0; n < field.numbers(); ++n)
        place_[field.first + n] = static_cast<int>(out_.program.fields.size()) - 1;
    }
  }
  // What a field that no round makes has of its format.
  graph::Interval held_by(const ProgramField& field, int frac) const {
    double low = INFINITY, high = -INFINITY;
    for (uint32_t n = 0; n < field.numbers(); ++n)
      for (const double value : start_.particle[field.first + n])
        low = std::min(low, value), high = std::max(high, value);
    if (low > high) low = high = 0;
    return {std::llround(std::ldexp(low, frac)), std::llround(std::ldexp(high, frac))};
  }
  bool is_made(const ProgramField& field) const {
    return std::ranges::any_of(rule_.rounds, [&](const ProgramRound& round) {
      return std::ranges::any_of(round.made,
                                 [&](const ProgramWrite& write) { return write.number == field.first; });
    });
  }
  std::pair<double, double> range_of(const ProgramField& field) const {
    if (field.range) return *field.range;
    if (const auto range = range_of_tables(field)) return *range;
    if (is_made(field) && field.kind != Value::Kind::truth)
      refuse_rule(fmt::format("integers need the 'range' of the field '{}'", field.name),
                  "range = \"[LEAST, GREATEST] UNIT\" among its keys; engine reference needs none");
    double low = 0, high = 0;
    for (uint32_t n = 0; n < field.numbers(); ++n)
      for (const double value : start_.particle[field.first + n])
        low = std::min(low, value), high = std::max(high, value);
    return {low, high};
  }
  // Of a field that is what a table gives, that of the table.
  std::optional<std::pair<double, double>> range_of_tables(const ProgramField& field) const {
    std::optional<std::pair<double, double>> range;
    for (const ProgramRound& round : rule_.rounds)
      for (const ProgramWrite& write : round.made) {
        if (write.number != field.first) continue;
        const auto of = range_of_table(round.finish, write.node);
        if (!of) return std::nullopt;
        range = range ? hull(*range, *of) : *of;
      }
    return range;
  }
  static std::pair<double, double> hull(std::pair<double, double> a, std::pair<double, double> b) {
    return {std::min(a.first, b.first), std::max(a.second, b.second)};
  }
  static std::optional<std::pair<double, double>> range_of_table(const RealGraph& graph, NodeId id) {
    const RealNode& node = graph.at(id);
    if (is_curve(node.op)) return node.table->range(node.op == RealOp::curve_slope);
    if (node.op != RealOp::select) return std::nullopt;
    const auto a = range_of_table(graph, node.of[1]), b = range_of_table(graph, node.of[2]);
    return a && b ? std::optional(hull(*a, *b)) : std::nullopt;
  }
  // 2^k of the k-th element of the rule's tables.
  Scaled element(Builder& b, graph::Source source) {
    if (rule_.element.empty()) return Scaled::of(1);
    if (element_ < 0) {
      element_ = static_cast<int>(out_.program.type_constants.size());
      std::vector<int64_t> values(rule_.element.begin(), rule_.element.end());
      out_.program.type_constants.push_back({"element", values, 0});
    }
    return {graph::read_constant(b, out_.program, source, element_), 0, 0, 1};
  }
  Scaled read_field(Builder& b, graph::Source source, uint32_t number) const {
    const int field = place_[number];
    const auto component = number - rule_.particle[out_.field[static_cast<size_t>(field)]].first;
    const int node = graph::read_field(b, out_.program, source, field, static_cast<int>(component));
    return {node, 0, out_.scales[static_cast<size_t>(field)].frac, 1};
  }
  Scaled mass(Builder& b, graph::Source source) {
    if (!base_.weighted) return Scaled::of(base_.mass);
    constexpr int kMassFrac = 10;  // masses differ by 1,024 at most
    std::vector<int64_t> values;
    for (size_t t = 0; t < base_.types.size(); ++t)
      values.push_back(std::llround(std::ldexp(mass_of(base_, static_cast<int>(t)) / base_.mass, kMassFrac)));
    if (mass_ < 0) {
      mass_ = static_cast<int>(out_.program.type_constants.size());
      out_.program.type_constants.push_back({"mass", values, kMassFrac});
    }
    return Integers::scaled(graph::read_constant(b, out_.program, source, mass_), kMassFrac, base_.mass);
  }
  // As the engine of doubles has it.
  Scaled noise(Builder& b, graph::Source other_id, uint32_t stream) const {
    const auto id = [&](graph::Source source) { return b.input(source, 0, 0, {0, kMostIds - 1}); };
    const int own = id(graph::Source::own_id), other = id(other_id);
    int step = b.input(graph::Source::step, 0, 0, {0, kMostSteps});
    if (rule_.first_step > 0) step = b.add(step, b.constant(static_cast<int64_t>(rule_.first_step)));
    const int drawn = b.noise(own, other, step, stream, graph::kNoiseBits);
    const int one = b.constant(1), odd = b.named(b.add(b.shl(drawn, 1), one), "noise");
    return Integers::scaled(odd, graph::kNoiseBits, std::ldexp(graph::kNoiseUnit, graph::kNoiseBits));
  }
  Scaled velocity(Builder& b, graph::Source source, uint32_t axis) const {
    if (static_cast<int>(axis) >= base_.axes) return Scaled::of(0);
    const int node = graph::read_velocity(b, out_.program, source, static_cast<int>(axis));
    return Integers::scaled(node, base_.widths.velocity_frac(),
                            base_.edges()[static_cast<int>(axis)] / base_.dt);
  }

  // As the pair law has it: a difference that does not fit is a fault. `counts`: where it is one; -1:
  // anywhere.
  Scaled relative_velocity(Builder& b, uint32_t axis, int counts) const {
    if (static_cast<int>(axis) >= base_.axes) return Scaled::of(0);
    const auto a = static_cast<int>(axis);
    const int own = graph::read_velocity(b, out_.program, graph::Source::own_v, a);
    const int apart = b.sub(graph::read_velocity(b, out_.program, graph::Source::other_v, a), own);
    const int w = b.check(b.round(apart, base_.w_shift), base_.widths.relative_velocity_bits,
                          Fault::relative_velocity, counts);
    return Integers::scaled(w, base_.widths.relative_velocity_frac, base_.edges()[a] / base_.dt);
  }

  struct SumScale {
    Scaled term;  // its unit and frac
    int sum = 0, component = 0;
  };

  void add_round(size_t k) {
    const ProgramRound& from = rule_.rounds[k];
    graph::Round round;
    round.name = from.name;
    Builder b;
    std::vector<int> d = differences(b);
    const int r2 = b.named(b.dot(d, d), "r2"), D = base_.widths.difference_frac;
    b.counts(frame_ ? b.constant(1)
                    : b.named(b.lt(r2, b.constant(static_cast<int64_t>(base_.cutoff2), 2 * D)), "when"));
    for (int& part : d) part = b.within(part);
    const Radial radial(from.pair, frame_ ? &frame_->classes() : nullptr);
    const Scaled square = Integers::scaled(b.within(r2), 2 * D, base_.cell_edge * base_.cell_edge);
    Lowering pair(
        from.pair, b, [&](const RealInput& input) { return pair_input(b, input, d); }, factor_bits_);
    std::optional<BondGraph> bond;
    if (frame_) {
      pair.bonds(radial, square, bond.emplace(*frame_, b, r2));
      lasting_ = b.negate(broken(b));
    } else {
      pair.pairs(radial, square, rule_.reach * rule_.reach);
    }
    pair.relative([&](uint32_t axis) { return relative_velocity(b, axis, frame_ ? lasting_ : -1); });
    if (bond) write_bonds(k, pair, *bond, b, round);
    const std::vector<SumScale> scales = add_terms(k, pair, bond ? &*bond : nullptr, b, round);
    round.when = b.when();
    round.pair = b.take();
    out_.tables.push_back(pair.integers().fits());
    add_finish(k, scales, round);
    out_.program.rounds.push_back(std::move(round));
  }
  // A bond that counts is no longer than a cell; of any other d is cut off, so that r2 has 2 D + 3 bits.
  std::vector<int> differences(Builder& b) const {
    std::vector<int> d;
    const int64_t most = (int64_t{5} << base_.widths.difference_frac) / 4;
    for (int a = 0; a < base_.axes; ++a) {
      const int apart = b.round(read_apart(b, out_.program, a), base_.difference_shift);
      d.push_back(b.named(shaped_difference(b, base_, a, apart), "d"));
      if (frame_ && base_.cubic()) d.back() = b.clamp(d.back(), {-most, most});
    }
    return d;
  }

  // Bonds that last, and what they keep.
  void begin_bonds() {
    out_.program.bonded = true;
    out_.program.partners = static_cast<int>(graph::BondRows{start_.rows.first, {}, {}, {}}.longest());
    classes_.emplace(rule_, start_);
    frame_.emplace(*classes_, base_, out_.program);
    out_.lengths = classes_->lengths2().size();
    bond_place_.assign(rule_.bond_numbers, -1);
    for (size_t k = 0; k < rule_.bond.size(); ++k) {
      const ProgramField& field = rule_.bond[k];
      if (classes_->fixed({Source::bond_field, field.first})) continue;
      if (!field.range && field.kind != Value::Kind::truth)
        refuse_rule(fmt::format("integers need the 'range' of the bonds' field '{}'", field.name),
                    "range = \"[LEAST, GREATEST] UNIT\" among its keys; engine reference needs none");
      const auto [low, high] = field.range.value_or(std::pair(0.0, 1.0));
      const auto [room, frac] = format_of(field, low, high);
      check_ends(field, std::max(std::abs(low), std::abs(high)));
      for (uint32_t n = 0; n < field.numbers(); ++n)
        bond_place_[field.first + n] = static_cast<int>(out_.program.bonds.size());
      out_.program.bonds.push_back({field.name, static_cast<int>(field.numbers()), room, frac});
      out_.bond_scales.push_back({1, frac});
      out_.bond_field.push_back(k);
    }
    if (!broken_for_ever(rule_)) return;
    Builder b;
    out_.program.broken_at = lowered_broken(b);
    out_.program.broken = b.take();
  }
  void check_ends(const ProgramField& field, double most) const {
    constexpr double kSame = 1e-9;
    const graph::BondRows rows{start_.rows.first, start_.rows.other, {}, {}};
    for (uint32_t i = 0; i < start_.rows.particles(); ++i)
      for (uint64_t b = rows.first[i]; b < rows.first[i + 1]; ++b)
        for (uint32_t n = field.first; n < field.first + field.numbers(); ++n)
          if (std::abs(start_.bond[n][b] - start_.bond[n][rows.twin(i, b)]) > kSame * most)
            refuse_rule(
                fmt::format("'{}' of the bond of particles {} and {} begins as another number at either end",
                            field.name, i, rows.other[b]),
                "a start that both ends see alike; engine reference runs it");
  }
  int lowered_broken(Builder& b) {
    Lowering lowering(
        rule_.broken, b, [&](const RealInput& input) { return read_bond(b, input.index); }, factor_bits_);
    const Scaled truth = lowering.value(*rule_.broken_at);
    return truth.constant() ? b.constant(truth.number != 0 ? 1 : 0) : truth.node;
  }
  int broken(Builder& b) { return out_.program.broken_at < 0 ? b.constant(0) : lowered_broken(b); }
  Scaled read_bond(Builder& b, uint32_t number) {
    const int field = bond_place_[number];
    if (field < 0) {
      std::vector<double> by_class;
      for (size_t c = 0; c < classes_->size(); ++c)
        by_class.push_back(classes_->at(c, {Source::bond_field, number}));
      return frame_->read(b, by_class, "constant");
    }
    const auto component = number - rule_.bond[out_.bond_field[static_cast<size_t>(field)]].first;
    const int node = graph::read_bond(b, out_.program, field, static_cast<int>(component));
    return {node, 0, out_.bond_scales[static_cast<size_t>(field)].frac, 1};
  }

  void write_bonds(size_t k, Lowering& pair, BondGraph& bond, Builder& b, graph::Round& round) {
    for (const ProgramWrite& write : rule_.rounds[k].bonds) {
      const auto field = static_cast<size_t>(bond_place_[write.number]);
      const graph::Field& to = out_.program.bonds[field];
      int node = pair.integers().node_in(pair.value(write.node), 1, to.frac);
      if (to.range != graph::Interval{0, 1}) node = b.check(node, bits_of(to.range), Fault::sum, lasting_);
      Scaled value{node, 0, to.frac, 1};
      if (pair.needs_window(write.node))
        value = pair.integers().select(bond.inside(lasting_), value, read_bond(b, write.number));
      const auto component = write.number - rule_.bond[out_.bond_field[field]].first;
      round.bond_writes.push_back(
          {static_cast<int>(field), static_cast<int>(component), b.named(value.node, to.name)});
      pair.replace(write.node, value);
    }
  }
  // Where a term counts: bonds that do are within their tables.
  Scaled counted(Lowering& pair, BondGraph* bond, Builder& b, NodeId when, NodeId term) {
    const Scaled truth = pair.value(when);
    if (bond == nullptr) return truth;
    if (pair.needs_window(when)) return pair.integers().both(truth, bond->inside(lasting_));
    if (!pair.needs_window(term)) return truth;
    const int counts = truth.constant() ? b.constant(truth.number != 0 ? 1 : 0) : truth.node;
    return pair.integers().both(truth, bond->inside(counts));
  }
  void refuse_writes_of_one_end() const {
    for (const graph::Round& round : out_.program.rounds) {
      const std::vector<graph::Parity> parities = graph::parities_of(round.pair);
      for (const graph::Write& write : round.bond_writes)
        if (!graph::is_even(parities[static_cast<size_t>(write.node)]))
          refuse_rule(
              fmt::format("the two ends of a bond may write another '{}'",
                          out_.program.bonds[static_cast<size_t>(write.field)].name),
              "what both ends see alike: r, r0, the bond's fields, sums of both particles' fields; engine "
              "reference runs it");
    }
  }

  Scaled pair_input(Builder& b, const RealInput& input, const std::vector<int>& d) {
    switch (input.source) {
      case Source::difference:
        return static_cast<int>(input.index) < base_.axes
                   ? Integers::scaled(d[input.index], base_.widths.difference_frac, base_.cell_edge)
                   : Scaled::of(0);
      case Source::own_velocity:
        return velocity(b, graph::Source::own_v, input.index);
      case Source::other_velocity:
        return velocity(b, graph::Source::other_v, input.index);
      case Source::own_mass:
        return mass(b, graph::Source::own_constant);
      case Source::other_mass:
        return mass(b, graph::Source::other_constant);
      case Source::own_element:
        return element(b, graph::Source::own_constant);
      case Source::other_element:
        return element(b, graph::Source::other_constant);
      case Source::own_field:
        return read_field(b, graph::Source::own_field, input.index);
      case Source::other_field:
        return read_field(b, graph::Source::other_field, input.index);
      case Source::bond_field:
        return read_bond(b, input.index);
      case Source::made:
        return Scaled::of(1);
      case Source::noise:
        return noise(b, graph::Source::other_id, input.index);
      default:
        return Scaled::of(base_.dt);
    }
  }

  // The axis of the force that a sum becomes, or is added to. Such a sum counts as velocities do: a term is
  // one rounding away from a kick.
  std::optional<int> force_of(size_t k, size_t term) const {
    if (rule_.still || k + 1 != rule_.rounds.size()) return std::nullopt;
    for (const ProgramWrite& write : rule_.rounds[k].made) {
      if (write.number < rule_.force || write.number >= rule_.force + 3) continue;
      const bool adds = std::ranges::any_of(addends_of(rule_.rounds[k].finish, write.node), [&](const Addend&
                                                                                                    part) {
        const RealNode& node = rule_.rounds[k].finish.at(part.node);
        return node.op == RealOp::input && node.input == RealInput{Source::sum, static_cast<uint32_t>(term)};
      });
      if (adds) return static_cast<int>(write.number - rule_.force);
    }
    return std::nullopt;
  }
  // What a finish adds to a field as it is, but for a constant: the sum of its terms changes fields by what
  // it is to the last bit, so that nothing is lost where they are odd. The unit and the fraction of the
  // terms.
  std::optional<FieldScale> added_to_field(size_t k, size_t term) const {
    const RealGraph& finish = rule_.rounds[k].finish;
    for (const ProgramWrite& write : rule_.rounds[k].made) {
      const RealNode& node = finish.at(write.node);
      if (place_[write.number] < 0 || node.op != RealOp::add) continue;
      for (size_t side = 0; side < 2; ++side) {
        const RealNode& field = finish.at(node.of[side]);
        if (field.op != RealOp::input || field.input != RealInput{Source::own_field, write.number}) continue;
        const std::optional<double> factor =
            factor_of(finish, node.of[1 - side], static_cast<uint32_t>(term));
        if (!factor || !(*factor > 0)) continue;
        return FieldScale{1 / *factor, out_.program.fields[static_cast<size_t>(place_[write.number])].frac};
      }
    }
    return std::nullopt;
  }
  // c where the node is c times the sum, and c is a constant.
  std::optional<double> factor_of(const RealGraph& graph, NodeId id, uint32_t sum) const {
    std::vector<std::optional<double>> at_one(id + 1), at_two(id + 1);
    const auto value = [&](const std::vector<std::optional<double>>& values, const RealNode& node,
                           double s) -> std::optional<double> {
      if (node.op == RealOp::constant) return node.value;
      if (node.op == RealOp::input) {
        if (node.input == RealInput{Source::sum, sum}) return s;
        if (node.input.source == Source::time_step) return base_.dt;
        if (node.input.source == Source::own_mass && !base_.weighted) return base_.mass;
        return std::nullopt;
      }
      std::array<double, 3> of{};
      for (int n = 0; n < arity(node.op); ++n) {
        const auto& part = values[node.of[static_cast<size_t>(n)]];
        if (!part) return std::nullopt;
        of[static_cast<size_t>(n)] = *part;
      }
      return applied(node, of[0], of[1], of[2]);
    };
    for (NodeId n = 0; n <= id; ++n) {
      at_one[n] = value(at_one, graph.at(n), 1);
      at_two[n] = value(at_two, graph.at(n), 2);
    }
    if (!at_one[id] || std::abs(*at_two[id] - 2 * *at_one[id]) > 1e-14 * std::abs(*at_two[id]))
      return std::nullopt;
    return at_one[id];
  }
  double kick_unit(int axis) const { return base_.mass * base_.edges()[axis] / (base_.dt * base_.dt); }

  static std::vector<std::string> names_of_sums(const RuleRound& round) {
    std::vector<std::string> names;
    for (const RuleField& sum : round.sums)
      for (int n = 0; n < sum.numbers; ++n)
        names.push_back(sum.numbers == 1 ? sum.name : fmt::format("{}.{}", sum.name, "xyz"[n]));
    return names;
  }
  std::vector<SumScale> add_terms(size_t k, Lowering& pair, BondGraph* bond, Builder& b,
                                  graph::Round& round) {
    const ProgramRound& from = rule_.rounds[k];
    const int spare = static_cast<int>(std::ceil(std::log2(out_.program.partners + 1)));
    const std::vector<std::string> names = names_of_sums(rule_.declaration.rounds[k]);
    std::vector<SumScale> scales;
    for (size_t n = 0; n < from.terms.size(); ++n) {
      const Scaled when = counted(pair, bond, b, from.when[n], from.terms[n]);
      Scaled term;
      if (const std::optional<int> axis = force_of(k, n)) {
        const int frac = base_.widths.velocity_frac();
        const double unit = kick_unit(*axis);
        const Scaled value = pair.integers().select(when, pair.value(from.terms[n], unit), Scaled::of(0));
        term = Integers::scaled(pair.integers().node_in(value, unit, frac), frac, unit);
      } else if (const auto added = added_to_field(k, n)) {
        term = pair.integers().select(when, pair.value(from.terms[n], added->unit), Scaled::of(0));
        term = Integers::scaled(pair.integers().node_in(term, added->unit, added->frac), added->frac,
                                added->unit);
      } else {
        term = pair.integers().select(when, pair.value(from.terms[n]), Scaled::of(0));
        if (term.constant())
          term = {pair.integers().node_of(term), 0, b.frac(pair.integers().node_of(term)), 1};
        term = pair.integers().narrow(term, kSumBits - spare);
      }
      scales.push_back({term, static_cast<int>(round.sums.size()), 0});
      round.sums.push_back({names[n], {term.node}});
    }
    return scales;
  }

  void add_finish(size_t k, const std::vector<SumScale>& scales, graph::Round& round) {
    const ProgramRound& from = rule_.rounds[k];
    Builder b;
    const auto sum = [&](uint32_t n) {
      const SumScale& scale = scales[n];
      const int node = graph::read_sum(b, out_.program, round, scale.sum, scale.component);
      return Scaled{node, 0, scale.term.frac, scale.term.unit};
    };
    Lowering finish(
        from.finish, b, [&](const RealInput& input) { return finish_input(b, input, sum); }, factor_bits_);
    for (const ProgramWrite& write : from.made) {
      if (place_[write.number] < 0) continue;  // of the force
      write_field(finish, b, write, round);
    }
    if (k + 1 == rule_.rounds.size()) move(finish, b, from);
    const auto& fits = finish.integers().fits();
    out_.tables.back().insert(out_.tables.back().end(), fits.begin(), fits.end());
    round.finish = b.take();
  }
  Scaled finish_input(Builder& b, const RealInput& input, const std::function<Scaled(uint32_t)>& sum) {
    switch (input.source) {
      case Source::sum:
        return sum(input.index);
      case Source::own_velocity:
        return velocity(b, graph::Source::own_v, input.index);
      case Source::own_mass:
        return mass(b, graph::Source::own_constant);
      case Source::own_element:
        return element(b, graph::Source::own_constant);
      case Source::own_field:
        return read_field(b, graph::Source::own_field, input.index);
      case Source::noise:
        return noise(b, graph::Source::own_id, input.index);
      case Source::position:
        refuse_rule("a finish of integers knows no position: a particle knows its place in its cell alone");
      default:
        return Scaled::of(base_.dt);
    }
  }
  // A value that is to be a field, in its own unit: what the field cannot hold is no reason to coarsen it.
  static Scaled checked(Builder& b, const Scaled& value, const graph::Field& field) {
    if (value.constant() || value.unit == 1) return value;
    const int width = bits_of(field.range) + value.frac - field.frac;
    if (width < 2 || width > 62) return value;
    return {b.check(value.node, width, Fault::sum), 0, value.frac, value.unit};
  }
  void write_field(Lowering& finish, Builder& b, const ProgramWrite& write, graph::Round& round) {
    const int field = place_[write.number];
    const graph::Field& to = out_.program.fields[static_cast<size_t>(field)];
    const bool number = to.range != graph::Interval{0, 1};
    Scaled value = finish.value(write.node);
    if (number) value = checked(b, value, to);
    int node = finish.integers().node_in(value, 1, to.frac);
    if (number) node = b.check(node, bits_of(to.range), Fault::sum);
    const auto component = write.number - rule_.particle[out_.field[static_cast<size_t>(field)]].first;
    round.writes.push_back({field, static_cast<int>(component), b.named(node, to.name)});
  }

  // Each part of a force is rounded once, so that none coarsens another.
  void move(Lowering& finish, Builder& b, const ProgramRound& from) {
    graph::Motion& motion = out_.program.motion;
    if (rule_.still) {
      for (int a = 0; a < base_.axes; ++a) {
        motion.v.push_back(graph::read_velocity(b, out_.program, graph::Source::own_v, a));
        motion.drift.push_back(b.constant(0));
      }
      return;
    }
    std::vector<int> kicks;
    for (int a = 0; a < base_.axes; ++a) {
      const uint32_t number = rule_.force + static_cast<uint32_t>(a);
      const auto write = std::ranges::find(from.made, number, &ProgramWrite::number);
      std::optional<int> kick;
      for (const Addend& part : addends_of(from.finish, write->node)) {
        int node =
            finish.integers().node_in(finish.value(part.node), kick_unit(a), base_.widths.velocity_frac());
        if (part.minus) node = b.neg(node);
        kick = kick ? b.add(*kick, node) : node;
      }
      kicks.push_back(*kick);
    }
    add_motion(b, out_.program, base_, kicks);
  }

  const RuleProgram& rule_;
  const FixedRule& base_;
  const ProgramStart& start_;
  const int factor_bits_ = factor_bits();
  IntegerProgram out_;
  std::optional<BondClasses> classes_;  // of bonds that last
  std::optional<BondFrame> frame_;
  std::vector<int> bond_place_;  // [number of a bond's field]: its field of the program; -1: it never changes
  int lasting_ = -1;             // of the graph of a bond: it counts
  std::vector<int> place_;       // [number of a particle field]: its field of the program; -1: the force
  int mass_ = -1, element_ = -1;  // the type constants
};

}  // namespace

IntegerProgram integer_program(const RuleProgram& rule, const FixedRule& base, int capacity,
                               const ProgramStart& start) {
  return Program(rule, base, capacity, start).take();
}

std::vector<int64_t> bond_numbers(const IntegerProgram& program, const RuleProgram& rule,
                                  const ProgramStart& start) {
  std::vector<int64_t> all;
  if (!program.rows) return all;
  const graph::BondRows& rows = *program.rows;
  for (uint32_t i = 0; i + 1 < rows.first.size(); ++i)
    for (uint64_t b = rows.first[i]; b < rows.first[i + 1]; ++b) {
      const uint64_t of = i < rows.other[b] ? b : rows.twin(i, b);
      for (size_t f = 0; f < program.bond_field.size(); ++f) {
        const ProgramField& field = rule.bond[program.bond_field[f]];
        const graph::Interval range = program.program.bonds[f].range;
        for (uint32_t n = 0; n < field.numbers(); ++n)
          all.push_back(std::clamp<int64_t>(
              std::llround(std::ldexp(start.bond[field.first + n][of], program.bond_scales[f].frac)),
              range.low, range.high));
      }
    }
  return all;
}

}  // namespace cuboct
