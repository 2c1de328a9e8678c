// SPDX-License-Identifier: MIT
// Which particles have bonds, and what of a bond never changes: plain data that engines of programs share.
#pragma once

#include <cstdint>
#include <vector>

namespace cuboct::graph {

// Each bond is there twice, once from each end. Numbers that rounds write are not here, but in a State.
struct BondRows {
  std::vector<uint64_t> first;     // [id]: where the particle's row begins; one more at the end
  std::vector<uint32_t> other;     // [bond]: the partner's id, ascending in a row
  std::vector<uint32_t> kind;      // [bond]: bonds that have the same constants are of one kind
  std::vector<int64_t> constants;  // of each kind all FixedProgram::bond_constants

  // The same bond from its other end.
  uint64_t twin(uint32_t id, uint64_t bond) const;
  uint64_t longest() const;  // row
  uint32_t kinds() const;    // one at least
};

// State::bond_begin, of so many numbers of each bond.
std::vector<uint64_t> begins_of(const BondRows& rows, int numbers);

}  // namespace cuboct::graph
