// SPDX-License-Identifier: MIT
// Makes steps: each function adds one, or returns the earlier one that has the same value.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "hw/pipeline/steps.h"

namespace cuboct::pipeline {

class StepMaker {
 public:
  // Steps from here on are of this node.
  void begin(int node) { node_ = node; }
  std::vector<Step> take() { return std::move(steps_); }
  int bits(int step) const { return at(step).bits; }
  bool is_signed(int step) const { return at(step).is_signed; }

  int constant(int64_t number);
  int word(uint64_t number);  // 64 bits without a sign
  int input(Form form);       // a new one
  int of(Kind kind, std::vector<int> inputs, Form form);
  int slice(int a, int low, Form form);
  int cast(int a, Form form) { return slice(a, 0, form); }
  int join(int high, int low);
  int times_power(int a, int power);  // a 2^power
  int sign(int a);                    // 1 where a < 0
  int chosen(int truth, int a, int b);
  int unfit(int a, int width);
  int rom(int index, int table, int bits);

  // base + round_odd(a, shift), by one adder; `base` < 0 for none.
  int rounded(int a, int shift, Form form, int base = -1);
  // Modulo 2^form.bits.
  int sum_of_products(const std::vector<std::pair<int, int>>& factors, Form form);

 private:
  struct Term {
    int step, place;  // the step's value times 2^place
  };
  using Key = std::tuple<Kind, std::vector<int>, int, bool, int, uint64_t, int>;

  const Step& at(int step) const { return steps_[static_cast<size_t>(step)]; }
  int added(Step step);
  int number(uint64_t value, Form form);
  std::vector<int> limbs(int a);
  int narrow_product(int a, int b);
  int product(int a, int b);
  void add_product(int a, int b, int width, std::vector<Term>& terms);
  Term sum(Term x, Term y, Form form);

  std::vector<Step> steps_;
  std::map<Key, int> known_;
  int node_ = -1;
};

}  // namespace cuboct::pipeline
