// SPDX-License-Identifier: MIT
// `cuboct-study`: many runs, and what is found from them.
#include "cli/command.h"
#include "cli/front.h"
#include "cli/study/learn.h"

int main(int argc, char** argv) {
  using namespace cuboct;
  constexpr OwnCommand kOwn[] = {
    {"elastic", add_elastic},
    {"multiscale", add_multiscale},
#if CUBOCT_HAS_STUDIES
    {"explore", add_explore},
    {"pitch", add_pitch},
    {"stability", add_stability},
#endif
#if CUBOCT_HAS_FITS
    {"fit", add_fit},
#endif
#if CUBOCT_HAS_LEARNING
    {"learn", add_learn},
#endif
  };
  return front(argc, argv, kOwn);
}
