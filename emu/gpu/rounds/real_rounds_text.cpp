// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/real_rounds_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "emu/gpu/rounds/rounds_limits.h"
#include "emu/gpu/rounds/scaled_graph.h"
#include "model/base/error.h"
#include "model/graph/noise.h"
#include "model/program/cubic_table.h"
#include "model/program/point_table.h"

namespace cuboct::gpu {
namespace {

std::string literal(double value, int exponent) {
  const double scaled = std::ldexp(value, -exponent);
  return std::isfinite(scaled) ? fmt::format("Real({:a})", scaled)
                               : fmt::format("Real({}1.0 / 0.0)", scaled < 0 ? "-" : "");
}
std::string times_power(const std::string& text, int exponent) {
  return exponent == 0 ? text : fmt::format("({} * {})", text, literal(1, -exponent));
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values)
    if (std::isfinite(value)) most = std::max(most, std::abs(value));
  return most;
}

// All tables, one after the other: each once.
class Tables {
 public:
  struct Place {
    size_t first, count;
  };
  Place add(const TableCurve& table) {
    const auto known = places_.find(&table);
    if (known != places_.end()) return known->second;
    Place place{entries.size(), 0};
    if (const auto* cubics = dynamic_cast<const CubicTable*>(&table))
      place.count = add_cubics(*cubics);
    else
      place.count = add_pieces(dynamic_cast<const PointTable&>(table));
    places_.emplace(&table, place);
    return place;
  }
  std::vector<std::array<double, 4>> entries;

 private:
  size_t add_cubics(const CubicTable& table) {
    const int exponent = value_exponent(table);
    for (size_t k = 0; k < table.bins(); ++k) {
      std::array<double, 4> entry{};
      for (size_t power = 0; power < 4; ++power) entry[power] = std::ldexp(table.cubic(k)[power], -exponent);
      entries.push_back(entry);
    }
    return table.bins();
  }
  size_t add_pieces(const PointTable& table) {
    const int of_value = value_exponent(table), of_argument = argument_exponent(table);
    const std::vector<CubicPiece> pieces = table.cubics().pieces();
    for (size_t k = 0; k < pieces.size(); ++k) {
      const CubicPiece& p = pieces[k];
      const double end = k + 1 < pieces.size() ? pieces[k + 1].r : table.end(), h = end - p.r;
      entries.push_back({std::ldexp(p.r, -of_argument), std::ldexp(1 / h, of_argument),
                         std::ldexp(table.end(), -of_argument), 0});
      std::array<double, 4> powers{p.c0, p.c1 * h, p.c2 * h * h, p.c3 * h * h * h};
      for (double& power : powers) power = std::ldexp(power, -of_value);
      entries.push_back(powers);
    }
    return pieces.size();
  }

  std::map<const TableCurve*, Place> places_;
};

// What a graph's values are called where the names of real_rounds_kernel.h are in sight.
class Printer {
 public:
  Printer(const ScaledGraph& graph, Tables& tables) : graph_(graph), tables_(tables) {}

  std::string name(NodeId id) const {
    const bool own = carried_ && graph_.at(id).scope == RealScope::own;
    return fmt::format("{}n{}", own ? "own." : "", id);
  }
  std::string value(NodeId id, int exponent) const {
    const ScaledNode& node = graph_.at(id);
    if (node.op == RealOp::constant) return literal(node.value, exponent);
    return times_power(name(id), node.exponent - exponent);
  }
  std::string value(NodeId id) const { return value(id, graph_.at(id).exponent); }

  // The power of the number beside its own two's power, which becomes the result's but for a factor below 2.
  std::string powered(const ScaledNode& node) const {
    const int exponent = graph_.at(node.of[0]).exponent;
    const double power = graph_.at(node.of[1]).value;
    const double left = std::exp2(exponent * power - power_exponent(exponent, power));
    const std::string text = fmt::format("pow({}, {})", value(node.of[0]), value(node.of[1], 0));
    return left == 1 ? text : fmt::format("{} * {}", text, literal(left, 0));
  }

  // Of the nodes of a scope, in their order. `carried`: those of the particle stand in `own`.
  std::string statements(RealScope scope, bool carried) {
    carried_ = carried;
    std::string text;
    for (NodeId id = 0; id < graph_.nodes.size(); ++id) {
      const ScaledNode& node = graph_.at(id);
      if (node.op == RealOp::constant || node.scope != scope) continue;
      text += fmt::format("const Real n{} = {};\n", id, expression(node));
      if (is_curve(node.op) && node.table->bounded())
        text += fmt::format("fits = fits && {} <= {};\n", value(node.of[0]),
                            literal(node.table->end(), graph_.at(node.of[0]).exponent));
    }
    return text;
  }

 private:
  std::string expression(const ScaledNode& node) const {
    const auto of = [&](size_t k) { return value(node.of[k]); };
    const auto at = [&](size_t k, int exponent) { return value(node.of[k], exponent); };
    const auto both = [&](const char* format) {
      const int e = graph_.common(node.of[0], node.of[1]);
      return fmt::format(fmt::runtime(format), at(0, e), at(1, e));
    };
    switch (node.form) {
      case RealForm::reciprocal:
        return fmt::format("1 / {}", of(0));
      case RealForm::inverse_root:
        return fmt::format("rsqrt({})", at(0, even(graph_.at(node.of[0]).exponent)));
      case RealForm::root_by_inverse:
        return fmt::format("root_by({}, {})", at(0, even(graph_.at(node.of[0]).exponent)), of(1));
      case RealForm::of_kind:
        return fmt::format("pair.kind[{}]", node.number);
      case RealForm::plain:
        break;
    }
    switch (node.op) {
      case RealOp::input:
        return input(node.input);
      case RealOp::add:
        return both("{} + {}");
      case RealOp::subtract:
        return both("{} - {}");
      case RealOp::multiply:
        return fmt::format("{} * {}", of(0), of(1));
      case RealOp::negate:
        return fmt::format("-{}", of(0));
      case RealOp::square_root:
        return fmt::format("sqrt({})", at(0, even(graph_.at(node.of[0]).exponent)));
      case RealOp::exponential:
        return fmt::format("exp({})", at(0, 0));
      case RealOp::logarithm:
        return fmt::format("log({})", at(0, 0));
      case RealOp::sine:
        return fmt::format("sin({})", at(0, 0));
      case RealOp::cosine:
        return fmt::format("cos({})", at(0, 0));
      case RealOp::error_function:
        return fmt::format("erfc({})", at(0, 0));
      case RealOp::power:
        return powered(node);
      case RealOp::absolute:
        return fmt::format("abs({})", of(0));
      case RealOp::least:  // std::min's and std::max's, of what is no number too
        return both("least_of({}, {})");
      case RealOp::most:
        return both("most_of({}, {})");
      case RealOp::below:
        return both("Real({} < {})");
      case RealOp::at_most:
        return both("Real({} <= {})");
      case RealOp::equal:
        return both("Real({} == {})");
      case RealOp::both:
        return fmt::format("Real({} != 0 && {} != 0)", of(0), of(1));
      case RealOp::either:
        return fmt::format("Real({} != 0 || {} != 0)", of(0), of(1));
      case RealOp::inverse:
        return fmt::format("Real({} == 0)", of(0));
      case RealOp::select:
        return fmt::format("{} != 0 ? {} : {}", of(0), at(1, node.exponent), at(2, node.exponent));
      case RealOp::curve:
      case RealOp::curve_slope:
        return curve(node);
      case RealOp::divide:
      case RealOp::constant:
        break;
    }
    return {};
  }
  std::string curve(const ScaledNode& node) const {
    const bool slope = node.op == RealOp::curve_slope;
    const Tables::Place place = tables_.add(*node.table);
    if (const auto* cubics = dynamic_cast<const CubicTable*>(node.table)) {
      const int exponent = graph_.at(node.of[0]).exponent;
      const std::string steps =
          fmt::format("{} * {}", value(node.of[0]), literal(1 / cubics->step(), -exponent));
      const std::string text = fmt::format("cubic_{}(at.tables + {}, {}, {})", slope ? "slope" : "value",
                                           place.first, place.count, steps);
      return slope
                 ? fmt::format("{} * {}", text, literal(1 / cubics->step(), -argument_exponent(*node.table)))
                 : text;
    }
    return fmt::format("piece_value(at.tables + {}, {}, {}, {})", place.first, place.count,
                       value(node.of[0], argument_exponent(*node.table)), slope);
  }
  static std::string input(const RealInput& input) {
    const uint32_t k = input.index;
    switch (input.source) {
      case RealSource::difference:
        return fmt::format("pair.d[{}]", k);
      case RealSource::own_velocity:
        return fmt::format("at.v[i].at[{}]", k);
      case RealSource::other_velocity:
        return fmt::format("at.v[pair.j].at[{}]", k);
      case RealSource::own_mass:
        return "at.types[at.type[i]].mass";
      case RealSource::other_mass:
        return "at.types[pair.other_type].mass";
      case RealSource::own_element:
        return "at.types[at.type[i]].element";
      case RealSource::other_element:
        return "at.types[pair.other_type].element";
      case RealSource::own_field:
        return fmt::format("at.fields[{}][i]", k);
      case RealSource::other_field:
        return fmt::format("at.fields[{}][pair.j]", k);
      case RealSource::bond_field:
        return fmt::format("at.bonds[{}][pair.slot]", k);
      case RealSource::position:
        return fmt::format("at.origin[{0}] + static_cast<Real>(at.x[{0}][i]) * at.x_unit[{0}]", k);
      case RealSource::sum:
        return fmt::format("sums[{}]", k);
      case RealSource::made:
        return "at.made()";
      case RealSource::noise:
        return fmt::format("at.noise({}, at.id[i], at.id[other]) * {}", k, literal(graph::kNoiseUnit, 0));
      case RealSource::own_region:
      case RealSource::other_region:  // of starts, which the host works out
        break;
      case RealSource::packed:
      case RealSource::time_step:
        break;
    }
    return {};
  }

  const ScaledGraph& graph_;
  Tables& tables_;
  bool carried_ = false;
};

class Rounds {
 public:
  Rounds(const RuleProgram& program, const Rule& rule, const ProgramStart& start, const RealBondKinds& kinds,
         const RealTextOptions& options)
      : program_(program), rule_(rule), kinds_(kinds), options_(options), written_(written_bonds(program)) {
    RealExponents& e = text_.exponents;
    e.length = exponent_of(program.reach), e.time = exponent_of(rule.dt);
    e.velocity = e.length - e.time, e.mass = exponent_of(rule.mass);
    field_ = sizes(program.particle, start.particle);
    bond_ = sizes(program.bond, start.bond);
    for (const ParticleType& type : rule.types)
      masses_.push_back(rule.mass_of(static_cast<int>(&type - rule.types.data())));
  }

  RealRoundsText text() {
    text_.source = fmt::format(
        "#define CUBOCT_ROUNDS_ALONE\n"
        "#include \"emu/gpu/rounds/real_rounds_kernel.h\"\n"
        "namespace cuboct::gpu {{\n"
        "using Real = {};\n"
        "using RoundsFrame = RealFrame<Real, {}>;\n"
        "static_assert(sizeof(RoundsFrame) == {});\n",
        options_.doubles ? "double" : "float", options_.wide ? "uint64_t" : "uint32_t", options_.frame_bytes);
    std::string kernels;
    for (size_t k = 0; k < program_.rounds.size(); ++k) {
      text_.source += round(k);
      text_.names.push_back(fmt::format("round_{}", k));
      kernels += fmt::format("CUBOCT_REAL_ROUND({}, cuboct::gpu::Round{})\n", text_.names.back(), k);
    }
    text_.source += "}  // namespace cuboct::gpu\n" + kernels;
    text_.tables = std::move(tables_.entries);
    const auto all = [](const std::vector<std::optional<int>>& of) {
      std::vector<int> exponents;
      for (const std::optional<int>& e : of) exponents.push_back(e.value_or(0));
      return exponents;
    };
    text_.exponents.field = all(field_), text_.exponents.bond = all(bond_);
    return std::move(text_);
  }

 private:
  // Of what a field begins with, or may become; else of what first writes it.
  static std::vector<std::optional<int>> sizes(const std::vector<ProgramField>& fields,
                                               const std::vector<std::vector<double>>& values) {
    std::vector<std::optional<int>> exponents;
    for (const ProgramField& field : fields)
      for (uint32_t k = 0; k < field.numbers(); ++k) {
        exponents.emplace_back();
        if (const double most = largest(values[field.first + k]); most > 0)
          exponents.back() = exponent_of(most);
        else if (field.range)
          exponents.back() =
              exponent_of(std::max(std::abs(field.range->first), std::abs(field.range->second)));
      }
    return exponents;
  }

  std::optional<double> constant(const RealInput& input) const {
    const auto alike = [](const std::vector<double>& of) -> std::optional<double> {
      if (std::ranges::any_of(of, [&](double value) { return value != of.front(); })) return std::nullopt;
      return of.front();
    };
    switch (input.source) {
      case RealSource::time_step:
        return rule_.dt;
      case RealSource::own_mass:
      case RealSource::other_mass:
        return alike(masses_);
      case RealSource::own_element:
      case RealSource::other_element:
        return program_.element.empty() ? 1 : alike(program_.element);
      default:
        return std::nullopt;
    }
  }
  // What is read before anything tells its size stands as it is, and is written so, too.
  static int settled(std::optional<int>& exponent) {
    if (!exponent) exponent = 0;
    return *exponent;
  }
  int exponent(const RealInput& input) {
    const RealExponents& e = text_.exponents;
    switch (input.source) {
      case RealSource::difference:
      case RealSource::packed:
      case RealSource::position:
        return e.length;
      case RealSource::own_velocity:
      case RealSource::other_velocity:
        return e.velocity;
      case RealSource::own_mass:
      case RealSource::other_mass:
        return e.mass;
      case RealSource::own_field:
      case RealSource::other_field:
        return settled(field_[input.index]);
      case RealSource::bond_field:
        return settled(bond_[input.index]);
      case RealSource::sum:
        return sum_[input.index];
      default:
        return 0;
    }
  }
  // Of the pair's graph.
  RealScope scope(const RealInput& input) const {
    switch (input.source) {
      case RealSource::packed:
        return RealScope::kind;
      case RealSource::bond_field:
        return written_[input.index] ? RealScope::pair : RealScope::kind;
      case RealSource::own_velocity:
      case RealSource::own_mass:
      case RealSource::own_element:
      case RealSource::own_field:
        return RealScope::own;
      default:
        return RealScope::pair;
    }
  }

  // [node][kind] of the values that never change of a bond.
  std::vector<std::vector<double>> values_of_kinds(const RealGraph& graph) const {
    std::vector<std::vector<double>> values(graph.nodes().size(), std::vector<double>(kinds_.packed.size()));
    for (size_t kind = 0; kind < kinds_.packed.size(); ++kind)
      for (NodeId id = 0; id < values.size(); ++id) {
        const RealNode& node = graph.at(id);
        double& value = values[id][kind];
        if (node.op == RealOp::constant) {
          value = node.value;
        } else if (node.op == RealOp::input) {
          if (node.input.source == RealSource::packed)
            value = kinds_.packed[kind][node.input.index];
          else if (node.input.source == RealSource::bond_field && !written_[node.input.index])
            value = kinds_.field[node.input.index][kind];
          else
            value = constant(node.input).value_or(0);
        } else {
          const auto of = [&](size_t k) { return values[node.of[k]][kind]; };
          value = applied(node, of(0), arity(node.op) > 1 ? of(1) : 0, arity(node.op) > 2 ? of(2) : 0);
        }
      }
    return values;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(what, "engine reference runs it").about({"rule.file", "rule"});
  }
  void once(std::vector<bool>& made, uint32_t number, const std::vector<ProgramField>& fields) const {
    if (made.size() <= number) made.resize(number + 1);
    if (made[number])
      for (const ProgramField& field : fields)
        if (number >= field.first && number < field.first + field.numbers())
          refuse(fmt::format("two rounds make '{}': the gpu engine has it made once a step", field.name));
    made[number] = true;
  }
  bool is_force(uint32_t number) const { return !program_.still && number >= program_.force; }

  std::string round(size_t k) {
    const ProgramRound& round = program_.rounds[k];
    const bool last = k + 1 == program_.rounds.size();
    if (round.terms.size() > kMostNumbers || program_.particle_numbers > kMostNumbers ||
        program_.bond_numbers > kMostBondNumbers)
      refuse(fmt::format("round '{}' has more numbers than a thread of the gpu engine has room for",
                         round.name));
    const std::string pair = pair_text(round), finish = finish_text(round, last);
    return fmt::format(
        "struct Round{} {{\n"
        "using Frame = RoundsFrame;\n"
        "static constexpr bool kBonded = {}, kMoves = {};\n"
        "static constexpr int kSums = {}, kOfKind = {};\n"
        "{}{}}};\n",
        k, program_.declaration.bonds == BondRange::reference, last && !program_.still,
        std::max<size_t>(round.terms.size(), 1),
        text_.kinds.back().empty() ? 0 : text_.kinds.back()[0].size(), pair, finish);
  }

  std::string pair_text(const ProgramRound& round) {
    std::vector<NodeId> outputs = round.terms;
    outputs.insert(outputs.end(), round.when.begin(), round.when.end());
    for (const ProgramWrite& write : round.bonds) outputs.push_back(write.node);
    const std::vector<std::vector<double>> of_kinds = values_of_kinds(round.pair);
    const ScaledGraph graph = scaled(
        round.pair, outputs,
        {[this](const RealInput& i) { return constant(i); }, [this](const RealInput& i) { return scope(i); },
         [this](const RealInput& i) { return exponent(i); },
         [&](NodeId id) { return exponent_of(largest(of_kinds[id])); }});
    keep_kinds(graph, of_kinds);
    Printer printer(graph, tables_);
    const std::string begin = printer.statements(RealScope::own, false);
    std::string members, carried;
    for (NodeId id = 0; id < graph.nodes.size(); ++id)
      if (const ScaledNode& node = graph.at(id);
          node.scope == RealScope::own && node.op != RealOp::constant) {
        members += fmt::format("Real n{};\n", id);
        carried += fmt::format("own.n{0} = n{0};\n", id);
      }
    std::string text = printer.statements(RealScope::pair, true);
    const size_t terms = round.terms.size();
    sum_.clear();
    for (size_t n = 0; n < terms; ++n) {
      const NodeId term = graph.outputs[n], when = graph.outputs[terms + n];
      sum_.push_back(graph.at(term).exponent);
      const bool always = graph.at(when).op == RealOp::constant && graph.at(when).value != 0;
      text += always ? fmt::format("sums[{}] += {};\n", n, printer.value(term))
                     : fmt::format("sums[{}] += {} != 0 ? {} : Real(0);\n", n, printer.value(when),
                                   printer.value(term));
    }
    for (size_t n = 0; n < round.bonds.size(); ++n) {
      const NodeId node = graph.outputs[2 * terms + n];
      const uint32_t number = round.bonds[n].number;
      once(bonds_made_, number, program_.bond);
      if (!bond_[number]) bond_[number] = graph.at(node).exponent;
      text += fmt::format("at.to_bonds[{}][pair.slot] = {};\n", number, printer.value(node, *bond_[number]));
    }
    return fmt::format(
        "struct Own {{\n{}}};\n"
        "CUBOCT_DEVICE static void begin(const Frame& at, uint32_t i, Own& own, bool& fits) {{\n{}{}}}\n"
        "CUBOCT_DEVICE static void pair(const Frame& at, uint32_t i, const Own& own, const RealPair<Real>& "
        "pair, "
        "Real (&sums)[kSums], bool& fits) {{\nconst uint32_t other = pair.j;\n{}}}\n",
        members, begin, carried, text);
  }
  void keep_kinds(const ScaledGraph& graph, const std::vector<std::vector<double>>& values) {
    std::vector<std::vector<double>>& kinds = text_.kinds.emplace_back(kinds_.packed.size());
    for (size_t kind = 0; kind < kinds.size(); ++kind)
      for (const NodeId id : graph.of_kind)
        kinds[kind].push_back(std::ldexp(values[id][kind], -exponent_of(largest(values[id]))));
  }

  std::string finish_text(const ProgramRound& round, bool last) {
    std::vector<NodeId> outputs;
    for (const ProgramWrite& write : round.made) outputs.push_back(write.node);
    const ScaledGraph graph = scaled(
        round.finish, outputs,
        {[this](const RealInput& i) { return constant(i); }, [](const RealInput&) { return RealScope::own; },
         [this](const RealInput& i) { return exponent(i); }, [](NodeId) { return 0; }});
    Printer printer(graph, tables_);
    std::string text = printer.statements(RealScope::own, false);
    const auto is_zero = [&](NodeId id) {
      return graph.at(id).op == RealOp::constant && graph.at(id).value == 0;
    };
    std::optional<int> of_force;
    for (size_t n = 0; n < outputs.size(); ++n)
      if (last && is_force(round.made[n].number) && !is_zero(graph.outputs[n]))
        of_force = std::max(of_force.value_or(graph.at(graph.outputs[n]).exponent),
                            graph.at(graph.outputs[n]).exponent);
    text_.exponents.force = of_force.value_or(0);
    for (size_t n = 0; n < outputs.size(); ++n) {
      const uint32_t number = round.made[n].number;
      const NodeId node = graph.outputs[n];
      if (is_force(number)) {  // that of an earlier round moves nothing
        if (last)
          text += fmt::format("force[{}] = {};\n", number - program_.force,
                              printer.value(node, text_.exponents.force));
        continue;
      }
      once(made_, number, program_.particle);
      if (!field_[number] && !is_zero(node)) field_[number] = graph.at(node).exponent;
      text +=
          fmt::format("at.to_fields[{}][i] = {};\n", number, printer.value(node, field_[number].value_or(0)));
    }
    return fmt::format(
        "CUBOCT_DEVICE static void finish(const Frame& at, uint32_t i, const Real (&sums)[kSums], "
        "Real (&force)[3], bool& fits) {{\nconst uint32_t other = i;\n{}}}\n",
        text);
  }

  const RuleProgram& program_;
  const Rule& rule_;
  const RealBondKinds& kinds_;
  const RealTextOptions options_;
  const std::vector<bool> written_;
  std::vector<double> masses_;
  std::vector<std::optional<int>> field_, bond_;
  std::vector<int> sum_;  // of the round at hand
  std::vector<bool> made_, bonds_made_;
  Tables tables_;
  RealRoundsText text_;
};

}  // namespace

std::vector<bool> written_bonds(const RuleProgram& program) {
  std::vector<bool> written(program.bond_numbers);
  for (const ProgramRound& round : program.rounds)
    for (const ProgramWrite& write : round.bonds) written[write.number] = true;
  return written;
}

RealBondKinds bond_kinds_of(const RuleProgram& program, const ProgramStart& start) {
  // Below it two numbers are one: coordinates of a packing are rounded.
  constexpr double kGrain = 1e-12;
  const std::vector<bool> written = written_bonds(program);
  std::vector<double> grain;
  for (const std::vector<double>& values : start.bond)
    grain.push_back(kGrain * std::max(largest(values), 1e-300));
  RealBondKinds kinds;
  kinds.field.resize(start.bond.size());
  std::map<std::vector<int64_t>, uint32_t> known;
  std::vector<int64_t> key;
  for (size_t b = 0; b < start.rows.vector.size(); ++b) {
    key.clear();
    for (const double along : start.rows.vector[b])
      key.push_back(std::llround(along / (kGrain * program.reach)));
    for (size_t n = 0; n < start.bond.size(); ++n)
      if (!written[n]) key.push_back(std::llround(start.bond[n][b] / grain[n]));
    const auto [at, fresh] = known.try_emplace(key, static_cast<uint32_t>(kinds.packed.size()));
    kinds.of.push_back(at->second);
    if (!fresh) continue;
    kinds.packed.push_back(start.rows.vector[b]);
    for (size_t n = 0; n < start.bond.size(); ++n)
      if (!written[n]) kinds.field[n].push_back(start.bond[n][b]);
  }
  return kinds;
}

RealRoundsText real_text_of(const RuleProgram& program, const Rule& rule, const ProgramStart& start,
                            const RealBondKinds& kinds, const RealTextOptions& options) {
  return Rounds(program, rule, start, kinds, options).text();
}

}  // namespace cuboct::gpu
