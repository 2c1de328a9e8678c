// SPDX-License-Identifier: MIT
#include "cli/launch.h"

#include <filesystem>

namespace cuboct {

std::string program_directory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

}  // namespace cuboct
