// SPDX-License-Identifier: MIT
// `cuboct`: from a scene to its run and report. Other commands are programs beside it (cli/programs.h).
#include "cli/command.h"
#include "cli/front.h"

int main(int argc, char** argv) {
  using namespace cuboct;
  constexpr OwnCommand kOwn[] = {{"new", add_new},         {"check", add_check},
                                 {"run", add_run},         {"crosscheck", add_crosscheck},
                                 {"curves", add_curves},   {"measure", add_measure},
                                 {"picture", add_picture}, {"report", add_report},
                                 {"state", add_state}};
  return front(argc, argv, kOwn);
}
