// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_project.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hw/cost/cycles.h"

namespace cuboct {

std::string print_project(const Plan& plan, const State& initial, const std::vector<std::string>& files,
                          const std::optional<CountedCycles>& counted) {
  using Json = nlohmann::ordered_json;
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  const ExpectedCycles cycles = expected_cycles(plan, initial);
  Json per_step = {{"expected", cycles.step}, {"at_full_use", cycles.ideal}};
  if (counted)
    per_step["counted"] = {{"mean", counted->mean()}, {"most", counted->most}, {"steps", counted->steps}};
  const Json json = {
      {"plan", fmt::format("{:016x}", plan.hash)},
      {"nodes", plan.nodes()},
      {"cells", plan.lattice.size()},
      {"particles", plan.particles},
      {"axes", rule.axes},
      {"rule",
       {{"types", rule.types.size()},
        {"laws", rule.errors.size()},
        {"damped", rule.damped},
        {"scaled", rule.scaled},
        {"weighted", rule.weighted},
        {"force_held", rule.pd}}},
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
      {"bits",
       {{"position_frac", w.position_frac},
        {"difference_frac", w.difference_frac},
        {"velocity", w.velocity_bits},
        {"relative_velocity", w.relative_velocity_bits},
        {"strength", w.strength_bits},
        {"sum", w.sum_bits},
        {"id", plan.words.id_bits},
        {"type", rule.type_bits},
        {"particle", plan.words.particle_bits},
        {"halo_record", plan.words.halo_bits},
        {"link", plan.words.link_bits}}},
      {"latency",
       {{"filter", plan.latency.filter}, {"pipe", plan.latency.pipe}, {"update", plan.latency.update}}},
      {"cycles_per_step", per_step},
      {"node", "cuboct_node"},
      {"lattice", "cuboct_lattice"},
      {"files", files},
  };
  return json.dump(2) + "\n";
}

}  // namespace cuboct
