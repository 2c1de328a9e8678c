// SPDX-License-Identifier: MIT
// In the place of machine_page.cpp where the charting library was not there to be built in.
#include <stdexcept>

#include "study/machines/machine_page.h"

namespace cuboct::study {

std::string machine_page_of(const MachineResults&) {
  throw std::logic_error("machine_page_of without a page");
}

}  // namespace cuboct::study
