// SPDX-License-Identifier: MIT
// A library that is opened at run time, as not every machine has it.
#pragma once

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

namespace cuboct::gpu {

// Throws Error, whose only argument is its text.
template <class Error>
class OpenedLibrary {
 public:
  // `what` it is, for errors. The first of these names that is there.
  OpenedLibrary(std::string what, const std::vector<std::string>& names) : what_(std::move(what)) {
    for (const std::string& name : names)
      if (!handle_) handle_ = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle_) throw Error(fmt::format("no library {}", fmt::join(names, ", ")));
  }
  ~OpenedLibrary() { dlclose(handle_); }
  OpenedLibrary(const OpenedLibrary&) = delete;
  OpenedLibrary& operator=(const OpenedLibrary&) = delete;

  template <class Function>
  void bind(Function& function, const char* name) const {
    function = reinterpret_cast<Function>(dlsym(handle_, name));
    if (!function) throw Error(fmt::format("{} has no function {}", what_, name));
  }

 private:
  std::string what_;
  void* handle_ = nullptr;
};

}  // namespace cuboct::gpu
