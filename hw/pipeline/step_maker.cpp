// SPDX-License-Identifier: MIT
#include "hw/pipeline/step_maker.h"

#include <algorithm>
#include <bit>

namespace cuboct::pipeline {
namespace {

uint64_t mask_of(int bits) { return bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1; }

// A constant's bits from `low` on.
uint64_t bits_of(const Step& constant, int low) {
  const bool negative = constant.is_signed && (constant.number >> (constant.bits - 1) & 1) != 0;
  const uint64_t fill = negative ? ~uint64_t{0} : 0;
  if (low >= 64) return fill;
  const uint64_t all = constant.number | (fill & ~mask_of(constant.bits));
  return low == 0 ? all : all >> low | fill << (64 - low);
}

// Of the sum of two values that no bit is lost of.
Form sum_form(Form a, Form b) {
  if (!a.is_signed && !b.is_signed) return {std::max(a.bits, b.bits) + 1, false};
  return {std::max(a.bits + !a.is_signed, b.bits + !b.is_signed) + 1, true};
}

}  // namespace

int StepMaker::added(Step step) {
  step.node = node_;
  const Key key{step.kind, step.inputs, step.bits, step.is_signed, step.low, step.number, step.table};
  const auto [known, is_new] = known_.try_emplace(key, static_cast<int>(steps_.size()));
  if (is_new) steps_.push_back(std::move(step));
  return known->second;
}

int StepMaker::number(uint64_t value, Form form) {
  return added({.kind = Kind::constant,
                .bits = form.bits,
                .is_signed = form.is_signed,
                .number = value & mask_of(form.bits)});
}

int StepMaker::constant(int64_t value) {
  return number(static_cast<uint64_t>(value), form_of({value, value}));
}
int StepMaker::word(uint64_t value) { return number(value, {64, false}); }

int StepMaker::input(Form form) {
  steps_.push_back({.kind = Kind::input, .bits = form.bits, .is_signed = form.is_signed, .node = node_});
  return static_cast<int>(steps_.size()) - 1;
}

int StepMaker::of(Kind kind, std::vector<int> inputs, Form form) {
  if (kind == Kind::choose && at(inputs[0]).kind == Kind::constant)
    return cast(inputs[at(inputs[0]).number != 0 ? 1 : 2], form);
  return added({.kind = kind, .inputs = std::move(inputs), .bits = form.bits, .is_signed = form.is_signed});
}

int StepMaker::slice(int a, int low, Form form) {
  const Step& of = at(a);
  if (low == 0 && form == Form{of.bits, of.is_signed}) return a;
  if (of.kind == Kind::constant && form.bits <= 64) return number(bits_of(of, low), form);
  return added(
      {.kind = Kind::slice, .inputs = {a}, .bits = form.bits, .is_signed = form.is_signed, .low = low});
}

int StepMaker::join(int high, int low) {
  return of(Kind::join, {high, low}, {bits(high) + bits(low), is_signed(high)});
}

int StepMaker::times_power(int a, int power) { return power == 0 ? a : join(a, number(0, {power, false})); }
int StepMaker::sign(int a) { return slice(a, bits(a) - 1, {1, false}); }

int StepMaker::chosen(int truth, int a, int b) {
  if (a == b) return a;
  if (at(truth).kind == Kind::constant) return at(truth).number != 0 ? a : b;
  const Form one{bits(a), is_signed(a)}, other{bits(b), is_signed(b)};
  Form form = sum_form(one, other);
  --form.bits;
  return of(Kind::choose, {truth, a, b}, form);
}

int StepMaker::unfit(int a, int width) {
  return added({.kind = Kind::unfit, .inputs = {a}, .bits = 1, .low = width});
}

int StepMaker::rom(int index, int table, int bits) {
  return added({.kind = Kind::rom, .inputs = {index}, .bits = bits, .table = table});
}

int StepMaker::rounded(int a, int shift, Form form, int base) {
  if (shift == 0) return base < 0 ? cast(a, form) : of(Kind::add, {base, a}, form);
  const int high = slice(a, shift, {std::max(1, bits(a) - shift), is_signed(a)});
  // Halves of what is not negative go up.
  const int carry = is_signed(a) ? added({.kind = Kind::carry, .inputs = {a}, .bits = 1, .low = shift})
                                 : slice(a, shift - 1, {1, false});
  return of(Kind::add, {base < 0 ? constant(0) : base, high, carry}, form);
}

// Of 17 bits without a sign; the highest has the value's sign.
std::vector<int> StepMaker::limbs(int a) {
  const int width = bits(a);
  const bool sign = is_signed(a);
  std::vector<int> all;
  int low = 0;
  for (; width - low > kLimbBits + sign; low += kLimbBits) all.push_back(slice(a, low, {kLimbBits, false}));
  all.push_back(slice(a, low, {width - low, sign}));
  return all;
}

int StepMaker::product(int a, int b) {
  const Step &x = at(a), &y = at(b);
  const bool sign = x.is_signed || y.is_signed;
  const auto is_zero = [](const Step& s) { return s.kind == Kind::constant && s.number == 0; };
  if (is_zero(x) || is_zero(y)) return number(0, {x.bits + y.bits, sign});
  return of(Kind::product, {std::min(a, b), std::max(a, b)}, {x.bits + y.bits, sign});
}

// Products of limbs i and i + d stand 34 bits apart, and each but the last has 34 bits and no sign: they are
// joined, and not added. Of a square those of d and -d are alike.
void StepMaker::add_product(int a, int b, int width, std::vector<Term>& terms) {
  for (const auto& [power, other] : {std::pair{a, b}, std::pair{b, a}}) {
    const Step& s = at(power);
    if (s.kind == Kind::constant && !s.is_signed && std::has_single_bit(s.number)) {
      terms.push_back({other, std::countr_zero(s.number)});
      return;
    }
  }
  const std::vector<int> x = limbs(a), y = limbs(b);
  const int nx = static_cast<int>(x.size()), ny = static_cast<int>(y.size());
  for (int d = a == b ? 0 : 1 - nx; d < ny; ++d) {
    const int place = kLimbBits * std::abs(d);
    int joined = -1;
    for (int i = std::max(0, -d); i < nx && i + d < ny && kLimbBits * (2 * i + d) < width; ++i) {
      const int piece = product(x[static_cast<size_t>(i)], y[static_cast<size_t>(i + d)]);
      joined = joined < 0 ? piece : join(piece, joined);
    }
    if (joined >= 0) terms.push_back({joined, place + (a == b && d > 0 ? 1 : 0)});
  }
}

// x stands lower; its bits below y's pass by the adder.
StepMaker::Term StepMaker::sum(Term x, Term y, Form form) {
  const int by = y.place - x.place, limit = form.bits - y.place;
  const Form of_x{bits(x.step), is_signed(x.step)}, of_y{bits(y.step), is_signed(y.step)};
  if (!of_x.is_signed && of_x.bits <= by) return {join(y.step, cast(x.step, {by, false})), x.place};
  const Form high{std::max(1, of_x.bits - by), of_x.is_signed};
  Form made = sum_form(high, of_y);
  if (made.bits >= limit) made = {limit, form.is_signed};
  const int top = of(Kind::add, {slice(x.step, by, high), y.step}, made);
  return {by == 0 ? top : join(top, slice(x.step, 0, {by, false})), x.place};
}

int StepMaker::sum_of_products(const std::vector<std::pair<int, int>>& factors, Form form) {
  std::vector<Term> terms;
  for (const auto& [a, b] : factors) add_product(a, b, form.bits, terms);
  std::erase_if(terms, [&](const Term& t) { return t.place >= form.bits; });
  if (terms.empty()) return number(0, form);
  while (terms.size() > 1) {
    std::ranges::stable_sort(terms, {}, &Term::place);
    std::vector<Term> half;
    for (size_t k = 0; k + 1 < terms.size(); k += 2) half.push_back(sum(terms[k], terms[k + 1], form));
    if (terms.size() % 2 == 1) half.push_back(terms.back());
    terms = std::move(half);
  }
  return cast(times_power(terms[0].step, terms[0].place), form);
}

}  // namespace cuboct::pipeline
