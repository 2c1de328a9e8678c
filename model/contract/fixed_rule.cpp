// SPDX-License-Identifier: MIT
#include "model/contract/fixed_rule.h"

#include <cmath>

namespace cuboct {
namespace {

// floor(sqrt(a)) for a < 2^52, where the double square root is off by less than one.
int64_t integer_sqrt(uint64_t a) {
  auto root = static_cast<int64_t>(std::sqrt(static_cast<double>(a)));
  while (static_cast<uint64_t>(root * root) > a) --root;
  while (static_cast<uint64_t>((root + 1) * (root + 1)) <= a) ++root;
  return root;
}

}  // namespace

Int3 difference(const FixedRule& rule, const Int3& x_i, const Int3& x_j) {
  Int3 d;
  for (int a = 0; a < 3; ++a) d[a] = round_odd(x_j[a] - x_i[a], rule.difference_shift);
  return d;
}

void set_planar(FixedRule& rule) {
  const int shift = rule.widths.difference_frac + 1 - rule.widths.filter_frac;
  for (int64_t m = 1; m <= 3; ++m) {
    const int64_t twice = 2 * integer_sqrt(static_cast<uint64_t>(m) * (rule.cutoff2 - 1)) + m;
    const int64_t units = shift >= 0 ? (twice + (int64_t{1} << shift) - 1) >> shift : twice << -shift;
    rule.planar[static_cast<size_t>(m - 1)] = units + m - 1;
  }
}

bool may_interact(const FixedRule& rule, const Int3& x_i, const Int3& x_j) {
  const int shift = rule.widths.position_frac - rule.widths.filter_frac;
  Int3 size;
  for (int a = 0; a < 3; ++a) {
    const int64_t e = (x_j[a] >> shift) - (x_i[a] >> shift);
    size[a] = e < 0 ? -e - 1 : e;
  }
  const auto [x, y, z] = size;
  return x <= rule.planar[0] && y <= rule.planar[0] && z <= rule.planar[0] && x + y <= rule.planar[1] &&
         y + z <= rule.planar[1] && z + x <= rule.planar[1] && x + y + z <= rule.planar[2];
}

PairResult pair_kick(const FixedRule& rule, const Int3& x_i, const Int3& v_i, int type_i, const Int3& x_j,
                     const Int3& v_j, int type_j) {
  return pair_kick_of<PairResult>(rule, x_i, v_i, type_i, x_j, v_j, type_j);
}

FinishResult finish(const FixedRule& rule, const Int3& sum, const Int3& x, const Int3& v, const Int3& u,
                    int type) {
  return finish_of<FinishResult>(rule, sum, x, v, u, type);
}

}  // namespace cuboct
