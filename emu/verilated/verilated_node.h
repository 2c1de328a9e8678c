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
  std::string doing() const override;
  Counters counters() const override;

 private:
  const std::shared_ptr<const Library> library_;
  const uint8_t has_link_;
  void* const model_;
  CuboctOut out_{};
  uint8_t phases_ = 0;                // that run
  std::array<uint64_t, 4> events_{};  // cycles of each bit of force_event_o
  bool idle_ = true;
  std::optional<uint64_t> cycle_;  // of the run, once it was started
};

// The outputs that belong to the cycle, without the link registers.
void read_outputs(const CuboctOut& from, NodeOutputs& out);

// Compiles (or finds) the plan's node; keeps a reference to `plan`. Throws InputError.
NodeFactory verilated_nodes(const Plan& plan, const std::string& build_directory, uint32_t seed = 0);

}  // namespace cuboct::emu
