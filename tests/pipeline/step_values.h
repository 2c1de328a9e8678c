// SPDX-License-Identifier: MIT
// What steps are worth, one after another, in software: as steps.h says, and without a schedule.
#pragma once

#include <vector>

#include "hw/pipeline/steps.h"
#include "model/graph/interval.h"

namespace cuboct::test {

using graph::Wide;
__extension__ typedef unsigned __int128 Unsigned;

inline Wide kept(Wide v, int bits, bool is_signed) {
  const Unsigned one = 1, mask = bits >= 128 ? ~Unsigned{0} : (one << bits) - 1;
  Unsigned u = static_cast<Unsigned>(v) & mask;
  if (is_signed && (u >> (bits - 1) & 1) != 0) u |= ~mask;
  return static_cast<Wide>(u);
}

// Of all steps; `inputs` by port.
inline std::vector<Wide> values_of(const pipeline::Steps& all, const std::vector<FixedTable>& tables,
                                   const std::vector<int64_t>& inputs) {
  using pipeline::Kind;
  std::vector<Wide> values;
  size_t port = 0;
  for (const pipeline::Step& step : all.steps) {
    const auto in = [&](size_t k) { return values[static_cast<size_t>(step.inputs[k])]; };
    const auto bits = [&](size_t k) { return all.steps[static_cast<size_t>(step.inputs[k])].bits; };
    const auto made = [&]() -> Wide {
      switch (step.kind) {
        case Kind::constant:
          return static_cast<Wide>(step.number);
        case Kind::input:
          return inputs[port++];
        case Kind::slice:
          return in(0) >> step.low;
        case Kind::join:
          return static_cast<Wide>(static_cast<Unsigned>(in(0)) << bits(1)) | kept(in(1), bits(1), false);
        case Kind::add:
          return in(0) + in(1) + (step.inputs.size() == 3 ? in(2) : 0);
        case Kind::sub:
          return in(0) - in(1);
        case Kind::less:
          return in(0) < in(1);
        case Kind::less_equal:
          return in(0) <= in(1);
        case Kind::equal:
          return in(0) == in(1);
        case Kind::both:
          return in(0) & in(1);
        case Kind::either:
          return in(0) | in(1);
        case Kind::negate:
          return 1 - in(0);
        case Kind::choose:
          return in(0) != 0 ? in(1) : in(2);
        case Kind::exclusive:
          return in(0) ^ in(1);
        case Kind::leading: {
          Wide zeros = 0;
          while (zeros < bits(0) - 1 && (in(0) >> (bits(0) - 1 - zeros) & 1) == 0) ++zeros;
          return zeros;
        }
        case Kind::shift_left:
          return static_cast<Wide>(static_cast<Unsigned>(in(0)) << static_cast<int>(in(1)));
        case Kind::carry: {
          const Wide half = Wide{1} << (step.low - 1);
          return ((in(0) + half - (in(0) < 0)) >> step.low) - (in(0) >> step.low);
        }
        case Kind::unfit:
          return kept(in(0), step.low, true) != in(0);
        case Kind::product:
          return in(0) * in(1);
        case Kind::rom: {
          const FixedTable& t = tables[static_cast<size_t>(step.table)];
          const auto k = static_cast<size_t>(in(0));
          const pipeline::EntryForm form = pipeline::entry_form(t);
          const auto field = [&](int32_t v, int width, int place) { return kept(v, width, false) << place; };
          return field(t.c0[k], form.c0, 0) | field(t.c1[k], form.c1, form.c0) |
                 (t.degree == 2 ? field(t.c2[k], form.c2, form.c0 + form.c1) : 0);
        }
      }
      return 0;
    };
    values.push_back(kept(made(), step.bits, step.is_signed));
  }
  return values;
}

}  // namespace cuboct::test
