// SPDX-License-Identifier: MIT
// Real numbers as integers of a graph: `unit` times 2^-frac, with `unit` in [1, 2). A factor that is constant
// changes the unit and costs nothing; two values of different units take one product to be added.
//
// Values stay below 2^51 and products below 2^52, so that doubles hold them (graph::exactness_of).
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "model/graph/builder.h"
#include "model/program/fit_table.h"

namespace cuboct {

struct Scaled {
  int node = -1;      // of the builder; -1: a constant
  double number = 0;  // of a constant
  int frac = 0;
  double unit = 1;

  bool constant() const { return node < 0; }
  static Scaled of(double number) { return {-1, number, 0, 1}; }
};

class Integers {
 public:
  static constexpr int kFactorBits = 25;

  // `factor_bits`: of a product's factors beside the sign, and of a constant one; at most kFactorBits.
  Integers(graph::Builder& builder, int factor_bits) : b_(builder), factor_(factor_bits) {}

  // A value of any positive unit.
  static Scaled scaled(int node, int frac, double unit);

  Scaled add(const Scaled& a, const Scaled& b);
  Scaled subtract(const Scaled& a, const Scaled& b) { return add(a, negate(b)); }
  Scaled multiply(const Scaled& a, const Scaled& b);
  Scaled negate(const Scaled& a);
  Scaled absolute(const Scaled& a);
  Scaled chosen(bool least, const Scaled& a, const Scaled& b);  // the lesser, or the greater
  // Truths.
  Scaled below(const Scaled& a, const Scaled& b, bool or_equal);
  Scaled equal(const Scaled& a, const Scaled& b);
  Scaled both(const Scaled& a, const Scaled& b);
  Scaled either(const Scaled& a, const Scaled& b);
  Scaled inverse(const Scaled& a);
  Scaled select(const Scaled& truth, const Scaled& a, const Scaled& b);

  // f of an argument that is not negative, by a table of octaves whose values count in `unit` (0: any).
  // `from`: where it begins, below which it is worth what it is there. f is asked up to `to`.
  Scaled function(const Scaled& a, const std::function<double(double)>& f, double from, double to,
                  double unit);

  // A table's values, which count in `unit`. `law`: -1 where it has one.
  Scaled looked_up(const FittedTable& fitted, double unit, int argument, int law = -1);

  // At most so many bits beside the sign.
  Scaled narrow(const Scaled& a, int bits);
  Scaled in_unit(const Scaled& a, double unit);
  // The node with exactly this unit and these fractional bits.
  int node_in(const Scaled& a, double unit, int frac);
  int node_of(const Scaled& a);  // of a constant too

  // Of each table that was made: its largest error over its largest value, and how many entries it has.
  struct Fit {
    double error = 0;
    size_t entries = 0;
  };
  const std::vector<Fit>& fits() const { return fits_; }

 private:
  int64_t size_of(int node) const;
  int bits_of(const Scaled& a) const;
  Scaled known(double number, double unit, int frac);  // a constant as a node
  std::pair<Scaled, Scaled> alike(const Scaled& a, const Scaled& b);

  graph::Builder& b_;
  int factor_;
  std::vector<Fit> fits_;
};

}  // namespace cuboct
