// SPDX-License-Identifier: MIT
#include "study/machines/counts.h"

#include <fmt/format.h>

#include <algorithm>

#include "emu/lattice/engine.h"
#include "emu/timing/kicks.h"
#include "emu/timing/timing.h"
#include "hw/engine/scene_engine.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/json.h"

namespace cuboct::study {
namespace {

// Keys of an arch that no bit depends on.
constexpr const char* kNoBits[] = {"node.filter_lanes", "node.force_pipes", "node.multipliers",
                                   "node.memories",     "node.halos",       "node.streamers",
                                   "node.queue_depth",  "node.overlap",     "node.brick",
                                   "link.bits",         "link.check"};

Arch with_machine(Arch arch, const Arch& machine) {
  arch.filter_lanes = machine.filter_lanes, arch.force_pipes = machine.force_pipes;
  arch.multipliers = machine.multipliers, arch.narrow_memories = machine.narrow_memories;
  arch.halos = machine.halos, arch.streamers = machine.streamers;
  arch.queue_depth = machine.queue_depth, arch.overlap = machine.overlap;
  arch.brick = machine.brick;
  arch.link_bits = machine.link_bits, arch.link_check = machine.link_check;
  return arch;
}

Arch without_machine(const Arch& arch) { return with_machine(arch, {}); }

double per(uint64_t count, double steps) { return static_cast<double>(count) / steps; }

uint64_t cycles_of(const MachineEvents& e, std::initializer_list<Phase> phases) {
  uint64_t cycles = 0;
  for (const Phase phase : phases) cycles += e.phase_cycles[static_cast<size_t>(phase)];
  return cycles;
}

// A node's phases but FORCE follow one another without a gap up to `end`; `after` are cycles in which it
// waits for the node that ends last.
std::array<double, kStepParts> parts_of(const MachineEvents& node, uint64_t end, uint64_t after,
                                        double steps) {
  const uint64_t exchange = cycles_of(node, {Phase::exchange_x, Phase::exchange_y, Phase::exchange_z});
  const uint64_t update = cycles_of(node, {Phase::update});
  const uint64_t migrate = cycles_of(node, {Phase::migrate_x, Phase::migrate_y, Phase::migrate_z});
  return {per(exchange, steps), per(end - std::min(end, exchange + update + migrate), steps),
          per(update, steps), per(migrate + after, steps)};
}

// Beats that an exchange needs one after another. By phases each axis follows the one before it, over two
// faces at once. On arrival all axes go in lock step, so what the relay reads goes over the last one's links.
double link_demand(const Plan& plan, const MachineEvents& e, double steps) {
  if (plan.arch.halos != Halos::arrival) return per(e.beats, 2 * steps);
  return per(e.relayed * static_cast<uint64_t>(plan.words.halo_beats), steps);
}

std::array<double, kDemands> demands_of(const Plan& plan, std::span<const MachineEvents> nodes,
                                        double steps) {
  std::array<double, kDemands> most{};
  for (const MachineEvents& e : nodes) {
    const std::array<double, kDemands> mine{
        per(e.candidates, steps * plan.arch.streamers),
        per(e.pairs, steps * plan.arch.force_pipes) * plan.latency.interval, link_demand(plan, e, steps),
        per(e.updates * static_cast<uint64_t>(plan.latency.stride) + e.scanned, steps)};
    for (size_t k = 0; k < kDemands; ++k) most[k] = std::max(most[k], mine[k]);
  }
  return most;
}

// One plan's timing beside a run that others share.
struct Counted {
  Counted(const Plan& of, uint64_t memory) : plan(of), timing(of, 1), spans(memory) {}

  void step(const emu::CellSlots& slots, std::span<const emu::Leaving> leaving) {
    timing.step(slots, leaving, spans);
    uint64_t end = 0;  // the slowest node's
    for (const PhaseSpan& span : spans) end = std::max(end, span.end + 1);
    counts.most = std::max(counts.most, end - counts.cycles);
    counts.cycles = end;
    ++counts.steps;
  }

  std::optional<MachineCounts> result(uint64_t kicks) {
    if (counts.steps == 0) return std::nullopt;
    const auto steps = static_cast<double>(counts.steps);
    const std::span<const MachineEvents> nodes = timing.events();
    counts.parts = busiest(nodes, steps);
    counts.demands = demands_of(plan, nodes, steps);
    counts.events = sum(nodes);
    counts.events.kicks = kicks;
    return counts;
  }

  // Of the node that waits least: most of its cycles are force and update.
  std::array<double, kStepParts> busiest(std::span<const MachineEvents> nodes, double steps) const {
    std::array<double, kStepParts> most{};
    const auto busy = [](const std::array<double, kStepParts>& p) {
      return p[static_cast<size_t>(StepPart::force)] + p[static_cast<size_t>(StepPart::update)];
    };
    const size_t phases = spans.size() / nodes.size();
    for (size_t n = 0; n < nodes.size(); ++n) {
      uint64_t end = 0;
      for (size_t p = 0; p < phases; ++p) end = std::max(end, spans[n * phases + p].end + 1);
      const auto parts = parts_of(nodes[n], end, counts.cycles - end, steps);
      if (n == 0 || busy(parts) > busy(most)) most = parts;
    }
    return most;
  }

  const Plan& plan;
  emu::TimingModel timing;
  std::vector<PhaseSpan> spans;  // of the last step
  MachineCounts counts;
};

}  // namespace

std::string counts_json(const MachineCounts& counts) {
  std::string events;
  for (const NamedEvent& event : event_names())
    events += fmt::format("{}\"{}\":{}", events.empty() ? "" : ",", event.name, counts.events.*event.count);
  return fmt::format(
      "{{\"steps\":{},\"cycles\":{},\"most\":{},\"events\":{{{}}},\"phase_cycles\":[{}],\"parts\":{},"
      "\"demands\":{}}}",
      counts.steps, counts.cycles, counts.most, events, fmt::join(counts.events.phase_cycles, ","),
      json(std::vector<double>(counts.parts.begin(), counts.parts.end())),
      json(std::vector<double>(counts.demands.begin(), counts.demands.end())));
}

Settings of_bits(Settings settings) {
  std::erase_if(settings.arch, [](const Change& change) {
    return std::ranges::find(kNoBits, change.key) != std::end(kNoBits);
  });
  return settings;
}

namespace {

Setup setup_of(const Scene& scene, const Base& base, const Settings& settings) {
  const std::string path = base.arch_path.empty() ? "(default arch)" : base.arch_path;
  const std::string text = base.arch_text.empty() ? "name = \"default\"\n" : base.arch_text;
  const Arch arch = without_machine(parse_arch(with_changes(text, path, settings.arch), path));
  return with_places(scene, arch, [&] { return machine_setup(scene, arch); });
}

}  // namespace

SharedSetup::SharedSetup(const Base& base, const Settings& settings)
    : scene_(parse_scene(with_changes(base.scene_text, base.scene_path, settings.scene), base.scene_path)),
      setup_(setup_of(scene_, base, settings)),
      census_(setup_.plan, setup_.initial) {}

Plan SharedSetup::plan_of(const Arch& arch) const {
  Plan plan = on_machine(setup_.plan, with_machine(setup_.plan.arch, arch));
  if (const std::string why = machine_refusal(plan); !why.empty()) throw InputError("no machine: " + why);
  return plan;
}

ExpectedCycles SharedSetup::expected(const Plan& plan) const {
  return plan.arch.narrow_memories ? expected_cycles(plan, setup_.initial) : expected_cycles(plan, census_);
}

std::vector<std::optional<MachineCounts>> count_machines(const SharedSetup& shared,
                                                         const std::vector<Plan>& plans, uint64_t steps) {
  const State& initial = shared.initial();
  std::vector<std::unique_ptr<Counted>> counted;
  for (const Plan& plan : plans) counted.push_back(std::make_unique<Counted>(plan, spans_of_step(plan)));
  std::vector<MachineEvents> kicks(shared.plan().nodes());
  try {
    emu::LatticeOptions options;
    options.threads = 1;
    emu::LatticeEngine engine(shared.plan(), initial.step, shared.plan().particles,
                              [&](uint32_t k) { return initial.particles[k]; }, options,
                              {initial.fields, initial.bonds});  // of an initial state in the order of ids
    std::optional<emu::KickCounter> counter;  // of the pair law, which says which pairs are near
    if (shared.plan().program == nullptr) counter.emplace(shared.plan(), 1);
    emu::CellSlots slots;
    std::vector<Particle> particles;
    for (uint64_t k = 0; k < steps && !interrupted(); ++k) {
      engine.slots(slots);
      particles.clear();
      if (counter) engine.for_each_slot([&](const Particle& p) { particles.push_back(p); });
      engine.step();
      if (counter) counter->add(particles, kicks);
      for (const auto& machine : counted) machine->step(slots, engine.leaving());
    }
  } catch (const RunError&) {
    // What a run would stop at; the steps before it took what they took.
  }
  const uint64_t all = sum(kicks).kicks;
  std::vector<std::optional<MachineCounts>> results;
  for (const auto& machine : counted) results.push_back(machine->result(all));
  return results;
}

const char* name_of(StepPart part) {
  static constexpr const char* kNames[] = {"exchange", "force", "update", "migrate"};
  return kNames[static_cast<size_t>(part)];
}

const char* name_of(Demand demand) {
  static constexpr const char* kNames[] = {"lanes", "pipes", "links", "memory"};
  return kNames[static_cast<size_t>(demand)];
}

std::string bound_of(const MachineCounts& counts) {
  const auto most = std::ranges::max_element(counts.demands);
  if (2 * *most < counts.mean()) return "latency";
  return name_of(static_cast<Demand>(most - counts.demands.begin()));
}

}  // namespace cuboct::study
