// SPDX-License-Identifier: MIT
#include "emu/machine/words.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

__extension__ typedef unsigned __int128 Wide;

size_t numbers_of(const Plan& plan) {
  return plan.program ? static_cast<size_t>(plan.program->program.numbers()) : 0;
}

size_t bond_numbers_of(const Plan& plan) {
  return plan.program ? static_cast<size_t>(plan.program->program.bond_numbers()) : 0;
}

int64_t number_in(const WordField& f, const Bits& bits) {
  return f.is_signed ? bits.get_signed(f.lsb, f.bits) : static_cast<int64_t>(bits.get(f.lsb, f.bits));
}

}  // namespace

void check_words(const Plan& plan, int most) {
  int widest = std::max(plan.words.halo_bits, plan.words.migrate_bits);
  for (const PlanRound& round : plan.rounds) widest = std::max(widest, bits_of(round.record));
  if (widest > most) {
    const int bonds = plan.words.bonds;
    throw InputError(fmt::format("a record of {} bits{}: the cycle-accurate engines hold at most {}", widest,
                                 bonds > 0 ? fmt::format(" with {} bonds", bonds) : std::string(), most))
        .about({"widths.velocity_bits", "widths.displacement_bits", "widths.position_frac", "widths.guard",
                "rule.file", "rule"});
  }
  if (plan.link.checked() && plan.link.wire_bits + 1 > kBeatBits)
    throw InputError(fmt::format("a checked beat of {} bits: the cycle-accurate engines hold at most {}",
                                 plan.link.wire_bits + 1, kBeatBits),
                     "use fewer link.bits")
        .about({"link.bits"});
}

void pack_halo(const Plan& plan, const Candidate& candidate, uint32_t cell, Bits& out) {
  const WordLayout& word = plan.words.halo;
  const auto axes = static_cast<size_t>(plan.rule.axes);
  // The positions at once: at most 94 bits.
  Wide xyz = 0;
  for (size_t a = 0; a < axes; ++a) {
    const uint64_t mask = (uint64_t{1} << word[a].bits) - 1;
    xyz |= static_cast<Wide>(static_cast<uint64_t>(candidate.x[a]) & mask) << word[a].lsb;
  }
  out.word[0] = static_cast<uint64_t>(xyz);
  out.word[1] = static_cast<uint64_t>(xyz >> 64);
  for (size_t k = axes; k < word.size(); ++k) {
    const WordField& f = word[k];
    out.put(f.lsb, f.bits,
            f.kind == FieldKind::velocity ? candidate.v[static_cast<size_t>(f.axis)]
            : f.kind == FieldKind::type   ? candidate.type
            : f.kind == FieldKind::id     ? int64_t{candidate.id}
            : f.kind == FieldKind::field  ? candidate.fields[static_cast<size_t>(f.number)]
                                          : int64_t{cell});
  }
}

uint32_t unpack_halo(const Plan& plan, const Bits& bits, Candidate& out) {
  const WordLayout& word = plan.words.halo;
  const auto axes = static_cast<size_t>(plan.rule.axes);
  const Wide xyz = static_cast<Wide>(bits.word[1]) << 64 | bits.word[0];
  for (size_t a = 0; a < axes; ++a) {
    const auto x = static_cast<uint64_t>(xyz >> word[a].lsb);
    const int above = 64 - word[a].bits;
    out.x[a] = static_cast<int32_t>(word[a].is_signed ? static_cast<int64_t>(x << above) >> above
                                                      : static_cast<int64_t>(x << above >> above));
  }
  uint32_t cell = 0;
  out.type = 0;
  out.fields.resize(numbers_of(plan));
  for (size_t k = axes; k < word.size(); ++k) {
    const WordField& f = word[k];
    if (f.kind == FieldKind::velocity)
      out.v[static_cast<size_t>(f.axis)] = bits.get_signed(f.lsb, f.bits);
    else if (f.kind == FieldKind::type)
      out.type = static_cast<uint8_t>(bits.get(f.lsb, f.bits));
    else if (f.kind == FieldKind::id)
      out.id = static_cast<uint32_t>(bits.get(f.lsb, f.bits));
    else if (f.kind == FieldKind::field)
      out.fields[static_cast<size_t>(f.number)] = number_in(f, bits);
    else
      cell = static_cast<uint32_t>(bits.get(f.lsb, f.bits));
  }
  return cell;
}

void pack_later(const WordLayout& record, std::span<const int64_t> fields, Bits& out) {
  for (const WordField& f : record) out.put(f.lsb, f.bits, fields[static_cast<size_t>(f.number)]);
}

void unpack_later(const WordLayout& record, const Bits& bits, std::span<int64_t> fields) {
  for (const WordField& f : record) fields[static_cast<size_t>(f.number)] = number_in(f, bits);
}

Bits pack_particle(const Plan& plan, const Slot& slot) {
  Bits out;
  const size_t numbers = bond_numbers_of(plan);
  for (const WordField& f : plan.words.particle) {
    const auto a = static_cast<size_t>(std::max(f.axis, 0));
    const auto value = [&]() -> int64_t {
      switch (f.kind) {
        case FieldKind::position:
          return slot.body.x[a];
        case FieldKind::away:
          return slot.away[a];
        case FieldKind::velocity:
          return slot.body.v[a];
        case FieldKind::type:
          return slot.body.type;
        case FieldKind::id:
          return slot.body.id;
        case FieldKind::residue:
          return slot.residue[a];
        case FieldKind::displacement:
          return slot.u[a];
        case FieldKind::field:
          return slot.body.fields[static_cast<size_t>(f.number)];
        case FieldKind::bond_other:
          return slot.bonds[static_cast<size_t>(f.place)].other;
        case FieldKind::bond_kind:
          return slot.bonds[static_cast<size_t>(f.place)].kind;
        case FieldKind::bond_field:
          return slot.bond_numbers[static_cast<size_t>(f.place) * numbers + static_cast<size_t>(f.number)];
        case FieldKind::cell:
          break;
      }
      return 0;
    };
    out.put(f.lsb, f.bits, value());
  }
  return out;
}

Slot unpack_particle(const Plan& plan, const Bits& bits) {
  Slot out;
  out.body.fields.resize(numbers_of(plan));
  const size_t numbers = bond_numbers_of(plan);
  out.bonds.resize(static_cast<size_t>(plan.words.bonds));
  out.bond_numbers.resize(out.bonds.size() * numbers);
  for (const WordField& f : plan.words.particle) {
    const auto a = static_cast<size_t>(std::max(f.axis, 0));
    const int64_t value = number_in(f, bits);
    switch (f.kind) {
      case FieldKind::position:
        out.body.x[a] = static_cast<int32_t>(value);
        break;
      case FieldKind::away:
        out.away[a] = static_cast<int8_t>(value);
        break;
      case FieldKind::velocity:
        out.body.v[a] = value;
        break;
      case FieldKind::type:
        out.body.type = static_cast<uint8_t>(value);
        break;
      case FieldKind::id:
        out.body.id = static_cast<uint32_t>(value);
        break;
      case FieldKind::residue:
        out.residue[a] = static_cast<int32_t>(value);
        break;
      case FieldKind::displacement:
        out.u[a] = value;
        break;
      case FieldKind::field:
        out.body.fields[static_cast<size_t>(f.number)] = value;
        break;
      case FieldKind::bond_other:
        out.bonds[static_cast<size_t>(f.place)].other = static_cast<uint32_t>(value);
        break;
      case FieldKind::bond_kind:
        out.bonds[static_cast<size_t>(f.place)].kind = static_cast<uint32_t>(value);
        break;
      case FieldKind::bond_field:
        out.bond_numbers[static_cast<size_t>(f.place) * numbers + static_cast<size_t>(f.number)] = value;
        break;
      case FieldKind::cell:
        break;
    }
  }
  return out;
}

Int3 position_of(const Widths& w, const Slot& slot) {
  Int3 x{};
  for (size_t a = 0; a < 3; ++a) x[a] = int64_t{slot.body.x[a]} << w.guard | slot.residue[a];
  return x;
}

void put_position(const Widths& w, const Int3& x, Slot& slot) {
  for (size_t a = 0; a < 3; ++a) {
    slot.body.x[a] = static_cast<int32_t>(x[a] >> w.guard & ((int64_t{1} << w.position_frac) - 1));
    slot.residue[a] = static_cast<int32_t>(x[a] & ((int64_t{1} << w.guard) - 1));
  }
}

}  // namespace cuboct::emu
