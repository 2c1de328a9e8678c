// SPDX-License-Identifier: MIT
// A rule of text in a plan: what each of its rounds asks of a node. docs/reference/node.md, "Rounds".
#include <fmt/format.h>

#include "hw/pipeline/schedule.h"
#include "hw/plan/plan.h"
#include "model/base/hash.h"
#include "model/base/integer_math.h"
#include "model/graph/certificate.h"
#include "model/program/integer_program.h"
#include "model/trace/trace.h"

namespace cuboct {
namespace {

// Before a pair's graph: the memories' answer, the difference of positions and the constants. Behind it: the
// sum.
constexpr int kPairReads = 2, kPairSum = 1;
// Before a finish: the memories' answer, the sum over the pipes. Behind it: the slot's write, and the
// memory's answer to who asks for it.
constexpr int kFinishReads = 2, kFinishWrite = 2;

std::vector<PlanRound> rounds_of(const Plan& plan) {
  const graph::FixedProgram& program = plan.program->program;
  std::vector<PlanRound> rounds;
  for (size_t k = 0; k < program.rounds.size(); ++k) {
    const graph::Round& round = program.rounds[k];
    PlanRound& of = rounds.emplace_back();
    of.record = k == 0 ? plan.words.halo : plan.words.later[k - 1];
    of.beats = ceil_div(bits_of(of.record), plan.words.link_bits);
    const auto pair = pipeline::schedule_of(round.pair, pipeline::piped_outputs(round));
    const auto finish = pipeline::schedule_of(round.finish, finish_outputs(program, round));
    of.pipe = kPairReads + pair.cycles + kPairSum;
    of.finish = kFinishReads + finish.cycles + kFinishWrite;
  }
  return rounds;
}

}  // namespace

void set_program(Plan& plan, std::shared_ptr<const IntegerProgram> program) {
  plan.program = std::move(program);
  plan.words =
      words_of(plan.rule, plan.arch, plan.particles, &plan.program->program, plan.program->rows.get());
  plan.link = link_code(plan.arch.link_check, plan.words.link_bits);
  plan.rounds = rounds_of(plan);
  Hash hash;
  hash.add(static_cast<int64_t>(plan.hash)).add(plan.words.link_bits);
  for (const PlanRound& round : plan.rounds) hash.add(round.pipe).add(round.finish);
  for (const char c : graph::certificate_of(plan.program->program)) hash.add(c);
  if (const graph::BondRows* rows = plan.program->rows.get()) {
    for (const uint32_t other : rows->other) hash.add(other);
    for (const uint32_t kind : rows->kind) hash.add(kind);
    for (const int64_t constant : rows->constants) hash.add(constant);
  }
  plan.hash = hash.value();
}

std::string machine_refusal(const Plan& plan) {
  if (!plan.rule.cubic()) return "its nodes have cubic cells, and no cube divides the box";
  if (plan.program == nullptr) return "";
  const Arch& arch = plan.arch;
  if (plan.rounds.size() > kMostRounds)
    return fmt::format("it has {} rounds at most, and the rule {}", kMostRounds, plan.rounds.size());
  if (!plan.bricks.one_cell()) return "nodes of bricks run the pair law alone: set brick = [1, 1, 1]";
  if (arch.narrow_memories) return "narrow memories are for the pair law alone: set memories = \"wide\"";
  if (arch.halos == Halos::arrival)
    return "halos on arrival are for the pair law alone: set halos = \"phases\"";
  if (arch.multipliers != Multipliers::parallel)
    return "shared and serial multipliers are for the pair law alone: set multipliers = \"parallel\"";
  return "";
}

void describe_rounds(const Plan& plan, const std::function<void(const char*, const std::string&)>& line) {
  const graph::FixedProgram& program = plan.program->program;
  line("rule", fmt::format("{}, {} round{}", program.name, program.rounds.size(),
                           program.rounds.size() == 1 ? "" : "s"));
  std::string fields;
  for (const graph::Field& field : program.fields)
    fields += fmt::format("{}{} of {} number{}", fields.empty() ? "" : ", ", field.name, field.numbers,
                          field.numbers == 1 ? "" : "s");
  line("fields", fields.empty() ? "none" : fields);
  for (size_t k = 0; k < plan.rounds.size(); ++k) {
    const PlanRound& round = plan.rounds[k];
    line(fmt::format("round {}", k + 1).c_str(),
         fmt::format("record of {} bits in {} beat{} of {}; pipe {}, finish {} cycles", bits_of(round.record),
                     round.beats, round.beats == 1 ? "" : "s", plan.words.link_bits, round.pipe,
                     round.finish));
  }
}

}  // namespace cuboct
