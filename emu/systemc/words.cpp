// SPDX-License-Identifier: MIT
#include "emu/systemc/words.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/fixed_math.h"

namespace cuboct::emu {
namespace {

__extension__ typedef unsigned __int128 Wide;

}  // namespace

void check_words(const Plan& plan) {
  const int widest = std::max(plan.words.halo_bits, plan.words.particle_bits);
  if (widest > Bits::kWidth)
    throw InputError(fmt::format("a record of {} bits: the cycle-accurate engines hold at most {}", widest,
                                 int{Bits::kWidth}));
}

void pack_halo(const Plan& plan, const Candidate& candidate, Bits& out) {
  const Widths& w = plan.rule.widths;
  const int p = w.position_frac;
  const Wide mask = (Wide{1} << (p + 2)) - 1;
  const auto signed_field = [&](int a) {
    return static_cast<Wide>(candidate.x[static_cast<size_t>(a)]) & mask;
  };
  // 3P+4 bits: at most 94.
  const Wide xyz = signed_field(0) | signed_field(1) << (p + 2) |
                   static_cast<Wide>(candidate.x[2] & ((int64_t{1} << p) - 1)) << (2 * p + 4);
  out.word[0] = static_cast<uint64_t>(xyz);
  out.word[1] = static_cast<uint64_t>(xyz >> 64);
  int at = 3 * p + 4;
  const auto field = [&](int width, int64_t value) { out.put(at, width, value), at += width; };
  if (plan.rule.scaled) field(plan.rule.type_bits, candidate.type);
  if (plan.rule.damped)
    for (const int64_t v : candidate.v) field(w.velocity_bits, v);
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
  out.x[1] = moved(1, signed_field(xyz >> (p + 2)));
  out.x[2] = moved(2, static_cast<int64_t>(xyz >> (2 * p + 4)) & ((int64_t{1} << p) - 1));
  int at = 3 * p + 4;
  const auto take = [&](int width) { return at += width, bits.get(at - width, width); };
  const auto take_signed = [&](int width) { return at += width, bits.get_signed(at - width, width); };
  out.type = plan.rule.scaled ? static_cast<uint8_t>(take(plan.rule.type_bits)) : 0;
  if (plan.rule.damped)
    for (int64_t& v : out.v) v = take_signed(w.velocity_bits);
}

Bits pack_particle(const Plan& plan, const Slot& slot) {
  const Widths& w = plan.rule.widths;
  Bits out;
  int at = 0;
  const auto field = [&](int width, int64_t value) { out.put(at, width, value), at += width; };
  for (const int32_t x : slot.body.x) field(w.position_frac, x);
  field(2, slot.away[1]);
  field(2, slot.away[2]);
  for (const int64_t v : slot.body.v) field(w.velocity_bits, v);
  field(plan.rule.type_bits, slot.body.type);
  field(plan.words.id_bits, slot.id);
  if (plan.rule.pd)
    for (const int64_t u : slot.u) field(w.displacement_bits, u);
  return out;
}

Slot unpack_particle(const Plan& plan, const Bits& bits) {
  const Widths& w = plan.rule.widths;
  Slot out;
  int at = 0;
  const auto take = [&](int width) { return at += width, bits.get(at - width, width); };
  const auto take_signed = [&](int width) { return at += width, bits.get_signed(at - width, width); };
  for (int32_t& x : out.body.x) x = static_cast<int32_t>(take(w.position_frac));
  out.away[1] = static_cast<int8_t>(take_signed(2));
  out.away[2] = static_cast<int8_t>(take_signed(2));
  for (int64_t& v : out.body.v) v = take_signed(w.velocity_bits);
  out.body.type = static_cast<uint8_t>(take(plan.rule.type_bits));
  out.id = static_cast<uint32_t>(take(plan.words.id_bits));
  if (plan.rule.pd)
    for (int64_t& u : out.u) u = take_signed(w.displacement_bits);
  return out;
}

}  // namespace cuboct::emu
