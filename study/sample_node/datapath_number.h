// SPDX-License-Identifier: MIT
// Numbers of a datapath in fixed point: products are rounded to a multiple of the quantum, and every
// operation is counted.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cuboct {

struct OperationCounts {
  uint64_t products = 0, adds = 0, lookups = 0, divisions = 0;
  friend OperationCounts operator-(const OperationCounts& a, const OperationCounts& b) {
    return {a.products - b.products, a.adds - b.adds, a.lookups - b.lookups, a.divisions - b.divisions};
  }
  OperationCounts& operator+=(const OperationCounts& b) {
    products += b.products, adds += b.adds, lookups += b.lookups, divisions += b.divisions;
    return *this;
  }
};

// Of the numbers that this thread computes with.
struct DatapathTally {
  OperationCounts counts;
  double quantum = 0;    // 0: doubles as they are
  double largest = 0;    // magnitude of a result
  bool outside = false;  // a table was asked below its range
};

class DatapathNumber {
 public:
  DatapathNumber() = default;
  explicit DatapathNumber(double value) : value_(rounded(value)) {}

  double value() const { return value_; }
  int depth() const { return depth_; }  // operations in a row that led here

  friend DatapathNumber operator*(const DatapathNumber& a, const DatapathNumber& b) {
    ++tally->counts.products;
    return after(rounded(a.value_ * b.value_), a, b);
  }
  // A product with all its bits, for a wide sum.
  friend DatapathNumber whole_product(const DatapathNumber& a, const DatapathNumber& b) {
    ++tally->counts.products;
    return after(a.value_ * b.value_, a, b);
  }
  friend DatapathNumber operator+(const DatapathNumber& a, const DatapathNumber& b) {
    ++tally->counts.adds;
    return after(a.value_ + b.value_, a, b);
  }
  friend DatapathNumber operator-(const DatapathNumber& a, const DatapathNumber& b) {
    ++tally->counts.adds;
    return after(a.value_ - b.value_, a, b);
  }
  friend bool operator>(const DatapathNumber& a, const DatapathNumber& b) {
    ++tally->counts.adds;
    return a.value_ > b.value_;
  }
  // A sign costs what the adder behind it has anyway.
  DatapathNumber operator-() const {
    DatapathNumber out = *this;
    out.value_ = -value_;
    return out;
  }
  static double rounded(double value) {
    const double quantum = tally == nullptr ? 0 : tally->quantum;
    return quantum > 0 ? quantum * std::round(value / quantum) : value;
  }
  // `value`, that `steps` operations made of a and b.
  static DatapathNumber after(double value, const DatapathNumber& a, const DatapathNumber& b, int steps = 1) {
    DatapathNumber out;
    out.value_ = value;
    out.depth_ = std::max(a.depth_, b.depth_) + steps;
    tally->largest = std::max(tally->largest, std::abs(value));
    return out;
  }

  static inline thread_local DatapathTally* tally = nullptr;  // not null while numbers are computed with

 private:
  double value_ = 0;
  int depth_ = 0;
};

// A function on [low, high] by parabolas through the ends and the middles of stretches whose length is a
// power of two, so that an argument's bits are its place in the table. Above `high` it stays.
class DatapathTable {
 public:
  template <class F>
  DatapathTable(double low, double high, uint64_t most_words, const F& f) {
    step_ = std::exp2(std::ceil(std::log2((high - low) / static_cast<double>(most_words))));
    low_ = step_ * std::floor(low / step_);
    const auto words = static_cast<size_t>(std::ceil((high - low_) / step_));
    for (size_t k = 0; k < words; ++k) {
      const double at = low_ + step_ * static_cast<double>(k);
      const double first = f(at), middle = f(at + step_ / 2), last = f(at + step_);
      const auto round = [](double value) { return DatapathNumber::rounded(value); };
      words_.push_back(
          {round(first), round(4 * middle - 3 * first - last), round(2 * (first - 2 * middle + last))});
    }
  }
  uint64_t words() const { return words_.size(); }
  static constexpr int kCoefficients = 3;

  DatapathNumber operator()(const DatapathNumber& x) const {
    DatapathTally& tally = *DatapathNumber::tally;
    tally.counts += {.products = 2, .adds = 2, .lookups = 1};
    const double at = (x.value() - low_) / step_;
    if (!(at >= 0)) tally.outside = true;
    const auto k = std::min(static_cast<size_t>(std::max(at, 0.0)), words_.size() - 1);
    const double part = std::min(at - static_cast<double>(k), 1.0);
    const auto& [c0, c1, c2] = words_[k];
    const double inner = c1 + DatapathNumber::rounded(part * c2);
    // A read, and twice a product and a sum.
    return DatapathNumber::after(c0 + DatapathNumber::rounded(part * inner), x, x, 5);
  }

 private:
  double low_ = 0, step_ = 0;
  std::vector<std::array<double, 3>> words_;
};

}  // namespace cuboct
