// SPDX-License-Identifier: MIT
#include "model/error.h"

#include <fmt/format.h>

namespace cuboct {
namespace {

std::string with_hint(std::string text, const std::string& hint) {
  return hint.empty() ? text : text + "\n  hint: " + hint;
}

}  // namespace

InputError::InputError(const std::string& message, const std::string& hint)
    : std::runtime_error(with_hint(message, hint)) {}

InputError::InputError(const std::string& file, int line, int column, const std::string& message,
                       const std::string& hint)
    : std::runtime_error(with_hint(fmt::format("{}:{}:{}: {}", file, line, column, message), hint)) {}

const char* to_string(Fault fault) {
  switch (fault) {
    case Fault::none:
      return "none";
    case Fault::relative_velocity:
      return "relative velocity out of width";
    case Fault::strength:
      return "pair strength out of width";
    case Fault::sum:
      return "sum of kicks out of width";
    case Fault::displacement:
      return "displacement out of width";
    case Fault::velocity:
      return "velocity out of width";
    case Fault::left_x:
      return "left the lattice along x";
    case Fault::full_x:
      return "node full after moving along x";
    case Fault::left_y:
      return "left the lattice along y";
    case Fault::full_y:
      return "node full after moving along y";
    case Fault::left_z:
      return "left the lattice along z";
    case Fault::full_z:
      return "node full after moving along z";
  }
  return "?";
}

RunError::RunError(Fault fault, uint64_t step, uint32_t node, uint32_t particle, int64_t number,
                   const std::string& where)
    : std::runtime_error(fmt::format("step {}, node {}{}, particle {}: {} ({})", step, node, where, particle,
                                     to_string(fault), number)),
      fault(fault),
      step(step),
      node(node),
      particle(particle),
      number(number) {}

}  // namespace cuboct
