// SPDX-License-Identifier: MIT
#include "emu/systemc/force_clock.h"

#include <tuple>

namespace cuboct::emu {

void FaultKeeper::add(Fault new_code, uint32_t new_id, int64_t new_number, uint32_t in_cell) {
  if (new_code == Fault::none) return;
  if (code == Fault::none || std::tie(new_code, new_id, new_number) < std::tie(code, id, number))
    code = new_code, id = new_id, number = new_number, cell = in_cell;
}

}  // namespace cuboct::emu
