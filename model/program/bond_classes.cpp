// SPDX-License-Identifier: MIT
#include "model/program/bond_classes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace cuboct {
namespace {

constexpr double kSame = 1e-9;  // of the largest: what rounding leaves of equal bonds

// Values that are equal but for rounding become one: the middle of theirs.
std::vector<double> settled(const std::vector<double>& values) {
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, [&](size_t k) { return values[k]; });
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  std::vector<double> out(values.size());
  for (size_t k = 0, end = 0; k < order.size(); k = end) {
    for (end = k; end < order.size() && values[order[end]] - values[order[k]] <= kSame * most;) ++end;
    for (size_t n = k; n < end; ++n) out[order[n]] = (values[order[k]] + values[order[end - 1]]) / 2;
  }
  return out;
}

// Whether a graph reads d0 other than in squares: then its direction counts, and not r0 alone.
bool reads_axes(const RealGraph& graph) {
  return std::ranges::any_of(graph.nodes(), [&](const RealNode& node) {
    if (node.op == RealOp::multiply && node.of[0] == node.of[1]) return false;
    for (size_t k = 0; k < static_cast<size_t>(arity(node.op)); ++k) {
      const RealNode& of = graph.at(node.of[k]);
      if (of.op == RealOp::input && of.input.source == RealSource::packed) return true;
    }
    return false;
  });
}

}  // namespace

BondClasses::BondClasses(const RuleProgram& rule, const ProgramStart& start)
    : written_(rule.bond_numbers, 0), column_(rule.bond_numbers, -1) {
  for (const ProgramRound& round : rule.rounds) {
    has_axes_ = has_axes_ || reads_axes(round.pair);
    for (const ProgramWrite& write : round.bonds) written_[write.number] = 1;
  }
  const ReferenceBonds& rows = start.rows;
  const size_t bonds = rows.other.size();
  std::vector<double> length2(bonds);
  for (size_t b = 0; b < bonds; ++b) length2[b] = rows.vector[b].squaredNorm();
  length2 = settled(length2);

  std::vector<std::vector<double>> columns(3, std::vector<double>(bonds, 0));
  for (size_t b = 0; b < bonds; ++b) columns[0][b] = std::sqrt(length2[b]);
  for (int a = 0; has_axes_ && a < 3; ++a) {
    for (size_t b = 0; b < bonds; ++b) columns[static_cast<size_t>(a)][b] = rows.vector[b][a];
    columns[static_cast<size_t>(a)] = settled(columns[static_cast<size_t>(a)]);
  }
  for (uint32_t n = 0; n < rule.bond_numbers; ++n) {
    if (written_[n] != 0) continue;
    column_[n] = static_cast<int>(columns.size());
    columns.push_back(settled(start.bond[n]));
  }

  std::map<double, size_t> lengths;
  std::map<std::vector<double>, uint32_t> classes;
  for (size_t b = 0; b < bonds; ++b) {
    std::vector<double> key;
    for (const std::vector<double>& column : columns) key.push_back(column[b]);
    const auto [at, fresh] = classes.try_emplace(key, static_cast<uint32_t>(classes.size()));
    of_bond_.push_back(at->second);
    if (!fresh) continue;
    const auto [length, first] = lengths.try_emplace(length2[b], lengths.size());
    if (first) lengths2_.push_back(length2[b]), first_of_length_.push_back(values_.size());
    values_.push_back(key);
    length_.push_back(length->second);
  }
  for (uint32_t i = 0; i < rows.particles(); ++i)
    for (uint64_t b = rows.begin(i); b < rows.end(i); ++b) {
      const auto row = rows.other.begin() + static_cast<ptrdiff_t>(rows.begin(rows.other[b]));
      const auto end = rows.other.begin() + static_cast<ptrdiff_t>(rows.end(rows.other[b]));
      const auto twin = static_cast<size_t>(std::lower_bound(row, end, i) - rows.other.begin());
      ends_.insert({of_bond_[b], of_bond_[twin]});
    }
}

bool BondClasses::fixed(const RealInput& input) const {
  if (input.source == RealSource::bond_field) return written_[input.index] == 0;
  return input.source == RealSource::packed;
}

double BondClasses::at(size_t of, const RealInput& input) const {
  const bool field = input.source == RealSource::bond_field;
  return values_[of][field ? static_cast<size_t>(column_[input.index]) : input.index];
}

}  // namespace cuboct
