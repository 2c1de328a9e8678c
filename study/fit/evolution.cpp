// SPDX-License-Identifier: MIT
#include "study/fit/evolution.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

#include "model/base/error.h"
#include "model/base/process.h"

namespace cuboct::fit {
namespace {

// Stays loaded, as what it makes may live as long as the program.
MakeGenerations* find_maker() {
  const std::string path = program_directory() + "/" + kEvolutionModule;
  if (!std::filesystem::exists(path))
    throw InputError("no module " + path + ", which 'cuboct fit' needs",
                     "it is built beside cuboct; an installation has none");
  void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* maker = module != nullptr ? dlsym(module, kMakeGenerations) : nullptr;
  if (maker == nullptr) throw InputError(dlerror());
  return reinterpret_cast<MakeGenerations*>(maker);
}

}  // namespace

Evolution::Evolution(const std::vector<double>& start, double start_loss, unsigned samples, double spread,
                     unsigned seed)
    : generations_(find_maker()(start, start_loss, samples, spread, seed)) {}

}  // namespace cuboct::fit
