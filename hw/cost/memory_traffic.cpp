// SPDX-License-Identifier: MIT
#include "hw/cost/memory_traffic.h"

#include <optional>
#include <string_view>

#include "hw/cost/node_memories.h"
#include "hw/cost/rule_work.h"

namespace cuboct {
namespace {

struct Access {
  uint64_t reads = 0, writes = 0;
};

// Of the faces' memories along an axis.
struct FaceWords {
  Access halos, relayed;
};

std::vector<FaceWords> face_words(const Plan& plan, MachineEvents e) {
  std::vector<FaceWords> words;
  const int axes = plan.rule.axes;
  const bool bricks = !plan.bricks.one_cell();
  for (int axis = 0; axis < axes; ++axis) {
    FaceWords w;
    w.halos = {candidates_along(e, axis), halos_along(e, axis) - culled_along(e, axis)};
    w.relayed.writes = halos_along(e, axis);
    // What came along an axis goes on along each later one, by itself or over all links at once.
    if (!bricks)
      w.relayed.reads = halos_along(e, axis) *
                        (plan.arch.halos == Halos::arrival ? 1u : static_cast<unsigned>(axes - 1 - axis));
    else if (axis == axes - 2)
      w.relayed.reads = e.relayed - e.relayed_own;
    // A walk past the slots reads its record once.
    if (plan.arch.narrow_memories) w.halos.reads = w.halos.writes;
    words.push_back(w);
  }
  return words;
}

void add_table(const char* holds, const FixedTable& table, const Plan& plan, uint64_t pairs,
               std::vector<MemoryTraffic>& traffic) {
  traffic.push_back({holds, table.c0.size(), plan.rule.widths.strength_bits * (table.degree + 1),
                     plan.arch.force_pipes, pairs, 0, true});
}

}  // namespace

std::vector<MemoryTraffic> memory_traffic(const Plan& plan, const MachineEvents& e) {
  if (plan.program != nullptr) return rule_traffic(plan, e);
  const Arch& arch = plan.arch;
  const auto pipes = static_cast<uint64_t>(arch.force_pipes);
  const bool narrow = arch.narrow_memories;
  // UPDATE writes each slot, SCAN those that stay, TAKE and LAND those that come.
  const uint64_t written = e.updates + e.scanned - e.left + e.moved;
  const uint64_t own_met = e.candidates - e.candidates_x - e.candidates_y - e.candidates_z;
  const std::vector<FaceWords> faces = face_words(plan, e);
  const auto access_of = [&](const NodeMemory& m, size_t halos, size_t relays) -> std::optional<Access> {
    const std::string_view holds = m.holds;
    if (holds == "own particles") return Access{e.relayed_own + e.updates + e.scanned, written};
    // With narrow memories all slots that a record meets, and those of its pairs.
    if (holds == "own particles, for the streamer")
      return Access{narrow ? e.candidates + e.pairs : own_met, written};
    if (holds == "own particles, for the pipes" || holds == "ids, for the pipes' faults")
      return Access{e.pairs, written * pipes};
    if (holds == "queue") return Access{e.entries, e.entries};
    if (holds == "sums") return Access{e.kicks + e.updates * pipes, e.kicks};
    if (holds == "particles between cells") return Access{e.inner, e.inner};
    if (holds == "leading bits of positions")
      return Access{e.candidates * static_cast<uint64_t>(arch.filter_lanes), written};
    if (holds == "halos from a face") return faces[halos].halos;
    if (holds == "halos, for the relay") return faces[relays].relayed;
    if (holds == "halos, particles from a face") {
      Access w = faces[halos].halos;
      // Which axis a particle came along no event tells: it is told of the last one.
      if (halos + 1 == faces.size()) w.reads += e.moved, w.writes += e.moved;
      return w;
    }
    if (holds == "particles from a face") return halos == faces.size() ? Access{e.moved, e.moved} : Access{};
    return std::nullopt;
  };
  std::vector<MemoryTraffic> traffic;
  size_t halos = 0, relays = 0;
  const NodeMemories memories(plan.rule, arch, plan.particles);
  for (const NodeMemory& m : memories.of(arch.brick, arch.filter_lanes, arch.force_pipes)) {
    const auto words = access_of(m, halos, relays);
    const std::string_view holds = m.holds;
    halos += holds == "halos from a face" || holds == "halos, particles from a face";
    relays += holds == "halos, for the relay";
    traffic.push_back({m.holds, m.words, m.bits, m.copies, words ? words->reads : 0,
                       words ? words->writes : 0, words.has_value()});
  }
  add_table("force table", plan.rule.force, plan, e.pairs, traffic);
  if (plan.rule.damped) add_table("damping table", plan.rule.damp, plan, e.pairs, traffic);
  return traffic;
}

}  // namespace cuboct
