// SPDX-License-Identifier: MIT
#include "model/base/places.h"

#include "model/base/error_parts.h"

namespace cuboct {

const Places::Place* Places::find(const std::vector<std::string>& paths) const {
  for (const std::string& path : paths) {
    // What [run] has stands in a stage itself.
    const std::string own = stage_ + (path.starts_with("run.") ? path.substr(4) : path);
    for (const std::string& one : {own, path})
      if (const auto found = at_.find(one); found != at_.end()) return &found->second;
  }
  return nullptr;
}

void Places::fail(const std::vector<std::string>& paths, const std::string& message,
                  const std::string& hint) const {
  throw placed(InputError(message, hint).about(paths));
}

InputError Places::placed(const InputError& error) const {
  const Place* at = error.place() ? nullptr : find(error.keys());
  if (!at) return error;
  return {file_, at->line, at->column, bare_message(error), parts_of(error).hint, at->excerpt};
}

}  // namespace cuboct
