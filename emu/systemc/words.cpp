// SPDX-License-Identifier: MIT
#include "emu/systemc/words.h"

#include <fmt/format.h>

namespace cuboct::emu {

void check_words(const Plan& plan) {
  const int widest = std::max(plan.words.halo_bits, plan.words.particle_bits);
  if (widest > Bits::kWidth)
    throw InputError(fmt::format("a record of {} bits: the cycle-accurate engines hold at most {}", widest,
                                 int{Bits::kWidth}));
}

Bits pack_halo(const Plan& plan, const Candidate& candidate) {
  const Widths& w = plan.rule.widths;
  Bits out;
  int at = 0;
  const auto field = [&](int width, int64_t value) { out.put(at, width, value), at += width; };
  field(w.position_frac + 2, candidate.x[0]);
  field(w.position_frac + 2, candidate.x[1]);
  field(w.position_frac, candidate.x[2]);
  if (plan.rule.scaled) field(plan.rule.type_bits, candidate.type);
  if (plan.rule.damped)
    for (const int64_t v : candidate.v) field(w.velocity_bits, v);
  return out;
}

Candidate unpack_halo(const Plan& plan, const Bits& bits) {
  const Widths& w = plan.rule.widths;
  Candidate out;
  int at = 0;
  const auto take = [&](int width) { return at += width, bits.get(at - width, width); };
  const auto take_signed = [&](int width) { return at += width, bits.get_signed(at - width, width); };
  out.x[0] = static_cast<int32_t>(take_signed(w.position_frac + 2));
  out.x[1] = static_cast<int32_t>(take_signed(w.position_frac + 2));
  out.x[2] = static_cast<int32_t>(take(w.position_frac));
  if (plan.rule.scaled) out.type = static_cast<uint8_t>(take(plan.rule.type_bits));
  if (plan.rule.damped)
    for (int64_t& v : out.v) v = take_signed(w.velocity_bits);
  return out;
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
