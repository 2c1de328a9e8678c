// SPDX-License-Identifier: MIT
#include "model/fixed_rule.h"

#include <cstdlib>

#include "model/fixed_step.h"

namespace cuboct {

FixedTable::Address FixedTable::address(uint64_t r2) const {
  Address address{};
  table_address(*this, r2, address.index, address.t);
  return address;
}

int64_t FixedTable::at(uint64_t r2) const { return table_value(*this, r2); }

Int3 difference(const FixedRule& rule, const Int3& x_i, const Int3& x_j) {
  Int3 d;
  for (int a = 0; a < 3; ++a) d[a] = round_odd(x_j[a] - x_i[a], rule.difference_shift);
  return d;
}

bool may_interact(const FixedRule& rule, const Int3& d) {
  const int64_t x = std::abs(d[0]), y = std::abs(d[1]), z = std::abs(d[2]);
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
