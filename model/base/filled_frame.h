// SPDX-License-Identifier: MIT
// Pages are made of a frame in HTML, and of texts that are ready for their places in it (model/base/text.h,
// model/base/json.h).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cuboct {

// The frame with its places "@name@", in their order, filled.
std::string filled_frame(std::string_view frame,
                         const std::vector<std::pair<const char*, std::string>>& parts);

}  // namespace cuboct
