// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_project.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hw/cost/cycles.h"
#include "model/program/integer_program.h"

namespace cuboct {
namespace {

using Json = nlohmann::ordered_json;

Json law_json(const FixedRule& rule) {
  return {{"types", rule.types.size()}, {"laws", rule.errors.size()}, {"damped", rule.damped},
          {"scaled", rule.scaled},      {"weighted", rule.weighted},  {"force_held", rule.pd}};
}

Json program_json(const IntegerProgram& rule) {
  Json fields = Json::array();
  for (const graph::Field& field : rule.program.fields)
    fields.push_back({{"name", field.name}, {"numbers", field.numbers}});
  return {{"name", rule.program.name},
          {"types", rule.program.types},
          {"rounds", rule.program.rounds.size()},
          {"fields", fields}};
}

Json rounds_json(const Plan& plan) {
  Json rounds = Json::array();
  for (const PlanRound& round : plan.rounds)
    rounds.push_back({{"record_bits", bits_of(round.record)},
                      {"beats", round.beats},
                      {"pipe", round.pipe},
                      {"finish", round.finish}});
  return {{"filter", plan.latency.filter}, {"rounds", rounds}};
}

}  // namespace

std::string print_project(const Plan& plan, const State& initial, const std::vector<std::string>& files,
                          const std::optional<CountedCycles>& counted) {
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  const IntegerProgram* program = plan.program.get();
  const ExpectedCycles cycles = expected_cycles(plan, initial);
  Json per_step = {{"expected", cycles.step}, {"at_full_use", cycles.ideal}};
  if (counted)
    per_step["counted"] = {{"mean", counted->mean()}, {"most", counted->most}, {"steps", counted->steps}};
  Json bits = {{"position_frac", w.position_frac}};
  const auto add = [&bits](const char* name, int value) { bits[name] = value; };
  if (program == nullptr) add("difference_frac", w.difference_frac);
  add("velocity", w.velocity_bits);
  if (program == nullptr) {
    add("relative_velocity", w.relative_velocity_bits);
    add("strength", w.strength_bits);
    add("sum", w.sum_bits);
  }
  add("id", plan.words.id_bits);
  add("type", rule.type_bits);
  add("particle", plan.words.particle_bits);
  add("halo_record", plan.words.halo_bits);
  add("link", plan.words.link_bits);
  const Json json = {
      {"version", kProjectVersion},
      {"plan", fmt::format("{:016x}", plan.hash)},
      {"nodes", plan.nodes()},
      {"cells", plan.lattice.size()},
      {"particles", plan.particles},
      {"axes", rule.axes},
      {"rule", program != nullptr ? program_json(*program) : law_json(rule)},
      {"arch",
       {{"brick", {plan.arch.brick[0], plan.arch.brick[1], plan.arch.brick[2]}},
        {"capacity", plan.arch.capacity},
        {"filter_lanes", plan.arch.filter_lanes},
        {"force_pipes", plan.arch.force_pipes},
        {"queue_depth", plan.arch.queue_depth},
        {"overlap", plan.arch.overlap},
        {"halos_on_arrival", plan.arch.halos == Halos::arrival},
        {"streamers", plan.arch.streamers},
        {"narrow_memories", plan.arch.narrow_memories}}},
      {"bits", bits},
      {"latency", program != nullptr ? rounds_json(plan)
                                     : Json{{"filter", plan.latency.filter},
                                            {"pipe", plan.latency.pipe},
                                            {"update", plan.latency.update}}},
      {"cycles_per_step", per_step},
      {"node", "cuboct_node"},
      {"lattice", "cuboct_lattice"},
      {"files", files},
  };
  return json.dump(2) + "\n";
}

}  // namespace cuboct
