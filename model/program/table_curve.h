// SPDX-License-Identifier: MIT
// A function of one number that formulas call: by the values of a table.
#pragma once

#include <string>
#include <utility>

namespace cuboct {

class TableCurve {
 public:
  virtual ~TableCurve() = default;
  virtual double at(double x) const = 0;
  virtual double slope(double x) const = 0;
  // What the table has arguments for.
  virtual double begin() const { return 0; }
  virtual double end() const = 0;
  // Of which function, for people.
  virtual const std::string& what() const = 0;
  // An argument beyond the end is an error of who asks.
  virtual bool bounded() const { return false; }
  // Whether an argument is one that no one should ask for; also where it is not a number.
  bool beyond(double x) const { return bounded() && !(x <= end()); }
  // The least and the largest value, or slope, over the table.
  virtual std::pair<double, double> range(bool of_slope) const = 0;
};

}  // namespace cuboct
