// SPDX-License-Identifier: MIT
// What a result was made of, as the name under which it is kept.
#pragma once

#include <string>
#include <string_view>

#include "model/base/hash.h"

namespace cuboct::synth {

class InputKey {
 public:
  InputKey& add(std::string_view text);
  // The lines that are no comments: these name the plan that a file was made from, and what the hardware is
  // stands in the others.
  InputKey& add_code(const std::string& text);
  std::string text() const;  // 16 hexadecimal digits

 private:
  Hash hash_;
};

}  // namespace cuboct::synth
