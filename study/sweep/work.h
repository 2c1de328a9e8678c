// SPDX-License-Identifier: MIT
// Independent pieces of work on some threads, with progress and time left.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace cuboct::study {

struct Piece {
  double size = 1;  // any unit; the largest are begun first
  std::function<void()> work;
};

// Done when all are; the first exception of a piece ends the others' beginning and is thrown on. `label`
// begins the line on stderr, where that is a terminal and `progress` is set.
void work_off(std::vector<Piece> pieces, int jobs, const std::string& label, bool progress);

}  // namespace cuboct::study
