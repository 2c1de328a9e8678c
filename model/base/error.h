// SPDX-License-Identifier: MIT
// The two ways in which cuboct refuses: the input is wrong (exit code 2), or a run found something wrong
// (exit code 1).
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace cuboct {

// Bad input. `what()` is its text in this form (the hint's line only where there is a hint); `told()`, what a
// user sees, has the line of the file between the two, where the error knows it:
//   scenes/a.toml:12:3: unknown key 'capcity'
//     12 |   capcity = 8
//        |   ^
//     hint: did you mean 'capacity'?
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message, const std::string& hint = {});
  // line and column count from 1. `excerpt`: of that line, by model/base/excerpt.h.
  InputError(const std::string& file, int line, int column, const std::string& message,
             const std::string& hint = {}, const std::string& excerpt = {});

  // The same error with another hint.
  InputError with(const std::string& hint) const;

  // The same error about these keys of a file, the likeliest first: "run.dt", "constraint[grip].velocity".
  // Whoever knows where they stand gives it a place (model/base/places.h).
  InputError about(std::vector<std::string> keys) const;
  const std::vector<std::string>& keys() const { return keys_; }

  std::string told() const;

  // {"error":{"message":...,"file":...,"line":...,"column":...,"hint":...}}; null is what it does not know.
  std::string json() const;

  // Where in which file; null where the error does not know it.
  struct Place {
    std::string file;
    int line, column;  // counted from 1
    std::string excerpt;
  };
  const Place* place() const { return place_.get(); }

 private:
  std::shared_ptr<const Place> place_;
  std::vector<std::string> keys_;
};

// The checks that every fixed engine makes, in the order in which a step makes them. When several particles
// fail in one step, all engines report the same one: the least (step, fault, id).
enum class Fault : uint8_t {
  none = 0,
  relative_velocity,  // w of an interacting pair does not fit `relative_velocity_bits`
  strength,           // s of an interacting pair does not fit `strength_bits`
  sum,                // a particle's summed kick does not fit `sum_bits`
  displacement,       // u of a force-held particle does not fit `displacement_bits`
  velocity,           // v does not fit `velocity_bits`; at P+G+1 bits: more than one cell per step
  left_x,             // moved along x out of the lattice
  full_x,             // moved along x into a cell that holds `capacity` particles
  left_y,
  full_y,
  left_z,
  full_z,
  // Of a link whose beats are checked (docs/reference/links.md), in engines that have links. `number` is the
  // face, and no particle is meant.
  link_check,   // a beat, or an acknowledgement, whose check is wrong
  link_order,   // a beat that does not follow the one before it
  link_silent,  // beats whose acknowledgement does not come
  // Of a program whose bonds keep fields: a bond that counts, and whose partner, `number`, is in none of the
  // 27 cells.
  bond_lost,
};

constexpr bool is_of_link(Fault fault) { return fault >= Fault::link_check && fault <= Fault::link_silent; }

const char* to_string(Fault fault);

// A run that had to stop. `number` is the offending value in the integer units of the fixed rule (for
// `full_*`: the capacity). `cell` is an index into the lattice; of a fault of a link the first cell of the
// node whose link it is. `where` follows the index in the text: " at (1, 2, 0)".
class RunError : public std::runtime_error {
 public:
  RunError(Fault fault, uint64_t step, uint32_t cell, uint32_t particle, int64_t number,
           const std::string& where);

  Fault fault;
  uint64_t step;
  uint32_t cell;
  uint32_t particle;
  int64_t number;
};

}  // namespace cuboct
