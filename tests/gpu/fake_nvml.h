// SPDX-License-Identifier: MIT
// What the boards of the fake NVML do. A test finds `fake_nvml` in the library with dlsym.
#pragma once

#include <cstdint>

namespace cuboct::test {

struct FakeBoard {
  const char* bus = "";
  // Takes `watts[k]` from time[k] on (s, of the steady clock); time[0] is when the driver was loaded.
  double time[3] = {}, watts[3] = {};
  int pieces = 1;
  double period = 0.02;              // s: energy counter and power reading move so often
  uint64_t counted = 0;              // mJ before time[0]
  double loaded_anew = 1e300;        // s: the counter then starts from 0
  double lost = 1e300;               // s: no call is answered any more
  bool energy = true, power = true;  // supported
  unsigned clock = 0;                // MHz; 0: not supported
};

struct FakeNvml {
  FakeBoard boards[4];
  int count = 0;
  int init = 0;      // what nvmlInit_v2 answers
  int sessions = 0;  // that are open
  // s: where the time stands by which boards live; null: the steady clock's.
  const double* time = nullptr;
};

}  // namespace cuboct::test
