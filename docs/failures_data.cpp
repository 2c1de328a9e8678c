// SPDX-License-Identifier: MIT
// Prints a curve of a trace: "step value" lines. usage: failures_data TRACE CURVE
#include <cstdio>
#include <cstring>

#include "model/trace.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  for (const cuboct::Curve& curve : cuboct::read_trace(argv[1]).curves)
    if (curve.name == argv[2]) {
      for (size_t k = 0; k < curve.step.size(); ++k)
        std::printf("%llu %.9g\n", static_cast<unsigned long long>(curve.step[k]), curve.value[k]);
      return 0;
    }
  return 1;
}
