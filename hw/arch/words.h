// SPDX-License-Identifier: MIT
// The words that nodes hold and send: which bits are which. The engines pack by these lists, the bench of an
// emitted project compares by them, and docs/reference/node.md ("Words") is held to them by a test.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/arch/arch.h"
#include "model/contract/fixed_rule.h"

namespace cuboct {

namespace graph {
struct FixedProgram;
struct BondRows;
}  // namespace graph

enum class FieldKind : uint8_t {
  position,  // the P visible bits, which forces and links see
  away,      // cells still to go along the axis: -1, 0, +1
  velocity,  // P+G fractional bits
  type,
  id,
  residue,       // the G bits of the position below the visible ones
  displacement,  // P+G fractional bits; of particles held by force
  field,         // a number that a rule of text keeps of a particle
  // Of a place in the particle's row of bonds:
  bond_other,  // the partner's id; where there is no bond, the particle's own
  bond_kind,   // whose constants it has, as BondRows counts them
  bond_field,  // a number that rounds write of it
  cell         // with bricks: as hw/arch/bricks.h numbers it
};

struct WordField {
  FieldKind kind;
  int axis;  // 0, 1, 2; -1 where there is one for all
  int lsb, bits;
  bool is_signed;  // two's complement
  int number = 0;  // of a field: which of FixedProgram::numbers(); of a bond's, of bond_numbers()
  int place = -1;  // in the row of bonds
  bool operator==(const WordField&) const = default;
};
// "x_y": the position along y; "id"; "bond_3_other".
std::string name_of(const WordField& field);

// Least significant field first, without gaps; a field of no bits is left out.
using WordLayout = std::vector<WordField>;
int bits_of(const WordLayout& layout);

// A flat plan (rule.axes 2) has nothing of z. Every layout begins with the positions.
struct Words {
  // The word of the load and observe ports. What the force engine reads of it lies below the id, so that its
  // memories hold no residue.
  WordLayout particle;
  // Coordinates in the sender's frame: all but the last axis signed. With bricks those in the record's own
  // cell, unsigned, and which cell that is.
  WordLayout halo;
  // Of a rule of several rounds: what the records of later ones hold, fields alone, in the order of the first
  // round's records. One may be empty: its stream is an end beat.
  std::vector<WordLayout> later;
  int id_bits = 0;
  int halo_bits = 0;
  int particle_bits = 0;
  int halo_beats = 0;                             // ceil(halo_bits / link_bits)
  int migrate_beats = 0;                          // ceil(migrate_bits / link_bits)
  int migrate_bits = 0;                           // a particle, and with bricks the cell that it goes to
  int halo_cell_bits = 0, migrate_cell_bits = 0;  // 0 without bricks
  int bonds = 0;                                  // places of a particle's row
  int link_bits = 0;  // as built: arch.link_bits, or the widest of all rounds' records
};

// `program`: of a rule of text; null: the pair law. `rows`: of a bonded one; each particle has as many places
// as the longest row has bonds.
Words words_of(const FixedRule& rule, const Arch& arch, uint32_t particles,
               const graph::FixedProgram* program = nullptr, const graph::BondRows* rows = nullptr);

}  // namespace cuboct
