// SPDX-License-Identifier: MIT
#include "model/base/names_in.h"

#include <dirent.h>

#include <memory>
#include <string_view>

namespace cuboct {

std::vector<std::string> names_in(const std::string& directory) {
  const std::unique_ptr<DIR, int (*)(DIR*)> open(opendir(directory.c_str()), closedir);
  std::vector<std::string> names;
  if (!open) return names;
  while (const dirent* const entry = readdir(open.get()))
    if (const std::string_view name = entry->d_name; name != "." && name != "..") names.emplace_back(name);
  return names;
}

}  // namespace cuboct
