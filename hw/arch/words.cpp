// SPDX-License-Identifier: MIT
#include "hw/arch/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <set>
#include <utility>

#include "hw/arch/bricks.h"
#include "model/base/integer_math.h"
#include "model/graph/bond_rows.h"
#include "model/graph/program.h"

namespace cuboct {
namespace {

void add(WordLayout& layout, FieldKind kind, int bits, bool is_signed = false, int axis = -1) {
  if (bits > 0) layout.push_back({kind, axis, bits_of(layout), bits, is_signed});
}

void add_axes(WordLayout& layout, FieldKind kind, int first, int axes, int bits, bool is_signed) {
  for (int a = first; a < axes; ++a) add(layout, kind, bits, is_signed, a);
}

// The field `kind`, as wide as the range asks.
WordField number_of(const WordLayout& layout, FieldKind kind, const graph::Interval& range, int number) {
  const bool is_signed = range.low < 0;
  const auto farthest = static_cast<uint64_t>(std::max(range.high, is_signed ? -(range.low + 1) : 0));
  const int bits = std::max(1, static_cast<int>(std::bit_width(farthest)) + is_signed);
  return {kind, -1, bits_of(layout), bits, is_signed, number};
}

void add_number(WordLayout& layout, const graph::FixedProgram& program, int field, int component) {
  layout.push_back(number_of(layout, FieldKind::field, program.fields[static_cast<size_t>(field)].range,
                             program.place(field) + component));
}

void add_bonds(WordLayout& layout, const graph::FixedProgram& program, int places, int id_bits,
               uint32_t kinds) {
  for (int place = 0; place < places; ++place) {
    const auto in_place = [&](WordField field) {
      field.place = place;
      if (field.bits > 0) layout.push_back(field);
    };
    in_place({FieldKind::bond_other, -1, bits_of(layout), id_bits, false});
    in_place({FieldKind::bond_kind, -1, bits_of(layout), static_cast<int>(std::bit_width(kinds - 1)), false});
    for (int f = 0; f < static_cast<int>(program.bonds.size()); ++f)
      for (int n = 0; n < program.bonds[static_cast<size_t>(f)].numbers; ++n)
        in_place(number_of(layout, FieldKind::bond_field, program.bonds[static_cast<size_t>(f)].range,
                           program.bond_place(f) + n));
  }
}

// What a program's rounds read of the other particle.
struct OtherReads {
  bool type = false, velocity = false, id = false;  // in any round
  // By round, what its record holds: (field, component), each once.
  std::vector<std::vector<std::pair<int, int>>> fields;
};

// A round sends what it reads and what no round before sent, or a finish has changed since.
OtherReads reads_of(const graph::FixedProgram& program) {
  OtherReads reads;
  reads.id = program.bonded;  // the filter asks for it
  std::set<std::pair<int, int>> there;
  for (const graph::Round& round : program.rounds) {
    std::vector<int> needed = pair_outputs(round);
    needed.push_back(round.when);
    std::set<std::pair<int, int>> read;
    for (const int n : graph::needed_by(round.pair, needed)) {
      const graph::Node& node = round.pair.nodes[static_cast<size_t>(n)];
      if (node.op != graph::Op::input) continue;
      using graph::Source;
      const bool types = node.source == Source::other_constant || node.source == Source::pair_constant;
      reads.type = reads.type || (types && program.types > 1);
      reads.velocity = reads.velocity || node.source == Source::other_v;
      reads.id = reads.id || node.source == Source::other_id;
      if (node.source == Source::other_field) read.emplace(node.index, node.axis);
    }
    auto& sent = reads.fields.emplace_back();
    std::ranges::set_difference(read, there, std::back_inserter(sent));
    there.insert(sent.begin(), sent.end());
    for (const graph::Write& write : round.writes) there.erase({write.field, write.component});
  }
  return reads;
}

WordLayout particle_layout(const FixedRule& r, int id_bits, const graph::FixedProgram* program) {
  const Widths& w = r.widths;
  WordLayout word;
  add_axes(word, FieldKind::position, 0, r.axes, w.position_frac, false);
  add_axes(word, FieldKind::away, 1, r.axes, 2, true);
  add_axes(word, FieldKind::velocity, 0, r.axes, w.velocity_bits, true);
  add(word, FieldKind::type, r.type_bits);
  for (int f = 0; program != nullptr && f < static_cast<int>(program->fields.size()); ++f)
    for (int n = 0; n < program->fields[static_cast<size_t>(f)].numbers; ++n)
      add_number(word, *program, f, n);
  add(word, FieldKind::id, id_bits);
  add_axes(word, FieldKind::residue, 0, r.axes, w.guard, false);
  if (r.pd) add_axes(word, FieldKind::displacement, 0, r.axes, w.displacement_bits, true);
  return word;
}

// A record goes on along later axes, through nodes beyond the sender's: until the last axis its coordinates
// have a sign and a bit for the cell beside.
WordLayout halo_layout(const FixedRule& r, bool bricks, int cell_bits, int id_bits,
                       const graph::FixedProgram* program, const OtherReads& reads) {
  const int P = r.widths.position_frac, last = bricks ? 0 : r.axes - 1;
  WordLayout word;
  add_axes(word, FieldKind::position, 0, last, P + 2, true);
  add_axes(word, FieldKind::position, last, r.axes, P, false);
  if (r.scaled || reads.type) add(word, FieldKind::type, r.type_bits);
  if (reads.id) add(word, FieldKind::id, id_bits);
  if (r.damped || reads.velocity)
    add_axes(word, FieldKind::velocity, 0, r.axes, r.widths.velocity_bits, true);
  if (program != nullptr)
    for (const auto& [field, component] : reads.fields.front()) add_number(word, *program, field, component);
  add(word, FieldKind::cell, cell_bits);
  return word;
}

}  // namespace

std::string name_of(const WordField& field) {
  constexpr std::array kNames{"x", "away",  "v",     "type", "id",     "residue",
                              "u", "field", "other", "kind", "number", "cell"};
  std::string name = kNames[static_cast<size_t>(field.kind)];
  if (field.place >= 0) name = fmt::format("bond_{}_{}", field.place, name);
  if (field.kind == FieldKind::field || field.kind == FieldKind::bond_field)
    name += fmt::format("_{}", field.number);
  return field.axis < 0 ? name : name + "_" + "xyz"[field.axis];
}

int bits_of(const WordLayout& layout) { return layout.empty() ? 0 : layout.back().lsb + layout.back().bits; }

Words words_of(const FixedRule& r, const Arch& arch, uint32_t particles, const graph::FixedProgram* program,
               const graph::BondRows* rows) {
  Words words;
  const OtherReads reads = program == nullptr ? OtherReads() : reads_of(*program);
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
  words.particle = particle_layout(r, words.id_bits, program);
  if (rows != nullptr) {
    words.bonds = static_cast<int>(rows->longest());
    add_bonds(words.particle, *program, words.bonds, words.id_bits, rows->kinds());
  }
  words.halo = halo_layout(r, bricks, words.halo_cell_bits, words.id_bits, program, reads);
  words.halo_bits = bits_of(words.halo);
  words.particle_bits = bits_of(words.particle);
  words.migrate_bits = words.particle_bits + words.migrate_cell_bits;
  int widest = words.halo_bits;
  for (size_t k = 1; k < reads.fields.size(); ++k) {
    WordLayout& later = words.later.emplace_back();
    for (const auto& [field, component] : reads.fields[k]) add_number(later, *program, field, component);
    widest = std::max(widest, bits_of(later));
  }
  words.link_bits = arch.link_bits > 0 ? arch.link_bits : widest;
  words.halo_beats = ceil_div(words.halo_bits, words.link_bits);
  words.migrate_beats = ceil_div(words.migrate_bits, words.link_bits);
  return words;
}

}  // namespace cuboct
