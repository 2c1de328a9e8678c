// SPDX-License-Identifier: MIT
#include "model/trace/compare.h"

#include <fmt/format.h>

#include <algorithm>

namespace cuboct {
namespace {

std::string hex(uint64_t hash) { return fmt::format("{:016x}", hash); }

Mismatch found(Mismatch::Kind kind, std::string a, std::string b) {
  Mismatch mismatch;
  mismatch.kind = kind;
  mismatch.value_a = std::move(a);
  mismatch.value_b = std::move(b);
  return mismatch;
}

std::optional<Mismatch> compare_stops(const std::optional<StopReason>& a,
                                      const std::optional<StopReason>& b) {
  const auto differ = [&](const char* field, std::string value_a, std::string value_b) {
    Mismatch mismatch = found(Mismatch::Kind::stop, std::move(value_a), std::move(value_b));
    mismatch.field = field;
    return mismatch;
  };
  if (!a && !b) return std::nullopt;
  const StopReason none, &sa = a ? *a : none, &sb = b ? *b : none;
  if (sa.fault != sb.fault) return differ("fault", to_string(sa.fault), to_string(sb.fault));
  if (sa.step != sb.step) return differ("step", std::to_string(sa.step), std::to_string(sb.step));
  if (sa.cell != sb.cell) return differ("cell", std::to_string(sa.cell), std::to_string(sb.cell));
  if (sa.particle != sb.particle)
    return differ("particle", std::to_string(sa.particle), std::to_string(sb.particle));
  if (sa.number != sb.number) return differ("number", std::to_string(sa.number), std::to_string(sb.number));
  return std::nullopt;
}

std::optional<Mismatch> compare_cycles(const Trace& a, const Trace& b) {
  if (a.cycles.empty() || b.cycles.empty()) return std::nullopt;
  if (a.rounds != b.rounds) {
    Mismatch mismatch =
        found(Mismatch::Kind::cycles, fmt::format("{} rounds", a.rounds), fmt::format("{} rounds", b.rounds));
    mismatch.field = "number";
    return mismatch;
  }
  const auto at = [&](size_t i, const char* edge, uint64_t value_a, uint64_t value_b) {
    Mismatch mismatch = found(Mismatch::Kind::cycles, std::to_string(value_a), std::to_string(value_b));
    mismatch.step = i / a.phases() / a.nodes;
    mismatch.node = static_cast<uint32_t>(i / a.phases() % a.nodes);
    mismatch.nodes = a.nodes;
    mismatch.field = fmt::format("{} {}", phase_name(static_cast<int>(i % a.phases()), a.rounds), edge);
    return mismatch;
  };
  for (size_t i = 0; i < std::min(a.cycles.size(), b.cycles.size()); ++i) {
    if (a.cycles[i].start != b.cycles[i].start) return at(i, "start", a.cycles[i].start, b.cycles[i].start);
    if (a.cycles[i].end != b.cycles[i].end) return at(i, "end", a.cycles[i].end, b.cycles[i].end);
  }
  if (a.cycles.size() != b.cycles.size()) {
    Mismatch mismatch = found(Mismatch::Kind::cycles, fmt::format("{} phase times", a.cycles.size()),
                              fmt::format("{} phase times", b.cycles.size()));
    mismatch.step = std::min(a.cycles.size(), b.cycles.size()) / a.phases() / std::max<uint64_t>(a.nodes, 1);
    mismatch.field = "number";
    return mismatch;
  }
  return std::nullopt;
}

// Calls see(step, hash of a, hash of b) for each step that both hashed, while it returns true.
template <typename See>
void for_each_common(const Trace& a, const Trace& b, See see) {
  size_t i = 0, j = 0;
  while (i < a.state_hash.size() && j < b.state_hash.size()) {
    const uint64_t step_a = a.hashed_step(i), step_b = b.hashed_step(j);
    if (step_a == step_b && !see(step_a, a.state_hash[i], b.state_hash[j])) return;
    i += step_a <= step_b;
    j += step_b <= step_a;
  }
}

std::string place_of_cell(const Lattice& lattice, uint32_t cell) {
  if (cell >= lattice.size()) return fmt::format("cell {}", cell);
  const Cell& at = lattice.cell(cell);
  return fmt::format("cell {} ({} {} {})", cell, at[0], at[1], at[2]);
}

// With the coordinates of its cell where each node of the machine serves the cell of its number.
std::string place_of_node(const Lattice& lattice, uint32_t node, uint64_t nodes) {
  if (nodes != lattice.size() || node >= nodes) return fmt::format("node {}", node);
  const Cell& at = lattice.cell(node);
  return fmt::format("node {} (cell {} {} {})", node, at[0], at[1], at[2]);
}

}  // namespace

std::string Mismatch::text(const std::string& engine_a, const std::string& engine_b,
                           const Lattice& lattice) const {
  std::string where;
  switch (kind) {
    case Kind::plan:
      where = "plan hash";
      break;
    case Kind::nodes:
      where = "nodes";
      break;
    case Kind::state:
      where = step > equal_at + 1 ? fmt::format("step {} (equal at step {}), state hash", step, equal_at)
                                  : fmt::format("step {}, state hash", step);
      break;
    case Kind::length:
      where = "steps done";
      break;
    case Kind::stop:
      where = "stop, " + field;
      break;
    case Kind::cycles:
      where = node ? fmt::format("step {}, {}, {}", step, place_of_node(lattice, *node, nodes), field)
                   : fmt::format("step {}, {}", step, field);
      break;
    case Kind::particle:
      where =
          fmt::format("step {}, {}, particle {}, {}", step, place_of_cell(lattice, cell), particle, field);
  }
  return fmt::format("{}: {} {}, {} {}", where, engine_a, value_a, engine_b, value_b);
}

std::optional<Mismatch> compare(const Trace& a, const Trace& b) {
  using Kind = Mismatch::Kind;
  if (a.plan_hash != b.plan_hash) return found(Kind::plan, hex(a.plan_hash), hex(b.plan_hash));
  if (a.nodes != b.nodes) return found(Kind::nodes, std::to_string(a.nodes), std::to_string(b.nodes));
  std::optional<Mismatch> state;
  uint64_t equal_at = 0;
  for_each_common(a, b, [&](uint64_t step, uint64_t hash_a, uint64_t hash_b) {
    if (hash_a == hash_b) {
      equal_at = step;
      return true;
    }
    state = found(Kind::state, hex(hash_a), hex(hash_b));
    state->step = step;
    state->equal_at = equal_at;
    return false;
  });
  if (state) return state;
  if (a.steps() != b.steps() || a.state_hash.empty() != b.state_hash.empty())
    return found(Kind::length, std::to_string(a.steps()), std::to_string(b.steps()));
  if (auto mismatch = compare_stops(a.stop, b.stop)) return mismatch;
  return compare_cycles(a, b);
}

std::optional<Mismatch> compare(const State& a, const State& b) {
  Mismatch mismatch;
  mismatch.kind = Mismatch::Kind::particle;
  mismatch.step = a.step;
  const auto differ = [&](const std::string& field, const auto& value_a, const auto& value_b) {
    mismatch.field = field;
    mismatch.value_a = fmt::format("{}", value_a);
    mismatch.value_b = fmt::format("{}", value_b);
    return mismatch;
  };
  for (size_t i = 0; i < std::max(a.particles.size(), b.particles.size()); ++i) {
    const Particle* pa = i < a.particles.size() ? &a.particles[i] : nullptr;
    const Particle* pb = i < b.particles.size() ? &b.particles[i] : nullptr;
    if (!pb || (pa && pa->id < pb->id)) {
      mismatch.particle = pa->id;
      mismatch.cell = pa->cell;
      return differ("presence", "present", "missing");
    }
    mismatch.particle = pb->id;
    mismatch.cell = pb->cell;
    if (!pa || pb->id < pa->id) return differ("presence", "missing", "present");
    mismatch.cell = pa->cell;
    if (pa->type != pb->type) return differ("type", int{pa->type}, int{pb->type});
    if (pa->cell != pb->cell) return differ("cell", pa->cell, pb->cell);
    const auto triple = [&](const char* name, const Int3& ta, const Int3& tb) -> std::optional<Mismatch> {
      for (int axis = 0; axis < 3; ++axis)
        if (ta[axis] != tb[axis]) return differ(fmt::format("{}.{}", name, "xyz"[axis]), ta[axis], tb[axis]);
      return std::nullopt;
    };
    if (auto m = triple("x", pa->x, pb->x)) return m;
    if (auto m = triple("v", pa->v, pb->v)) return m;
    if (auto m = triple("u", pa->u, pb->u)) return m;
    const size_t numbers = a.fields.size() / a.particles.size();
    for (size_t f = i * numbers; f < std::min((i + 1) * numbers, b.fields.size()); ++f)
      if (a.fields[f] != b.fields[f])
        return differ(fmt::format("number {} of its fields", f - i * numbers), a.fields[f], b.fields[f]);
  }
  return std::nullopt;
}

const State* frame_at(const Trace& trace, uint64_t step) {
  for (const State& frame : trace.frames)
    if (frame.step == step) return &frame;
  return nullptr;
}

uint64_t states_compared(const Trace& a, const Trace& b) {
  uint64_t count = 0;
  for_each_common(a, b, [&](uint64_t, uint64_t, uint64_t) { return ++count, true; });
  return count;
}

uint64_t updates_compared(const Trace& trace, uint64_t particles) { return trace.steps() * particles; }

}  // namespace cuboct
