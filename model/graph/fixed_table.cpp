// SPDX-License-Identifier: MIT
#include "model/graph/fixed_table.h"

#include "model/graph/table_value.h"

namespace cuboct {

FixedTable::Address FixedTable::address(uint64_t r2) const {
  Address address{};
  table_address(*this, r2, address.index, address.t);
  return address;
}

int64_t FixedTable::at(uint64_t r2, uint32_t law) const { return table_value(*this, r2, law << index_bits); }

}  // namespace cuboct
