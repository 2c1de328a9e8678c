// SPDX-License-Identifier: MIT
// How terms of energy are put together: events times a technology's figure, or the name of what is missing.
#pragma once

#include <fmt/format.h>

#include "hw/cost/energy.h"

namespace cuboct {

inline Band exact(double value) { return {value, value}; }

// Rows of one result, and what they lack.
class Sheet {
 public:
  Sheet(const Technology& technology, Energy& energy) : technology_(technology), energy_(energy) {}

  // `bits`: of the constant's, for one event. Returns whether the technology has the constant.
  bool add(const std::string& term, double events, const std::string& of, Constant constant,
           const Band& bits) {
    const auto& figure = technology_.at(constant);
    if (!figure) return lacks(term, constant);
    put(term, events, of, events * (bits * figure->band), figure->source);
    return true;
  }
  void memory(const std::string& term, double events, Constant constant, double words, double bits) {
    const auto &figure = technology_.at(constant), &exponent = technology_.at(Constant::memory_exponent);
    if (!figure || !exponent)
      lacks(term, constant);
    else
      put(term, events, "words", events * bits * memory_bit_energy(*figure, *exponent, words),
          figure->source);
  }
  void put(const std::string& term, double events, const std::string& of, const Band& picojoules,
           const std::string& source) {
    energy_.rows.push_back({term, events, of, picojoules, source});
    energy_.sum += picojoules;
  }
  bool lacks(const std::string& term, Constant constant) {
    energy_.missing.push_back(fmt::format("{}: no '{}' in {}", term, name_of(constant), technology_.name));
    return false;
  }

 private:
  const Technology& technology_;
  Energy& energy_;
};

}  // namespace cuboct
