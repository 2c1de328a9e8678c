// SPDX-License-Identifier: MIT
#include "cli/study/machine_devices.h"

namespace cuboct {

std::vector<std::string> fpga_names() { return {}; }
study::DeviceUse estimated_use(const Plan&, const std::string&) { return {}; }
bool can_synthesise() { return false; }
study::DeviceUse synthesised_use(const Setup&, const std::string&) { return {}; }

}  // namespace cuboct
