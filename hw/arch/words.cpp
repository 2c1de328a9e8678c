// SPDX-License-Identifier: MIT
#include "hw/arch/words.h"

#include <algorithm>
#include <array>
#include <bit>

#include "hw/arch/bricks.h"
#include "model/base/integer_math.h"

namespace cuboct {
namespace {

void add(WordLayout& layout, FieldKind kind, int bits, bool is_signed = false, int axis = -1) {
  if (bits > 0) layout.push_back({kind, axis, bits_of(layout), bits, is_signed});
}

void add_axes(WordLayout& layout, FieldKind kind, int first, int axes, int bits, bool is_signed) {
  for (int a = first; a < axes; ++a) add(layout, kind, bits, is_signed, a);
}

WordLayout particle_layout(const FixedRule& r, int id_bits) {
  const Widths& w = r.widths;
  WordLayout word;
  add_axes(word, FieldKind::position, 0, r.axes, w.position_frac, false);
  add_axes(word, FieldKind::away, 1, r.axes, 2, true);
  add_axes(word, FieldKind::velocity, 0, r.axes, w.velocity_bits, true);
  add(word, FieldKind::type, r.type_bits);
  add(word, FieldKind::id, id_bits);
  add_axes(word, FieldKind::residue, 0, r.axes, w.guard, false);
  if (r.pd) add_axes(word, FieldKind::displacement, 0, r.axes, w.displacement_bits, true);
  return word;
}

// A record goes on along later axes, through nodes beyond the sender's: until the last axis its coordinates
// have a sign and a bit for the cell beside.
WordLayout halo_layout(const FixedRule& r, bool bricks, int cell_bits) {
  const int P = r.widths.position_frac, last = bricks ? 0 : r.axes - 1;
  WordLayout word;
  add_axes(word, FieldKind::position, 0, last, P + 2, true);
  add_axes(word, FieldKind::position, last, r.axes, P, false);
  if (r.scaled) add(word, FieldKind::type, r.type_bits);
  if (r.damped) add_axes(word, FieldKind::velocity, 0, r.axes, r.widths.velocity_bits, true);
  add(word, FieldKind::cell, cell_bits);
  return word;
}

}  // namespace

std::string name_of(const WordField& field) {
  constexpr std::array kNames{"x", "away", "v", "type", "id", "residue", "u", "cell"};
  const std::string name = kNames[static_cast<size_t>(field.kind)];
  return field.axis < 0 ? name : name + "_" + "xyz"[field.axis];
}

int bits_of(const WordLayout& layout) { return layout.empty() ? 0 : layout.back().lsb + layout.back().bits; }

Words words_of(const FixedRule& r, const Arch& arch, uint32_t particles) {
  Words words;
  words.id_bits = std::max(1, static_cast<int>(std::bit_width(particles > 0 ? particles - 1 : 0u)));
  const bool bricks = cells_of(arch.brick) > 1;
  if (bricks) {
    const BrickGrid grid(arch.brick);
    const auto bits = [](uint32_t numbers) { return static_cast<int>(std::bit_width(numbers - 1)); };
    for (int a = 0; a < r.axes; ++a) {
      words.halo_cell_bits = std::max(words.halo_cell_bits, bits(grid.halo_tags(a)));
      words.migrate_cell_bits = std::max(words.migrate_cell_bits, bits(grid.migrate_tags(a)));
    }
  }
  words.particle = particle_layout(r, words.id_bits);
  words.halo = halo_layout(r, bricks, words.halo_cell_bits);
  words.halo_bits = bits_of(words.halo);
  words.particle_bits = bits_of(words.particle);
  words.migrate_bits = words.particle_bits + words.migrate_cell_bits;
  words.link_bits = arch.link_bits > 0 ? arch.link_bits : words.halo_bits;
  words.halo_beats = ceil_div(words.halo_bits, words.link_bits);
  words.migrate_beats = ceil_div(words.migrate_bits, words.link_bits);
  return words;
}

}  // namespace cuboct
