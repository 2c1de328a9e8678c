// SPDX-License-Identifier: MIT
#include "emu/gpu/fixed/fixed_policy.h"

namespace cuboct::gpu {
namespace {

DeviceTable put(const FixedTable& table, std::vector<int32_t>& cache) {
  if (cache.size() % 2 != 0) cache.push_back(0);
  const DeviceTable put{static_cast<int>(table.shape),
                        table.degree,
                        table.difference_frac,
                        table.index_bits,
                        table.bin_bits,
                        table.first_octave,
                        table.fraction_bits,
                        static_cast<uint32_t>(cache.size()),
                        static_cast<uint32_t>(table.c0.size())};
  for (size_t k = 0; k < table.c0.size(); ++k) {
    cache.push_back(table.c0[k]);
    cache.push_back(table.c1[k]);
  }
  cache.insert(cache.end(), table.c2.begin(), table.c2.end());
  return put;
}

}  // namespace

FixedRuleOnDevice::FixedRuleOnDevice(Stream& stream, const FixedRule& rule)
    : cache_(stream.device()), scale_(stream.device()), types_(stream.device()) {
  view_.widths = rule.widths;
  view_.cell_edge = int32_t{1} << rule.widths.position_frac;
  view_.position_unit = 1 / static_cast<float>(view_.cell_edge);
  view_.cutoff2 = rule.cutoff2;
  view_.contact2 = rule.contact2;
  std::vector<int32_t> cache;
  view_.force = put(rule.force, cache);
  view_.damped = rule.damped;
  if (rule.damped) view_.damp = put(rule.damp, cache);
  cache_.set(stream, cache);
  view_.scaled = rule.scaled;
  view_.weighted = rule.weighted;
  view_.law_bits = rule.law_bits;
  view_.type_count = static_cast<int>(rule.types.size());
  if (rule.scaled) {
    std::vector<int32_t> scale;
    for (const auto& row : rule.scale) scale.insert(scale.end(), row.begin(), row.end());
    for (const auto& row : rule.law) scale.insert(scale.end(), row.begin(), row.end());
    scale_.set(stream, scale);
    view_.scale = scale_.data();
  }
  std::vector<DeviceType> types;
  for (const FixedType& type : rule.types) {
    DeviceType one{};
    one.pd = type.pd;
    one.kp = type.kp, one.kd = type.kd;
    one.weight = type.weight;
    for (int a = 0; a < 3; ++a) {
      one.imposed[a] = type.imposed[a];
      one.velocity[a] = type.velocity[a];
      one.gravity[a] = type.gravity[a];
    }
    types.push_back(one);
  }
  types_.set(stream, types);
  view_.types = types_.data();
  view_.difference_shift = rule.difference_shift;
  view_.w_shift = rule.w_shift;
  view_.q_shift = rule.q_shift;
  view_.damp_shift = rule.damp_shift;
  view_.kick_shift = rule.kick_shift;
}

}  // namespace cuboct::gpu
