// SPDX-License-Identifier: MIT
// Whether a text is UTF-8 (RFC 3629).
#pragma once

#include <string>
#include <string_view>

namespace cuboct {

// The first byte that no such text has there; npos where there is none.
size_t not_utf8(std::string_view text);

// InputError at the first byte of a file's text that is no UTF-8, or is 0.
void check_utf8(const std::string& text, const std::string& path);

}  // namespace cuboct
