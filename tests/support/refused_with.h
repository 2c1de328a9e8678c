// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>

#include "model/base/error.h"

namespace cuboct {

// The text of the Error that `act` throws; "accepted" where it throws none.
template <class Error = InputError, class Act>
std::string refused_with(Act&& act) {
  try {
    std::forward<Act>(act)();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace cuboct
