// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/machine/boards.h"
#include "cli/machine/emit.h"
#include "cli/programs.h"

namespace cuboct {

void emit_fitted(const Input&, const std::string&, const std::string&, Emission, const Answer&) {
  refuse_left_out("emit --fit", kSynthesis);
}
DeviceRoom device_room(const Plan&, const std::string&) { refuse_left_out("boards --device", kSynthesis); }
void check_board(const Input&, const Plan&, const State&, const BoardChoice&) {
  fmt::print(stderr, "note: the fit was not checked: this cuboct was built without synthesis\n");
}

}  // namespace cuboct
