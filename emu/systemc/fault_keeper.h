// SPDX-License-Identifier: MIT
// The fault that a node of SystemC reports.
#pragma once

#include <cstdint>
#include <tuple>

#include "model/base/error.h"

namespace cuboct::emu {

// The least (stage, code, id, number) of a step, and in which of the node's cells it was found.
struct FaultKeeper {
  Fault code = Fault::none;
  uint32_t id = 0;
  int64_t number = 0;
  uint32_t cell = 0;
  int stage = 0;  // NodeOutputs::fault_stage of the fault; of the pair law 0
  int now = 0;    // that of what is added

  void add(Fault new_code, uint32_t new_id, int64_t new_number, uint32_t in_cell) {
    if (new_code == Fault::none) return;
    if (code == Fault::none ||
        std::tie(now, new_code, new_id, new_number) < std::tie(stage, code, id, number))
      *this = {new_code, new_id, new_number, in_cell, now, now};
  }
};

}  // namespace cuboct::emu
