// SPDX-License-Identifier: MIT
#include "model/base/module.h"

#include <dlfcn.h>

#include <filesystem>

#include "model/base/error.h"
#include "model/base/process.h"

namespace cuboct {

void* module_symbol(const std::string& module, const char* symbol) {
  const std::string here = program_directory() + "/";
  for (const std::string& path : {here + module, here + "../lib/" + module}) {
    if (!std::filesystem::exists(path)) continue;
    void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* found = handle != nullptr ? dlsym(handle, symbol) : nullptr;
    if (found == nullptr) throw InputError(dlerror());
    return found;
  }
  return nullptr;
}

}  // namespace cuboct
