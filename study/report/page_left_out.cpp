// SPDX-License-Identifier: MIT
// In the place of page.cpp where the charting library was not there to be built in.
#include <stdexcept>

#include "study/report/page.h"

namespace cuboct::study {

bool has_page() { return false; }

std::string page_of(const Results&) { throw std::logic_error("page_of without a page"); }
void write_page(const Results& results, const std::string&) { page_of(results); }

}  // namespace cuboct::study
