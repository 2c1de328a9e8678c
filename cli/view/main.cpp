// SPDX-License-Identifier: MIT
// `cuboct-view`: a run as a page in a browser.
#include "cli/command.h"
#include "cli/front.h"

int main(int argc, char** argv) {
  using namespace cuboct;
  constexpr OwnCommand kOwn[] = {{"view", add_view}};
  return front(argc, argv, kOwn);
}
