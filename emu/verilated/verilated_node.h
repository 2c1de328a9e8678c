// SPDX-License-Identifier: MIT
// The emitted RTL as a NodeModel: the Verilated node behind the same bench as the native one.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "emu/machine/node_model.h"
#include "emu/verilated/library.h"

namespace cuboct::emu {

class VerilatedNode : public NodeModel {
 public:
  // `seed`: 0, or what the registers hold before reset is drawn from it.
  VerilatedNode(std::shared_ptr<const Library> library, const Plan& plan, uint32_t node, uint8_t has_link,
                uint32_t seed);
  ~VerilatedNode() override;
  VerilatedNode(const VerilatedNode&) = delete;
  VerilatedNode& operator=(const VerilatedNode&) = delete;

  // Throws std::runtime_error with cycle, file and line where an assertion of the RTL fails.
  void clock(const NodeInputs& in, NodeOutputs& out) override;
  bool stands_still() const override { return out_.still != 0; }
  std::string doing() const override;
  Counters counters(uint64_t end) const override;

 private:
  const std::shared_ptr<const Library> library_;
  const uint8_t has_link_;
  void* const model_;
  CuboctOut out_{};
  const int rounds_;
  uint32_t phases_ = 0;  // that run
  uint64_t event_cycles(size_t event, uint64_t end) const;
  std::array<uint64_t, 7> events_{};  // cycles of each bit of force_event_o, up to `last_`
  uint64_t pairs_ = 0, beats_ = 0;    // that pipes took; that receivers took
  uint64_t last_ = 0;                 // cycle of the last call; force_event_o stays through those left out
  bool idle_ = true;
  std::optional<uint64_t> begin_;  // edge of the run's cycle 0, once it was started
};

// The outputs that belong to the cycle, without the link registers.
void read_outputs(const CuboctOut& from, NodeOutputs& out);

// Compiles (or finds) the plan's node (`optimise`: see library.h); keeps a reference to `plan`. Throws
// InputError.
NodeFactory verilated_nodes(const Plan& plan, const std::string& build_directory, uint32_t seed = 0,
                            const std::string& optimise = "-O2");

}  // namespace cuboct::emu
