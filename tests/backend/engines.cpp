// SPDX-License-Identifier: MIT
#include "tests/backend/engines.h"

#include <fmt/format.h>

#include "model/program/integer_program.h"

namespace cuboct::test {
namespace {

std::string first_difference(uint64_t step, const State& expected, const State& got) {
  if (expected.particles.size() != got.particles.size())
    return fmt::format("step {}: {} particles, golden has {}", step, got.particles.size(),
                       expected.particles.size());
  for (size_t k = 0; k < expected.particles.size(); ++k) {
    const Particle &e = expected.particles[k], &g = got.particles[k];
    if (e == g) continue;
    std::string text = fmt::format("step {}: particle {}:", step, e.id);
    const auto field = [&](const std::string& name, int64_t a, int64_t b) {
      if (a != b) text += fmt::format(" {} is {}, golden has {};", name, b, a);
    };
    field("id", e.id, g.id);
    field("type", e.type, g.type);
    field("cell", e.cell, g.cell);
    for (int a = 0; a < 3; ++a) {
      const char axis = "xyz"[a];
      field(fmt::format("x.{}", axis), e.x[a], g.x[a]);
      field(fmt::format("v.{}", axis), e.v[a], g.v[a]);
      field(fmt::format("u.{}", axis), e.u[a], g.u[a]);
    }
    text.pop_back();
    return text;
  }
  if (expected.fields != got.fields) return fmt::format("step {}: other fields", step);
  return {};
}

}  // namespace

Golden golden_of(const Setup& setup) {
  const Plan& plan = setup.plan;
  return plan.program ? Golden(plan.program->program, plan.lattice, plan.arch.capacity, setup.initial,
                               plan.program->rows)
                      : Golden(plan.rule, plan.lattice, plan.arch.capacity, setup.initial);
}

GoldenRun run_golden(const Setup& setup, uint64_t steps) {
  GoldenRun run;
  const auto keep = [&](const Golden& golden) {
    run.states.push_back(golden.state());
    auto& order = run.order.emplace_back();
    for (const auto& cell : golden.cells()) {
      auto& ids = order.emplace_back();
      for (const Particle& p : cell) ids.push_back(p.id);
    }
  };
  try {
    Golden golden = golden_of(setup);
    keep(golden);
    for (uint64_t k = 0; k < steps; ++k) {
      golden.step();
      keep(golden);
    }
  } catch (const RunError& e) {
    run.fault = e;
  }
  return run;
}

emu::RunOptions keep_all(uint64_t steps, double stall_rate, uint64_t stall_seed) {
  emu::RunOptions options;
  options.steps = steps;
  for (uint64_t s = 0; s <= steps; ++s) options.frames.push_back(s);
  options.stall_rate = stall_rate;
  options.stall_seed = stall_seed;
  options.keep_order = true;
  return options;
}

Compared compare(const Plan& plan, const GoldenRun& golden, const emu::RunResult& run) {
  Compared result;
  const Trace& trace = run.trace;
  const auto fail = [&result](const std::string& text) {
    if (result.difference.empty()) result.difference = text;
  };
  for (size_t s = 0; s < golden.states.size(); ++s) {
    if (s >= trace.frames.size()) {
      fail(fmt::format("step {}: no state", s));
      break;
    }
    fail(first_difference(s, golden.states[s], trace.frames[s]));
    if (s >= trace.state_hash.size() || trace.state_hash[s] != hash_of(plan.lattice, golden.states[s]))
      fail(fmt::format("step {}: hash differs", s));
    for (size_t n = 0; n < golden.order[s].size(); ++n) {
      if (run.order[s][n] != golden.order[s][n])
        fail(fmt::format("step {}: node {}: order of the slots differs", s, n));
      result.slots += golden.order[s][n].size();
    }
    ++result.steps;
    result.particles += golden.states[s].particles.size();
  }
  if (trace.state_hash.size() != golden.states.size())
    fail(fmt::format("{} states, golden has {}", trace.state_hash.size(), golden.states.size()));
  if (golden.fault.has_value() != trace.stop.has_value())
    fail(trace.stop ? "stopped where golden does not: " + trace.stop->text
                    : "did not stop where golden does");
  if (golden.fault && trace.stop && trace.stop->text != golden.fault->what())
    fail(fmt::format("stopped with '{}', golden with '{}'", trace.stop->text, golden.fault->what()));
  return result;
}

Compared compare_cycles(const emu::RunResult& a, const emu::RunResult& b) {
  Compared result;
  const auto fail = [&result](const std::string& text) {
    if (result.difference.empty()) result.difference = text;
  };
  const Trace &s = a.trace, &t = b.trace;
  if (s.state_hash != t.state_hash) fail("hashes differ");
  if (s.stop != t.stop) fail("stop differs");
  if (s.cycles.size() != t.cycles.size())
    fail(fmt::format("{} phase spans against {}", s.cycles.size(), t.cycles.size()));
  for (size_t k = 0; k < std::min(s.cycles.size(), t.cycles.size()); ++k, ++result.spans) {
    if (s.cycles[k] == t.cycles[k]) continue;
    fail(fmt::format("step {}, node {}, {}: cycles {} to {} in {}, {} to {} in {}", k / kPhases / s.nodes,
                     k / kPhases % s.nodes, to_string(static_cast<Phase>(k % kPhases)), s.cycles[k].start,
                     s.cycles[k].end, s.engine, t.cycles[k].start, t.cycles[k].end, t.engine));
  }
  result.steps = s.state_hash.size();
  return result;
}

}  // namespace cuboct::test
