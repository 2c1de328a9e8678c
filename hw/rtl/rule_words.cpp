// SPDX-License-Identifier: MIT
#include "hw/rtl/rule_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace cuboct {

std::string Slice::text() const { return fmt::format("{}[{} +: {}]", of, lsb, bits); }

std::string Slice::fit(int width) const {
  if (bits >= width) return fmt::format("{}[{} +: {}]", of, lsb, width);
  const std::string sign = is_signed ? fmt::format("{}[{}]", of, lsb + bits - 1) : "1'b0";
  return fmt::format("{{{{{} {{{}}}}}, {}}}", width - bits, sign, text());
}

std::string with_parts(const std::string& word, int bits, std::vector<Part> parts, const char* between) {
  std::ranges::sort(parts, {}, [](const Part& part) { return -part.lsb; });
  std::vector<std::string> texts;
  int end = bits;
  for (const Part& part : parts) {
    const int above = part.lsb + part.bits;
    if (above < end) texts.push_back(fmt::format("{}[{}:{}]", word, end - 1, above));
    texts.push_back(part.text);
    end = part.lsb;
  }
  if (end > 0) texts.push_back(fmt::format("{}[{}:0]", word, end - 1));
  return fmt::format("{{{}}}", fmt::join(texts, between));
}

RuleWords::RuleWords(const Plan& plan) : plan_(plan) {
  int lsb = plan.rule.axes * (plan.rule.widths.position_frac + 2);
  for (size_t k = 0; k < plan.rounds.size(); ++k) {
    if (k == 1) later_bits_ = -lsb;
    for (WordField f : plan.rounds[k].record) {
      if (f.kind == FieldKind::position) continue;
      f.lsb = lsb, lsb += f.bits;
      others_.push_back(f);
    }
  }
  candidate_bits_ = lsb;
  if (plan.rounds.size() > 1) later_bits_ += lsb;
  places_ = plan.words.bonds;
  for (const WordField& f : plan.words.particle) {
    if (f.place == 0 && f.kind == FieldKind::bond_other) bond_lsb_ = f.lsb;
    if (f.place == 0) place_bits_ = f.lsb + f.bits - bond_lsb_;
    if (f.place == 0 && f.kind == FieldKind::bond_kind) kind_bits_ = f.bits;
  }
}

const WordField& RuleWords::own_field(FieldKind kind, int axis, int number) const {
  return *std::ranges::find_if(plan_.words.particle, [&](const WordField& f) {
    return f.kind == kind && f.axis == axis && (kind != FieldKind::field || f.number == number);
  });
}

Slice RuleWords::own(const std::string& of, FieldKind kind, int axis, int number) const {
  const WordField& f = own_field(kind, axis, number);
  return {of, f.lsb, f.bits, f.is_signed};
}

Slice RuleWords::other(const std::string& of, FieldKind kind, int axis) const {
  const auto f =
      std::ranges::find_if(others_, [&](const WordField& g) { return g.kind == kind && g.axis == axis; });
  return {of, f->lsb, f->bits, f->is_signed};
}

Slice RuleWords::other_number(const std::string& of, int number, int round) const {
  Slice found;
  auto f = others_.begin();
  for (int k = 0; k <= round; ++k)
    for (const WordField& sent : plan_.rounds[static_cast<size_t>(k)].record) {
      if (sent.kind == FieldKind::position) continue;
      if (f->kind == FieldKind::field && f->number == number) found = {of, f->lsb, f->bits, f->is_signed};
      ++f;
    }
  return found;
}

const WordField& RuleWords::bond_field(int number) const {
  return *std::ranges::find_if(plan_.words.particle, [&](const WordField& f) {
    return f.kind == FieldKind::bond_field && f.place == 0 && f.number == number;
  });
}

int RuleWords::pair_bits() const {
  return places_ > 0 ? plan_.words.particle_bits : id_lsb() + plan_.words.id_bits;
}

}  // namespace cuboct
