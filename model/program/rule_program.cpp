// SPDX-License-Identifier: MIT
#include "model/program/rule_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace cuboct {
namespace {

using Kind = Value::Kind;
using Source = RealSource;

constexpr Dimension kEnergy = quantity::energy.dimension;
constexpr const char* kReserved[] = {"d",     "r",         "d0",     "r0",       "v",        "x",
                                     "mass",  "dt",        "pi",     "true",     "false",    "pitch",
                                     "reach", kForceField, "volume", "position", "velocity", "id"};

constexpr const char* kOfPotential[] = {"pair",      "cutoff",      "lattice_constant",
                                        "density",   "density_i",   "density_j",
                                        "embedding", "embedding_i", "embedding_j"};

int numbers_in(Kind kind) { return kind == Kind::vector ? 3 : 1; }

class Understanding {
 public:
  Understanding(const RuleText& text, const ProgramPlace& place) : text_(text), place_(place) {}

  RuleProgram program() {
    program_.still = text_.still;
    program_.potential = text_.potential;
    name_fields();
    constants();
    starts();
    for (const RuleText::Round& round : text_.setup) program_.setup.push_back(round_of(round, true));
    for (const RuleText::Round& round : text_.rounds) program_.rounds.push_back(round_of(round, false));
    mark_kept();
    energies();
    declare();
    return std::move(program_);
  }

 private:
  void name_fields() {
    std::set<std::string> names(std::begin(kReserved), std::end(kReserved));
    for (const auto& [name, parameter] : text_.parameters) names.insert(name);
    for (const auto& [name, let] : text_.lets) names.insert(name);
    for (const RuleText::Table& table : text_.tables)
      if (!names.insert(table.name).second || is_function(table.name) ||
          (text_.potential && std::ranges::count(kOfPotential, table.name) > 0))
        table.fail(fmt::format("the name '{}' is taken", table.name), {});
    const auto add = [&](const std::vector<RuleText::Field>& from, std::vector<ProgramField>& to,
                         uint32_t& numbers) {
      for (const RuleText::Field& field : from) {
        if (!names.insert(field.name).second)
          field.fail(fmt::format("the name '{}' is taken", field.name), {});
        to.push_back({field.name, field.kind, numbers, false, field.shown, field.range, field.resolution});
        numbers += to.back().numbers();
      }
    };
    add(text_.particle, program_.particle, program_.particle_numbers);
    add(text_.bond, program_.bond, program_.bond_numbers);
    if (text_.still) return;
    program_.force = program_.particle_numbers;
    program_.particle.push_back(
        {.name = kForceField, .kind = Kind::vector, .first = program_.force, .shown = false});
    program_.particle_numbers += 3;
  }

  // Names that mean the same everywhere.
  void define_constants(Scope& scope) const {
    for (const auto& [name, p] : text_.parameters) scope.define_constant(name, p.value, p.dimension);
    scope.define_constant("pi", std::numbers::pi, {});
    for (const bool truth : {false, true})
      scope.define(truth ? "true" : "false", [&scope, truth] {
        return Value{Kind::truth, {}, {scope.graph().constant(truth ? 1 : 0), 0, 0}};
      });
    if (place_.pitch > 0) {
      scope.define_constant("pitch", place_.pitch, quantity::length.dimension);
      scope.define_constant("volume", std::pow(place_.pitch, 3) / std::numbers::sqrt2, {{0, 3, 0, 0}});
    }
    if (program_.reach > 0) scope.define_constant("reach", program_.reach, quantity::length.dimension);
    scope.define_lets(text_.lets);
    for (size_t k = 0; k < program_.tables.size(); ++k) define_table(scope, k);
    if (text_.potential) define_potential(scope);
  }
  void define_table(Scope& scope, size_t k) const {
    scope.define_function(text_.tables[k].name,
                          {table_of_[k].first, table_of_[k].second,
                           [&scope, &table = *program_.tables[k]](NodeId at, bool slope) {
                             return scope.graph().curve(table, at, slope);
                           }});
  }
  // Where there is one element, its functions mean the same everywhere.
  void define_potential(Scope& scope) const {
    const EmbeddedAtoms& potential = *text_.potential;
    scope.define_constant("cutoff", potential.cutoff, quantity::length.dimension);
    if (potential.lattice_constant > 0)
      scope.define_constant("lattice_constant", potential.lattice_constant, quantity::length.dimension);
    if (potential.elements.size() > 1) {
      for (const char* name : {"density", "embedding", "pair"}) refuse_element(scope, name);
      return;
    }
    for (const char* suffix : {"", "_i", "_j"}) define_element(scope, suffix, Source::own_element);
    define_between(scope);
  }
  static void refuse_element(Scope& scope, const std::string& name) {
    scope.define_function(
        name,
        {name == "embedding" ? Dimension{} : quantity::length.dimension, {}, [name](NodeId, bool) -> NodeId {
           throw FormulaError{0, fmt::format("'{}' of which element? The potential has several", name),
                              "density_i, density_j and pair in pair terms, density and embedding in a "
                              "finish; formulas without particles have none"};
         }});
  }
  // Functions of the element of the particle that `element` tells.
  void define_element(Scope& scope, const std::string& suffix, Source element) const {
    const EmbeddedAtoms& potential = *text_.potential;
    const auto of = [&scope, element](const std::vector<EmbeddedAtoms::Table>& tables) {
      return [&scope, element, &tables](NodeId at, bool of_slope) {
        return chosen(scope.graph(), tables, element, at, of_slope);
      };
    };
    scope.define_function("density" + suffix, {quantity::length.dimension, {}, of(potential.density)});
    scope.define_function("embedding" + suffix, {{}, kEnergy, of(potential.embedding)});
  }
  static NodeId chosen(RealGraph& graph, const std::vector<EmbeddedAtoms::Table>& tables, Source element,
                       NodeId at, bool of_slope) {
    NodeId value = graph.curve(*tables.back(), at, of_slope);
    for (size_t k = tables.size() - 1; k-- > 0;) {
      const NodeId code = graph.constant(std::ldexp(1.0, static_cast<int>(k)));
      const NodeId is = graph.add(RealOp::equal, graph.input(element), code);
      value = graph.add(RealOp::select, is, graph.curve(*tables[k], at, of_slope), value);
    }
    return value;
  }
  // Both particles' codes add up to a number that no other two elements have, and that is the same from both
  // ends.
  void define_between(Scope& scope) const {
    scope.define_function("pair", {quantity::length.dimension, kEnergy, [this, &scope](NodeId r, bool slope) {
                                     return between(scope.graph(), r, slope);
                                   }});
  }
  NodeId between(RealGraph& graph, NodeId r, bool of_slope) const {
    const EmbeddedAtoms& potential = *text_.potential;
    const size_t count = potential.elements.size();
    NodeId value = pair_of(graph, *potential.pair.back(), r, of_slope);
    if (count == 1) return value;
    const NodeId other = graph.input(Source::other_element), own = graph.input(Source::own_element);
    const NodeId both = graph.add(RealOp::add, own, other);
    for (size_t i = 0; i + 1 < count; ++i)
      for (size_t j = i; j < count; ++j) {
        const double code = std::ldexp(1.0, static_cast<int>(i)) + std::ldexp(1.0, static_cast<int>(j));
        const NodeId here = pair_of(graph, *potential.pair[i * count + j], r, of_slope);
        value = graph.add(RealOp::select, graph.add(RealOp::equal, both, graph.constant(code)), here, value);
      }
    return value;
  }
  // The file has r times the energy of a pair.
  static NodeId pair_of(RealGraph& graph, const CubicTable& table, NodeId r, bool of_slope) {
    const NodeId energy = graph.add(RealOp::divide, graph.curve(table, r, false), r);
    if (!of_slope) return energy;
    const NodeId rise = graph.add(RealOp::subtract, graph.curve(table, r, true), energy);
    return graph.add(RealOp::divide, rise, r);
  }
  void check_reach() const {
    if (text_.potential && program_.reach > text_.potential->cutoff * (1 + 1e-9))
      text_.reach->fail({0,
                         fmt::format("'reach' is {:.6g}, beyond the cutoff of the potential's tables, {:.6g}",
                                     program_.reach, text_.potential->cutoff),
                         "reach = \"cutoff\""});
  }
  double constant(const std::optional<Formula>& formula, const std::string& what,
                  const Dimension& dimension) {
    if (!formula) return 0;
    RealGraph graph;
    Scope scope(graph, text_.units);
    define_constants(scope);
    const Value value = scope.value_of(*formula, what, Kind::number, dimension);
    const double number = graph.at(value.node[0]).value;
    if (!(number > 0) || !std::isfinite(number))
      formula->fail({0, fmt::format("{} must be positive, not {}", what, number), {}});
    return number;
  }
  void constants() {
    program_.reach = constant(text_.reach, "'reach'", quantity::length.dimension);
    check_reach();
    program_.core = constant(text_.core, "'core'", quantity::length.dimension);
    for (const RuleText::Table& table : text_.tables) add_table(table);
    program_.stiffness = constant(text_.stiffness, "'stiffness'", quantity::stiffness.dimension);
  }

  // A table's numbers, and of what they are: a zero may be of anything.
  std::pair<std::vector<double>, Dimension> column(const std::vector<Formula>& formulas) const {
    std::vector<double> numbers;
    std::optional<Dimension> dimension;
    for (const Formula& formula : formulas) {
      RealGraph graph;
      Scope scope(graph, text_.units);
      define_constants(scope);
      const Value value = scope.value_of(formula);
      if (value.kind != Kind::number) formula.fail({0, "a table holds numbers", {}});
      const RealNode& node = graph.at(value.node[0]);
      if (node.op != RealOp::constant || !std::isfinite(node.value))
        formula.fail({0, "a table holds finite constants", {}});
      numbers.push_back(node.value);
      if (node.value == 0 && value.dimension == Dimension{}) continue;
      if (dimension && text_.units && *dimension != value.dimension)
        formula.fail({0,
                      fmt::format("this is {}, and what stands before it {}", describe(value.dimension),
                                  describe(*dimension)),
                      {}});
      dimension = value.dimension;
    }
    return {numbers, dimension.value_or(Dimension{})};
  }
  void add_table(const RuleText::Table& table) {
    auto [at, argument] = column(table.at);
    auto [values, dimension] = column(table.value);
    for (size_t k = 1; k < at.size(); ++k)
      if (!(at[k] > at[k - 1]))
        table.at[k].fail({0, fmt::format("'at' must ascend, but point {} does not", k + 1), {}});
    std::vector<double> slopes = monotone_slopes(at, values);
    if (!table.slope.empty()) {
      auto [given, of] = column(table.slope);
      Dimension wanted = dimension;
      for (size_t k = 0; k < wanted.exponent.size(); ++k) wanted.exponent[k] -= argument.exponent[k];
      const bool zeros = std::ranges::all_of(given, [](double slope) { return slope == 0; });
      if (text_.units && !zeros && of != wanted)
        table.slope[0].fail(
            {0, fmt::format("a slope must be {}, not {}", describe(wanted), describe(of)), {}});
      slopes = given;
    }
    table_of_.emplace_back(argument, dimension);
    program_.tables.push_back(
        std::make_shared<const PointTable>(table.name, Hermite(at, std::move(values), std::move(slopes))));
  }

  void define_field(Scope& scope, const std::string& name, Source source, const ProgramField& field,
                    const Dimension& dimension) const {
    if (field.kind == Kind::vector)
      scope.define_vector(name, source, field.first, dimension);
    else
      scope.define_number(name, source, field.first, dimension, field.kind);
  }
  Dimension dimension_of(size_t field) const {
    return field < text_.particle.size() ? text_.particle[field].dimension : quantity::force.dimension;
  }
  // A particle's fields, `before` the field itself, as starts may use those before them.
  void define_particle(Scope& scope, Source source, const std::string& suffix, size_t before) const {
    for (size_t k = 0; k < before; ++k)
      define_field(scope, program_.particle[k].name + suffix, source, program_.particle[k], dimension_of(k));
  }
  void define_pair(Scope& scope) const {
    const Dimension length = quantity::length.dimension, mass = quantity::mass.dimension;
    const auto with_norm = [&](const char* vector, const char* norm, Source source) {
      scope.define_vector(vector, source, 0, length);
      scope.define(norm, [&scope, length, source] {
        RealGraph& graph = scope.graph();
        NodeId sum = 0;
        for (uint32_t k = 0; k < 3; ++k) {
          const NodeId part = graph.input(source, k), square = graph.add(RealOp::multiply, part, part);
          sum = k == 0 ? square : graph.add(RealOp::add, sum, square);
        }
        return Value{Kind::number, length, {graph.add(RealOp::square_root, sum), 0, 0}};
      });
    };
    with_norm("d", "r", Source::difference);
    if (text_.range == BondRange::reference) with_norm("d0", "r0", Source::packed);
    scope.define_vector("v_i", Source::own_velocity, 0, quantity::velocity.dimension);
    scope.define_vector("v_j", Source::other_velocity, 0, quantity::velocity.dimension);
    scope.define_number("mass_i", Source::own_mass, 0, mass);
    scope.define_number("mass_j", Source::other_mass, 0, mass);
    scope.define_number("dt", Source::time_step, 0, quantity::time.dimension);
    if (!alloy()) return;
    define_element(scope, "_i", Source::own_element);
    define_element(scope, "_j", Source::other_element);
    define_between(scope);
  }
  bool alloy() const { return text_.potential && text_.potential->elements.size() > 1; }
  void define_bonds(Scope& scope, size_t before) const {
    for (size_t k = 0; k < before; ++k)
      define_field(scope, program_.bond[k].name, Source::bond_field, program_.bond[k],
                   text_.bond[k].dimension);
  }
  // All that a formula of a particle and one of its bonds may use.
  void define_bond_terms(Scope& scope) const {
    define_constants(scope);
    define_pair(scope);
    define_particle(scope, Source::own_field, "_i", text_.particle.size());
    define_particle(scope, Source::other_field, "_j", text_.particle.size());
    define_bonds(scope, program_.bond.size());
  }
  void define_finish(Scope& scope) const {
    scope.define_vector("v", Source::own_velocity, 0, quantity::velocity.dimension);
    scope.define_vector("x", Source::position, 0, quantity::length.dimension);
    scope.define_number("mass", Source::own_mass, 0, quantity::mass.dimension);
    scope.define_number("dt", Source::time_step, 0, quantity::time.dimension);
    define_particle(scope, Source::own_field, "", text_.particle.size());
    if (alloy()) define_element(scope, "", Source::own_element);
  }

  void starts() {
    for (size_t k = 0; k < text_.particle.size(); ++k) {
      const RuleText::Field& field = text_.particle[k];
      Scope scope(program_.start, text_.units);
      define_constants(scope);
      scope.allow_noise();
      scope.define_vector("x", Source::position, 0, quantity::length.dimension);
      scope.define_vector("v", Source::own_velocity, 0, quantity::velocity.dimension);
      scope.define_number("mass", Source::own_mass, 0, quantity::mass.dimension);
      scope.define_inside("inside", Source::own_region, place_.regions);
      define_particle(scope, Source::own_field, "", k);
      program_.particle[k].start = start_of(field, scope);
    }
    for (size_t k = 0; k < text_.bond.size(); ++k) {
      Scope scope(program_.bond_start, text_.units);
      define_constants(scope);
      scope.allow_noise();
      define_pair(scope);
      define_particle(scope, Source::own_field, "_i", text_.particle.size());
      define_particle(scope, Source::other_field, "_j", text_.particle.size());
      scope.define_vector("x_i", Source::position, 0, quantity::length.dimension);
      scope.define_inside("inside_i", Source::own_region, place_.regions);
      scope.define_inside("inside_j", Source::other_region, place_.regions);
      define_bonds(scope, k);
      program_.bond[k].start = start_of(text_.bond[k], scope);
    }
  }
  static std::vector<NodeId> start_of(const RuleText::Field& field, Scope& scope) {
    if (!field.start) return std::vector<NodeId>(numbers_in(field.kind), scope.graph().constant(0));
    const Value value = scope.value_of(*field.start, fmt::format("the start of '{}'", field.name), field.kind,
                                       field.dimension);
    return {value.node.begin(), value.node.begin() + numbers_in(field.kind)};
  }

  struct SumValue {
    std::string name;
    Value value;
    uint32_t first;
  };
  ProgramRound round_of(const RuleText::Round& from, bool setup) {
    ProgramRound round;
    round.name = from.name;
    Scope pair(round.pair, text_.units);
    define_bond_terms(pair);
    pair.allow_noise();
    for (const RuleText::Write& write : from.bonds) write_bond(write, pair, round);
    std::vector<SumValue> sums;
    for (const RuleText::Sum& sum : from.sums) sums.push_back(sum_of(sum, pair, round));
    Scope finish(round.finish, text_.units);
    define_constants(finish);
    define_finish(finish);
    finish.allow_noise();
    for (const SumValue& sum : sums) {
      if (sum.value.kind == Kind::vector)
        finish.define_vector(sum.name, Source::sum, sum.first, sum.value.dimension);
      else
        finish.define_number(sum.name, Source::sum, sum.first, sum.value.dimension);
      names_.insert(sum.name);
    }
    for (const RuleText::Write& write : from.finishes) write_particle(write, finish, round);
    if (!setup && &from == &text_.rounds.back()) end_with_force(from, sums, finish, round);
    declare_round(from, sums, setup);
    return round;
  }
  void write_bond(const RuleText::Write& write, Scope& scope, ProgramRound& round) {
    const auto at = std::ranges::find(program_.bond, write.name, &ProgramField::name);
    if (at == program_.bond.end())
      write.is.fail({0, fmt::format("no bond has a field '{}'", write.name), "[bond.NAME] declares one"});
    const Dimension dimension = text_.bond[static_cast<size_t>(at - program_.bond.begin())].dimension;
    Value value = scope.value_of(write.is, fmt::format("bond '{}'", write.name), at->kind, dimension);
    // A look leaves bonds as the last step left them.
    const NodeId made = round.pair.input(Source::made);
    for (uint32_t k = 0; k < at->numbers(); ++k) {
      const NodeId before = round.pair.input(Source::bond_field, at->first + k);
      value.node[k] = round.pair.add(RealOp::select, made, value.node[k], before);
      round.bonds.push_back({at->first + k, value.node[k]});
    }
    scope.define(write.name, [value] { return value; });
    at->kept = true;
  }
  SumValue sum_of(const RuleText::Sum& sum, Scope& scope, ProgramRound& round) {
    const Value value = scope.value_of(sum.is);
    const auto is_field = [&](const ProgramField& field) {
      return field.name == sum.name && field.name != kForceField;
    };
    if (std::ranges::any_of(program_.particle, is_field) || names_.count(sum.name) > 0)
      sum.is.fail({0, fmt::format("the name '{}' is taken", sum.name), {}});
    NodeId when = round.pair.constant(1);
    if (sum.when)
      when = scope.value_of(*sum.when, fmt::format("the 'when' of '{}'", sum.name), Kind::truth, {}).node[0];
    const SumValue of{sum.name, value, static_cast<uint32_t>(round.terms.size())};
    for (int k = 0; k < numbers_in(value.kind); ++k) {
      round.terms.push_back(value.node[static_cast<size_t>(k)]);
      round.when.push_back(when);
    }
    return of;
  }
  void write_particle(const RuleText::Write& write, Scope& scope, ProgramRound& round) {
    const auto at = std::ranges::find(program_.particle, write.name, &ProgramField::name);
    if (at == program_.particle.end())
      write.is.fail(
          {0, fmt::format("no particle has a field '{}'", write.name),
           write.name == kForceField ? "'still = true' lets none move" : "[particle.NAME] declares one"});
    const Value value = scope.value_of(write.is, fmt::format("'{}'", write.name), at->kind,
                                       dimension_of(static_cast<size_t>(at - program_.particle.begin())));
    for (uint32_t k = 0; k < at->numbers(); ++k) round.made.push_back({at->first + k, value.node[k]});
  }
  // The last round's sum 'force' is the force, unless its finish says otherwise.
  void end_with_force(const RuleText::Round& from, const std::vector<SumValue>& sums, Scope& finish,
                      ProgramRound& round) {
    const auto sum = std::ranges::find(sums, kForceField, &SumValue::name);
    if (text_.still) {
      if (sum != sums.end()) from.fail("a force moves nothing where 'still = true'", {});
      return;
    }
    const bool written = std::ranges::any_of(
        round.made, [&](const ProgramWrite& write) { return write.number == program_.force; });
    if (written) return;
    if (sum == sums.end())
      from.fail("the last round makes no force",
                "a sum 'force', or finish.force; 'still = true' for a rule that moves nothing");
    if (sum->value.kind != Kind::vector || (text_.units && sum->value.dimension != quantity::force.dimension))
      from.fail(fmt::format("the sum 'force' must be a vector of newtons, not of {}",
                            describe(sum->value.dimension)),
                {});
    for (uint32_t k = 0; k < 3; ++k)
      round.made.push_back({program_.force + k, finish.graph().input(Source::sum, sum->first + k)});
  }
  bool reads(const RealGraph& graph, const ProgramField& field, Source source) const {
    return std::ranges::any_of(graph.nodes(), [&](const RealNode& node) {
      return node.op == RealOp::input && node.input.source == source && node.input.index >= field.first &&
             node.input.index < field.first + field.numbers();
    });
  }
  // A field goes on from step to step where a round reads what the step before made.
  void mark_kept() {
    for (ProgramField& field : program_.particle) {
      bool read = false, made = false;
      for (const ProgramRound& round : program_.rounds) {
        const bool reads_it = reads(round.pair, field, Source::own_field) ||
                              reads(round.pair, field, Source::other_field) ||
                              reads(round.finish, field, Source::own_field);
        read = read || (reads_it && !made);
        made = made || std::ranges::any_of(round.made, [&](const ProgramWrite& write) {
                 return write.number == field.first;
               });
      }
      field.kept = read && made;
    }
  }

  void energies() {
    if (text_.pair_energy) {
      Scope scope(program_.pair_energy, text_.units);
      define_bond_terms(scope);
      program_.pair_energy_at =
          scope.value_of(*text_.pair_energy, "the energy of a pair", Kind::number, kEnergy).node[0];
    }
    if (text_.particle_energy) {
      Scope scope(program_.particle_energy, text_.units);
      define_constants(scope);
      define_finish(scope);
      program_.particle_energy_at =
          scope.value_of(*text_.particle_energy, "the energy of a particle", Kind::number, kEnergy).node[0];
    }
    if (text_.broken) {
      Scope scope(program_.broken, text_.units);
      define_constants(scope);
      define_bonds(scope, program_.bond.size());
      program_.broken_at = scope.value_of(*text_.broken, "'broken'", Kind::truth, {}).node[0];
    }
  }

  std::vector<std::string> exchanged(const RealGraph& pair) const {
    std::vector<std::string> names;
    if (pair.reads(Source::difference)) names.emplace_back("position");
    if (pair.reads(Source::other_velocity)) names.emplace_back("velocity");
    if (pair.reads(Source::noise)) names.emplace_back("id");
    for (const ProgramField& field : program_.particle)
      if (reads(pair, field, Source::other_field)) names.push_back(field.name);
    return names;
  }
  void declare_round(const RuleText::Round& from, const std::vector<SumValue>& sums, bool setup) {
    if (setup) return;
    RuleRound round;
    round.name = from.name;
    for (const SumValue& sum : sums)
      round.sums.push_back({sum.name == kForceField ? "total force" : sum.name,
                            numbers_in(sum.value.kind),
                            describe(sum.value.dimension),
                            {}});
    for (const RuleText::Write& write : from.bonds) round.updated.push_back(write.name);
    for (const RuleText::Write& write : from.finishes) round.made.push_back(write.name);
    if (&from == &text_.rounds.back() && !text_.still && std::ranges::count(round.made, kForceField) == 0)
      round.made.emplace_back(kForceField);
    program_.declaration.rounds.push_back(std::move(round));
  }
  void declare() {
    RuleDeclaration& rule = program_.declaration;
    rule.name = text_.name;
    rule.bonds = text_.range;
    rule.moves = !text_.still;
    rule.noise = std::ranges::any_of(program_.rounds, [](const ProgramRound& round) {
      return round.pair.reads(Source::noise) || round.finish.reads(Source::noise);
    });
    for (size_t k = 0; k < program_.rounds.size(); ++k)
      rule.rounds[k].exchanged = exchanged(program_.rounds[k].pair);
    for (size_t k = 0; k < text_.particle.size(); ++k) {
      const RuleText::Field& field = text_.particle[k];
      rule.particle.push_back({field.name, numbers_in(field.kind), field.unit, field.what});
      rule.ready.push_back(field.name);
      if (program_.particle[k].kept) rule.kept.push_back(field.name);
      if (field.shown) rule.shown.push_back(rule.particle.back());
    }
    program_.shows_damage =
        program_.broken_at && text_.range == BondRange::reference &&
        std::ranges::none_of(text_.particle, [](auto& field) { return field.name == "damage"; });
    if (program_.shows_damage)
      rule.shown.push_back({"damage", 1, "1", "of its bonds the share that is broken"});
    if (!text_.still) rule.particle.push_back({kForceField, 3, "N", "moves the particle"});
    for (size_t k = 0; k < text_.bond.size(); ++k) {
      const RuleText::Field& field = text_.bond[k];
      (program_.bond[k].kept ? rule.bond : rule.constants)
          .push_back({field.name, numbers_in(field.kind), field.unit, field.what});
    }
    check(rule);
    for (const auto& [name, p] : text_.parameters) program_.settings.push_back({name, p.text, "parameter"});
    program_.settings.push_back(
        {"text", fmt::format("{:016x}", hash_of(text_)), "hash of the rule's formulas"});
    if (text_.potential)
      program_.settings.push_back({"potential", text_.potential->told, "tables of a file"});
  }

  const RuleText& text_;
  ProgramPlace place_;
  RuleProgram program_;
  std::set<std::string> names_;                            // of sums
  std::vector<std::pair<Dimension, Dimension>> table_of_;  // argument and value
};

}  // namespace

std::vector<uint32_t> regions_of_starts(const RuleProgram& program) {
  std::set<uint32_t> numbers;
  for (const RealGraph* graph : {&program.start, &program.bond_start})
    for (const RealNode& node : graph->nodes())
      if (node.op == RealOp::input &&
          (node.input.source == Source::own_region || node.input.source == Source::other_region))
        numbers.insert(node.input.index);
  return {numbers.begin(), numbers.end()};
}

RuleProgram understood(const RuleText& text, const ProgramPlace& place) {
  return Understanding(text, place).program();
}

}  // namespace cuboct
