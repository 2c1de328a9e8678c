// SPDX-License-Identifier: MIT
#include "model/base/filled_frame.h"

#include <fmt/format.h>

#include <stdexcept>

namespace cuboct {

std::string filled_frame(std::string_view frame,
                         const std::vector<std::pair<const char*, std::string>>& parts) {
  std::string page;
  size_t from = 0;
  for (const auto& [name, text] : parts) {
    const size_t at = frame.find(name, from);
    if (at == std::string_view::npos) throw std::logic_error(fmt::format("a page has no place {}", name));
    page += frame.substr(from, at - from);
    page += text;
    from = at + std::string_view(name).size();
  }
  page += frame.substr(from);
  return page;
}

}  // namespace cuboct
