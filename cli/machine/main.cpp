// SPDX-License-Identifier: MIT
// `cuboct-machine`: what is built of a machine, and its cost.
#include "cli/command.h"
#include "cli/front.h"

int main(int argc, char** argv) {
  using namespace cuboct;
  constexpr OwnCommand kOwn[] = {
    {"emit", add_emit},
    {"energy", add_energy},
    {"boards", add_boards},
#if CUBOCT_HAS_SYNTH
    {"synth", add_synth},
#endif
  };
  return front(argc, argv, kOwn);
}
