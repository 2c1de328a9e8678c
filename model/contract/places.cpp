// SPDX-License-Identifier: MIT
#include "model/contract/places.h"

#include "model/base/error.h"

namespace cuboct {

void Places::fail(const std::vector<std::string>& paths, const std::string& message,
                  const std::string& hint) const {
  for (const std::string& path : paths)
    if (const auto found = at_.find(path); found != at_.end())
      throw InputError(file_, found->second.line, found->second.column, message, hint, found->second.excerpt);
  throw InputError(message, hint);
}

}  // namespace cuboct
