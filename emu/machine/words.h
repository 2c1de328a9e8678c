// SPDX-License-Identifier: MIT
// The words of hw/arch/words.h, packed and unpacked: halo records and particles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "emu/machine/bits.h"
#include "hw/plan/plan.h"

namespace cuboct::emu {

// What a pair needs of a candidate; the halo memories hold these in the receiver's own frame.
struct Candidate {
  std::array<int32_t, 3> x{};  // P fractional bits, P+2 bits signed; P <= 30. z stays 0 in a flat plan
  uint8_t type = 0;
  Int3 v{};                     // P+G fractional bits; zero unless the rule reads it
  uint32_t id = 0;              // where the rule reads it; of an own particle always
  std::vector<int64_t> fields;  // of a rule of text: its numbers, those of others as far as they were sent
};

// A place in a particle's row of bonds.
struct Bond {
  uint32_t other = 0;  // the partner's id; where there is no bond, the particle's own
  uint32_t kind = 0;   // as of BondRows
};

// A particle in a slot.
struct Slot {
  Candidate body;                     // x: visible
  std::vector<Bond> bonds;            // of a bonded rule: Words::bonds places
  std::vector<int64_t> bond_numbers;  // of each place FixedProgram::bond_numbers()
  std::array<int32_t, 3> residue{};   // the G bits of the position below those
  Int3 u{};
  std::array<int8_t, 3> away{};  // per axis: nodes still to go, -1, 0, +1
};

// A particle's position with all its P+G fractional bits; put_position drops whole cells.
Int3 position_of(const Widths& widths, const Slot& slot);
void put_position(const Widths& widths, const Int3& x, Slot& slot);

// Throws InputError where a record is wider than `most` bits, or a checked beat than Bits.
void check_words(const Plan& plan, int most = Word::kWidth);

// In place, as a record's way through a link is what a busy lattice does most. `out` must hold zeros. `cell`:
// of a plan with bricks.
void pack_halo(const Plan& plan, const Candidate& candidate, uint32_t cell, std::span<uint64_t> out);
// In the frame of the sender; returns the cell, 0 without bricks.
uint32_t unpack_halo(const Plan& plan, std::span<const uint64_t> bits, Candidate& out);
// The same of a later round's record: its fields alone.
void pack_later(const WordLayout& record, std::span<const int64_t> fields, std::span<uint64_t> out);
void unpack_later(const WordLayout& record, std::span<const uint64_t> bits, std::span<int64_t> fields);
// `out` must hold zeros.
void pack_particle(const Plan& plan, const Slot& slot, std::span<uint64_t> out);
Slot unpack_particle(const Plan& plan, std::span<const uint64_t> bits);

}  // namespace cuboct::emu
