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

int64_t number_in(const WordField& f, std::span<const uint64_t> bits) {
  return f.is_signed ? get_signed_bits(bits, f.lsb, f.bits)
                     : static_cast<int64_t>(get_bits(bits, f.lsb, f.bits));
}

}  // namespace

void check_words(const Plan& plan, int most) {
  const Words& words = plan.words;
  int halo = words.halo_bits;
  for (const PlanRound& round : plan.rounds) halo = std::max(halo, bits_of(round.record));
  const auto refuse = [&](int bits, const std::string& of, int held) {
    throw InputError(
        fmt::format("a record of {} bits{}: the cycle-accurate engines hold at most {}", bits, of, held))
        .about({"widths.velocity_bits", "widths.displacement_bits", "widths.position_frac", "widths.guard",
                "rule.file", "rule"});
  };
  if (words.migrate_bits > most)
    refuse(words.migrate_bits, words.bonds > 0 ? fmt::format(", {} bonds among them", words.bonds) : "",
           most);
  if (halo > Bits::kWidth) refuse(halo, "", Bits::kWidth);
  const auto refuse_beat = [](const char* beat, int bits) {
    throw InputError(fmt::format("{} of {} bits: the cycle-accurate engines hold at most {}", beat, bits,
                                 int{Bits::kWidth}),
                     "use fewer link.bits")
        .about({"link.bits"});
  };
  // A beat holds no more than the longest record.
  if (const int beat = std::min(words.link_bits, words.migrate_bits); beat > Bits::kWidth)
    refuse_beat("a beat", beat);
  if (plan.link.checked() && plan.link.wire_bits + 1 > Bits::kWidth)
    refuse_beat("a checked beat", plan.link.wire_bits + 1);
}

void pack_halo(const Plan& plan, const Candidate& candidate, uint32_t cell, std::span<uint64_t> out) {
  const WordLayout& word = plan.words.halo;
  const auto axes = static_cast<size_t>(plan.rule.axes);
  // The positions at once: at most 94 bits.
  Wide xyz = 0;
  for (size_t a = 0; a < axes; ++a) {
    const uint64_t mask = (uint64_t{1} << word[a].bits) - 1;
    xyz |= static_cast<Wide>(static_cast<uint64_t>(candidate.x[a]) & mask) << word[a].lsb;
  }
  out[0] = static_cast<uint64_t>(xyz);
  out[1] = static_cast<uint64_t>(xyz >> 64);
  for (size_t k = axes; k < word.size(); ++k) {
    const WordField& f = word[k];
    put_bits(out, f.lsb, f.bits,
             f.kind == FieldKind::velocity ? candidate.v[static_cast<size_t>(f.axis)]
             : f.kind == FieldKind::type   ? candidate.type
             : f.kind == FieldKind::id     ? int64_t{candidate.id}
             : f.kind == FieldKind::field  ? candidate.fields[static_cast<size_t>(f.number)]
                                           : int64_t{cell});
  }
}

uint32_t unpack_halo(const Plan& plan, std::span<const uint64_t> bits, Candidate& out) {
  const WordLayout& word = plan.words.halo;
  const auto axes = static_cast<size_t>(plan.rule.axes);
  const Wide xyz = static_cast<Wide>(bits[1]) << 64 | bits[0];
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
      out.v[static_cast<size_t>(f.axis)] = get_signed_bits(bits, f.lsb, f.bits);
    else if (f.kind == FieldKind::type)
      out.type = static_cast<uint8_t>(get_bits(bits, f.lsb, f.bits));
    else if (f.kind == FieldKind::id)
      out.id = static_cast<uint32_t>(get_bits(bits, f.lsb, f.bits));
    else if (f.kind == FieldKind::field)
      out.fields[static_cast<size_t>(f.number)] = number_in(f, bits);
    else
      cell = static_cast<uint32_t>(get_bits(bits, f.lsb, f.bits));
  }
  return cell;
}

void pack_later(const WordLayout& record, std::span<const int64_t> fields, std::span<uint64_t> out) {
  for (const WordField& f : record) put_bits(out, f.lsb, f.bits, fields[static_cast<size_t>(f.number)]);
}

void unpack_later(const WordLayout& record, std::span<const uint64_t> bits, std::span<int64_t> fields) {
  for (const WordField& f : record) fields[static_cast<size_t>(f.number)] = number_in(f, bits);
}

void pack_particle(const Plan& plan, const Slot& slot, std::span<uint64_t> out) {
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
    put_bits(out, f.lsb, f.bits, value());
  }
}

Slot unpack_particle(const Plan& plan, std::span<const uint64_t> bits) {
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
