// SPDX-License-Identifier: MIT
// Tables made from a function: parabolas through both ends and the middle of each bin.
#pragma once

#include <functional>
#include <vector>

#include "model/graph/fixed_table.h"

namespace cuboct {

struct TableRoom {
  int bits = 0;  // of the argument, which is an integer of `step` each
  double step = 1;
  double from = 0;  // the table begins with the octave that holds it
  double to = 0;    // beyond it the function is worth what it is there
  double unit = 1;  // of the values
};

struct FittedTable {
  FixedTable table;  // value_frac: of values over the unit
  // Over the unit, at four points a bin of arguments beyond 0.3 of the last: where a table of r^2 is not
  // steep.
  double worst = 0;    // error
  double largest = 0;  // value
};

// Of octaves. With the largest value_frac whose coefficients stay below 2^25.
FittedTable fit_table(const TableRoom& room, const std::function<double(double)>& f);

struct WindowRoom {
  int bits = 0;     // of the argument, an even number: integers of `step` each
  double step = 1;  //
  std::vector<double> from,
      width;        // by law: what argument 0 means, and how far f is asked for, but for a bin
  double unit = 1;  // of the values
};

// Of several laws, each in its own window, in bins of one size; worth beyond the window what f is at its end.
// The error is that at four points a bin of all windows.
FittedTable fit_window(const WindowRoom& room, const std::function<double(double, size_t)>& f);

}  // namespace cuboct
