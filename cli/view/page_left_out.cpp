// SPDX-License-Identifier: MIT
// In the place of saved_page.cpp where three.js was not there to be built in.
#include <stdexcept>

#include "cli/view/saved_page.h"

namespace cuboct {

bool has_view_page() { return false; }
std::string saved_page(const StoredRun&, size_t, size_t) {
  throw std::logic_error("saved_page without a page");
}
std::string saved_page(const ComparedRuns&, size_t, size_t) {
  throw std::logic_error("saved_page without a page");
}
std::string served_page() { throw std::logic_error("served_page without a page"); }

}  // namespace cuboct
