// SPDX-License-Identifier: MIT
#include "study/sweep/outcome.h"

#include <algorithm>

namespace cuboct::study {

std::string one_line(std::string text) {
  const size_t hint = text.find("\n  hint: ");
  if (hint != std::string::npos) text.replace(hint, 9, "; ");
  std::ranges::replace(text, '\n', ' ');
  return text;
}

}  // namespace cuboct::study
