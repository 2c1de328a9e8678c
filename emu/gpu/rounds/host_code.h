// SPDX-License-Identifier: MIT
// Kernels of rounds for engines with loops in their place, where there is no device: by the host's compiler.
#pragma once

#include <string>

namespace cuboct::gpu {

// As compiled_file (nvrtc.h): a shared library. InputError where the compiler fails.
std::string host_file(const std::string& source, const std::string& directory);

}  // namespace cuboct::gpu
