// SPDX-License-Identifier: MIT
// What a study of machines asks of FPGAs; a build without synthesis knows none.
#pragma once

#include <string>
#include <vector>

#include "hw/plan/setup.h"
#include "study/machines/machine_runner.h"

namespace cuboct {

std::vector<std::string> fpga_names();
// Before any synthesis.
study::DeviceUse estimated_use(const Plan& plan, const std::string& target);
// Whether yosys is there.
bool can_synthesise();
// By synthesis of one node, all of them counted. Throws InputError where no RTL can be written, Failed where
// a tool failed or somebody interrupted.
study::DeviceUse synthesised_use(const Setup& setup, const std::string& target);

}  // namespace cuboct
