// SPDX-License-Identifier: MIT
// An error's text in its parts, to tell it again at another place.
#pragma once

#include <string>

#include "model/base/error.h"

namespace cuboct {

struct ErrorParts {
  std::string message, hint;  // an empty hint: there is none
};
ErrorParts parts_of(const InputError& error);
// Of the text of an error without a place, as what() tells it.
InputError error_of(const std::string& text);

// The message without the file, line and column before it.
std::string bare_message(const InputError& error);

}  // namespace cuboct
