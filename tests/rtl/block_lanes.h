// SPDX-License-Identifier: MIT
// The ports of the block bench: every field of the blocks' ports has a lane of 64 bits, sign-extended where
// it is signed, at its place in one vector. The wrapper that stands around the blocks is printed from the
// same lists, for the constants of any plan.
#pragma once

#include <cstdint>
#include <string>

#include "hw/plan/plan.h"

namespace cuboct::test {

namespace in {
enum Lane : int {
  pipe_valid,
  pipe_slot,
  own_x,  // 3 lanes
  own_v = own_x + 3,
  own_type = own_v + 3,
  other_x,
  other_v = other_x + 3,
  other_type = other_v + 3,
  update_valid,
  update_slot,
  sum,
  x = sum + 3,
  residue = x + 3,
  v = residue + 3,
  type = v + 3,
  id,
  u,
  r2 = u + 3,  // of the tables alone
  count
};
}  // namespace in

namespace out {
enum Lane : int {
  // What the pipe's stages hold.
  d,
  r2 = d + 3,
  q,       // damped only, else 0
  force,   // of the table
  damped,  // s after damping
  s,
  // The pipe's ports.
  pipe_valid,
  pipe_slot,
  kick,
  pipe_fault = kick + 3,
  pipe_strength,
  pipe_number,
  pipe_busy,
  // The update's ports.
  update_valid,
  update_slot,
  x,
  residue = x + 3,
  away = residue + 3,
  v = away + 3,
  type = v + 3,
  id,
  u,
  fault = u + 3,
  fault_id,
  code,
  number,
  // The tables alone.
  force_table,
  damp_table,
  count
};
}  // namespace out

constexpr int kSlotBits = 4;

// The module cuboct_blocks: cuboct_pipe, cuboct_update and cuboct_pair_table (with its memory) of a plan,
// with the parameters that cuboct_node_core gives them.
std::string print_blocks(const Plan& plan);

}  // namespace cuboct::test
