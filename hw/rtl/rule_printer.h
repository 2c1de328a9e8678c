// SPDX-License-Identifier: MIT
// Prints what hw/rtl/rule_datapath.h declares. One object prints one plan's modules.
#pragma once

#include <string>
#include <vector>

#include "hw/pipeline/print.h"
#include "hw/pipeline/sum_bits.h"
#include "hw/plan/plan.h"
#include "hw/rtl/rule_words.h"
#include "model/program/integer_program.h"

namespace cuboct {

class RulePrinter {
 public:
  explicit RulePrinter(const Plan& plan);

  std::string candidate() const;
  std::string text();
  std::vector<pipeline::Module> pipelines() const;

 private:
  static size_t at(int k) { return static_cast<size_t>(k); }
  int rounds() const { return static_cast<int>(program_.rounds.size()); }
  // "{0}" for each round, 1 the first, "{1}" one less, with `between` between them.
  std::string joined(const char* format, const char* between) const;

  // Inputs of pipelines (rule_inputs.cpp). `text` gets the declarations that a value needs.
  std::string types_of(const std::string& own_word, const graph::Node& node, int bits,
                       const std::string& name, std::string& text) const;
  std::string kind_of(const graph::Node& node, int bits, const std::string& name, std::string& text) const;
  // What an input of a graph is in the cycle before its register.
  std::string input(const graph::Node& node, int round, bool pair, int bits, std::string& text);
  // Registers of the inputs, which hold still but for pairs and particles of their round, and what connects
  // them.
  std::string inputs(const graph::Graph& graph, const pipeline::Schedule& schedule, int round, bool pair,
                     std::string& connections);

  // Rows of bonds (rule_bonds.cpp).
  std::string met_of(int round) const;
  std::string bonds_text() const;
  std::string lost_of(int round);

  // Declares what the pipelines' outputs connect to: `name_o` to `name`. None is declared signed, as a signed
  // vector whose bits are all picked is what yosys 0.23 fails at.
  static std::string declared_outputs(const pipeline::Schedule& schedule, const pipeline::Outputs& outputs,
                                      std::string& connections);
  std::string pair_of(int round);
  std::string finish_of(int round);
  // Of the fault that a pipeline makes where `valid` is 1: assignments to valid, code and number.
  struct FaultNets {
    std::string valid, code, number;
  };
  std::string fault_of(const pipeline::Schedule& schedule, const FaultNets& nets, const std::string& valid,
                       int stage);

  static pipeline::Form form_of_step(const pipeline::Schedule& schedule, int step) {
    const pipeline::Step& s = schedule.steps.steps[static_cast<size_t>(step)];
    return {s.bits, s.is_signed};
  }
  static pipeline::Form form_of_output(const pipeline::Schedule& schedule, int output) {
    return form_of_step(schedule, schedule.steps.outputs[static_cast<size_t>(output)].step);
  }
  int kick_bits(int round, int sum) const {
    return pipeline::kick_bits(program_.rounds[at(round)], pair_schedules_[at(round)], sum);
  }
  int sum_bits(int round, int sum) const {
    return pipeline::sum_bits(program_, program_.rounds[at(round)], pair_schedules_[at(round)], sum);
  }

  const Plan& plan_;
  const graph::FixedProgram& program_;
  RuleWords words_;
  std::vector<pipeline::Outputs> pairs_, finishes_;
  std::vector<pipeline::Schedule> pair_schedules_, finish_schedules_;
  int step_bits_ = 0;    // of the step's number; 0: nobody reads it
  int number_bits_ = 0;  // of any number that a fault tells
};

// "[7:0] " of 8 bits.
std::string range_text(int bits);

}  // namespace cuboct
