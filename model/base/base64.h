// SPDX-License-Identifier: MIT
// Base64 with padding (RFC 4648, section 4): inline binary data of VTK files, pictures inside a report.
#pragma once

#include <cstddef>
#include <string>

namespace cuboct {

std::string base64(const void* data, size_t bytes);

}  // namespace cuboct
