// SPDX-License-Identifier: MIT
#include "model/base/gnuplot.h"

#include <fmt/format.h>

#include <stdexcept>

#include "model/base/error.h"
#include "model/base/output.h"

namespace cuboct {

void run_gnuplot(const Scratch& scratch, const std::string& script) {
  write_text(scratch.path("script.gp"), script);
  int code = 0;
  try {
    // Scripts are UTF-8, which gnuplot only takes without complaint where the locale is too.
    code = Process("gnuplot", {"-d", scratch.path("script.gp")}, true, {}, {"LC_ALL=C.UTF-8"}).finish();
  } catch (const InputError& error) {
    throw InputError(error.what(), "install gnuplot-nox");
  }
  if (code != 0) throw std::runtime_error(fmt::format("gnuplot ended with exit code {}", code));
}

}  // namespace cuboct
