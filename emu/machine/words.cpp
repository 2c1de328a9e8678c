// SPDX-License-Identifier: MIT
#include "emu/machine/words.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/fixed_math.h"

namespace cuboct::emu {
namespace {

__extension__ typedef unsigned __int128 Wide;

}  // namespace

void check_words(const Plan& plan) {
  const int widest = std::max(plan.words.halo_bits, plan.words.migrate_bits);
  if (widest > Bits::kWidth)
    throw InputError(fmt::format("a record of {} bits: the cycle-accurate engines hold at most {}", widest,
                                 int{Bits::kWidth}));
  if (plan.link.checked() && plan.link.wire_bits + 1 > Bits::kWidth)
    throw InputError(fmt::format("a checked beat of {} bits: the cycle-accurate engines hold at most {}",
                                 plan.link.wire_bits + 1, int{Bits::kWidth}),
                     "use fewer link.bits");
}

void pack_halo(const Plan& plan, const Candidate& candidate, Bits& out) {
  const Widths& w = plan.rule.widths;
  const int p = w.position_frac;
  const Wide mask = (Wide{1} << (p + 2)) - 1;
  const auto signed_field = [&](int a) {
    return static_cast<Wide>(candidate.x[static_cast<size_t>(a)]) & mask;
  };
  const auto last_field = [&](int a) {
    return static_cast<Wide>(candidate.x[static_cast<size_t>(a)] & ((int64_t{1} << p) - 1));
  };
  const int axes = plan.rule.axes;
  // 3P+4 bits: at most 94.
  const Wide xyz = axes == 3 ? signed_field(0) | signed_field(1) << (p + 2) | last_field(2) << (2 * p + 4)
                             : signed_field(0) | last_field(1) << (p + 2);
  out.word[0] = static_cast<uint64_t>(xyz);
  out.word[1] = static_cast<uint64_t>(xyz >> 64);
  int at = axes * p + 2 * (axes - 1);
  const auto field = [&](int width, int64_t value) { out.put(at, width, value), at += width; };
  if (plan.rule.scaled) field(plan.rule.type_bits, candidate.type);
  if (plan.rule.damped)
    for (int a = 0; a < axes; ++a) field(w.velocity_bits, candidate.v[a]);
}

void unpack_halo(const Plan& plan, const Bits& bits, int axis, int64_t shift, Candidate& out) {
  const Widths& w = plan.rule.widths;
  const int p = w.position_frac;
  const Wide xyz = static_cast<Wide>(bits.word[1]) << 64 | bits.word[0];
  const auto signed_field = [&](Wide v) { return wrap(static_cast<int64_t>(v), p + 2); };
  const auto moved = [&](int a, int64_t x) {
    return static_cast<int32_t>(wrap(a == axis ? x + shift : x, p + 2));
  };
  out.x[0] = moved(0, signed_field(xyz));
  const auto last_field = [&](Wide v) { return static_cast<int64_t>(v) & ((int64_t{1} << p) - 1); };
  const int axes = plan.rule.axes;
  if (axes == 3) {
    out.x[1] = moved(1, signed_field(xyz >> (p + 2)));
    out.x[2] = moved(2, last_field(xyz >> (2 * p + 4)));
  } else {
    out.x[1] = moved(1, last_field(xyz >> (p + 2)));
  }
  int at = axes * p + 2 * (axes - 1);
  const auto take = [&](int width) { return at += width, bits.get(at - width, width); };
  const auto take_signed = [&](int width) { return at += width, bits.get_signed(at - width, width); };
  out.type = plan.rule.scaled ? static_cast<uint8_t>(take(plan.rule.type_bits)) : 0;
  if (plan.rule.damped)
    for (int a = 0; a < axes; ++a) out.v[a] = take_signed(w.velocity_bits);
}

void pack_cell_halo(const Plan& plan, const Candidate& candidate, uint32_t cell, Bits& out) {
  const Widths& w = plan.rule.widths;
  int at = 0;
  const auto field = [&](int width, int64_t value) { out.put(at, width, value), at += width; };
  const auto axes = static_cast<size_t>(plan.rule.axes);
  for (size_t a = 0; a < axes; ++a) field(w.position_frac, candidate.x[a]);
  if (plan.rule.scaled) field(plan.rule.type_bits, candidate.type);
  if (plan.rule.damped)
    for (size_t a = 0; a < axes; ++a) field(w.velocity_bits, candidate.v[a]);
  field(plan.words.halo_cell_bits, cell);
}

uint32_t unpack_cell_halo(const Plan& plan, const Bits& bits, Candidate& out) {
  const Widths& w = plan.rule.widths;
  int at = 0;
  const auto take = [&](int width) { return at += width, bits.get(at - width, width); };
  const auto axes = static_cast<size_t>(plan.rule.axes);
  for (size_t a = 0; a < axes; ++a) out.x[a] = static_cast<int32_t>(take(w.position_frac));
  out.type = plan.rule.scaled ? static_cast<uint8_t>(take(plan.rule.type_bits)) : 0;
  if (plan.rule.damped)
    for (size_t a = 0; a < axes; ++a)
      at += w.velocity_bits, out.v[a] = bits.get_signed(at - w.velocity_bits, w.velocity_bits);
  return static_cast<uint32_t>(take(plan.words.halo_cell_bits));
}

Bits pack_particle(const Plan& plan, const Slot& slot) {
  const Widths& w = plan.rule.widths;
  Bits out;
  int at = 0;
  const auto field = [&](int width, int64_t value) { out.put(at, width, value), at += width; };
  const auto axes = static_cast<size_t>(plan.rule.axes);
  for (size_t a = 0; a < axes; ++a) field(w.position_frac, slot.body.x[a]);
  for (size_t a = 1; a < axes; ++a) field(2, slot.away[a]);
  for (size_t a = 0; a < axes; ++a) field(w.velocity_bits, slot.body.v[a]);
  field(plan.rule.type_bits, slot.body.type);
  field(plan.words.id_bits, slot.id);
  for (size_t a = 0; a < axes; ++a) field(w.guard, slot.residue[a]);
  if (plan.rule.pd)
    for (size_t a = 0; a < axes; ++a) field(w.displacement_bits, slot.u[a]);
  return out;
}

Slot unpack_particle(const Plan& plan, const Bits& bits) {
  const Widths& w = plan.rule.widths;
  Slot out;
  int at = 0;
  const auto take = [&](int width) { return at += width, bits.get(at - width, width); };
  const auto take_signed = [&](int width) { return at += width, bits.get_signed(at - width, width); };
  const auto axes = static_cast<size_t>(plan.rule.axes);
  for (size_t a = 0; a < axes; ++a) out.body.x[a] = static_cast<int32_t>(take(w.position_frac));
  for (size_t a = 1; a < axes; ++a) out.away[a] = static_cast<int8_t>(take_signed(2));
  for (size_t a = 0; a < axes; ++a) out.body.v[a] = take_signed(w.velocity_bits);
  out.body.type = static_cast<uint8_t>(take(plan.rule.type_bits));
  out.id = static_cast<uint32_t>(take(plan.words.id_bits));
  for (size_t a = 0; a < axes; ++a) out.residue[a] = static_cast<int32_t>(take(w.guard));
  if (plan.rule.pd)
    for (size_t a = 0; a < axes; ++a) out.u[a] = take_signed(w.displacement_bits);
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
