// SPDX-License-Identifier: MIT
#include "model/base/module.h"

#include <dlfcn.h>

#include <filesystem>
#include <utility>

#include "model/base/error.h"
#include "model/base/process.h"

namespace cuboct {
namespace {
std::vector<std::string> other_directories;
}

void look_for_parts_in(std::vector<std::string> directories) { other_directories = std::move(directories); }

std::string part_path(const std::string& name) {
  std::vector<std::string> directories = other_directories;
  directories.push_back(program_directory());
  directories.push_back(program_directory() + "/../lib");
  for (const std::string& directory : directories)
    if (const std::string path = directory + "/" + name; std::filesystem::is_regular_file(path)) return path;
  return {};
}

void* module_symbol(const std::string& name, const char* symbol) {
  const std::string path = part_path(name);
  if (path.empty()) return nullptr;
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* found = handle != nullptr ? dlsym(handle, symbol) : nullptr;
  if (found == nullptr) throw InputError(dlerror());
  return found;
}

}  // namespace cuboct
