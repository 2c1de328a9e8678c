// SPDX-License-Identifier: MIT
// Compiled once per instruction set. Products and sums are rounded apart, so that all give the same bits.
#include "model/analysis/near_kernel.h"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/analysis/near_kernel.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// r[k] = unit |d[][k]|, in whole vectors.
void lengths(const double* const d[3], size_t count, double unit, double* r) {
  const hn::ScalableTag<double> tag;
  for (size_t k = 0; k < count; k += hn::Lanes(tag)) {
    const auto square = [&](size_t axis) HWY_ATTR {
      const auto along = hn::LoadU(tag, d[axis] + k);
      return hn::Mul(along, along);
    };
    const auto sum = hn::Add(square(0), hn::Add(square(1), square(2)));
    hn::StoreU(hn::Mul(hn::Sqrt(sum), hn::Set(tag, unit)), tag, r + k);
  }
}

}  // namespace cuboct::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct {

HWY_EXPORT(lengths);

namespace {

// The periods that bring d to the nearest image.
std::array<int8_t, 3> image_of(const std::array<int64_t, 3>& half, const Int3& d) {
  std::array<int8_t, 3> image;
  for (size_t a = 0; a < 3; ++a) image[a] = static_cast<int8_t>((d[a] < -half[a]) - (d[a] > half[a]));
  return image;
}

// Modulo 2^64, as positions are.
int64_t minus(int64_t a, int64_t b) {
  return static_cast<int64_t>(static_cast<uint64_t>(a) - static_cast<uint64_t>(b));
}

}  // namespace

// Piece by piece: differences one by one, as gathers and compressed stores cost more than single numbers;
// their lengths in vectors; and those inside the cutoff, without a branch for each.
void near_distances(const ListedPairs& pairs, double unit, const CellShape& shape, double cutoff,
                    PairDistances& inside, std::vector<PairAcross>& across) {
  constexpr size_t kPiece = 256, kRoom = kPiece + HWY_MAX_BYTES / sizeof(double);
  double d[3][kRoom] = {}, r[kRoom];
  const double* const along[3] = {d[0], d[1], d[2]};
  const bool ring = pairs.period != std::array<int64_t, 3>{};
  std::array<int64_t, 3> half;
  for (size_t a = 0; a < 3; ++a) half[a] = pairs.period[a] > 0 ? pairs.period[a] / 2 : INT64_MAX;
  std::array<int8_t, 3> images[kPiece];
  const size_t room = pairs.first[pairs.end] - pairs.first[pairs.begin] + 1;
  if (inside.r.size() < room) inside.i.resize(room), inside.j.resize(room), inside.r.resize(room);
  size_t n = 0, seams = across.size();
  if (ring) across.resize(seams + room);
  for (size_t i = pairs.begin; i < pairs.end; ++i) {
    const Int3 x = pairs.x[i];
    for (size_t k = pairs.first[i]; k < pairs.first[i + 1]; k += kPiece) {
      const uint32_t* const others = pairs.others + k;
      const size_t count = std::min(kPiece, pairs.first[i + 1] - k);
      for (size_t m = 0; m < count; ++m) {
        const Int3& other = pairs.x[others[m]];
        Int3 of{minus(other[0], x[0]), minus(other[1], x[1]), minus(other[2], x[2])};
        if (ring) {
          images[m] = image_of(half, of);
          for (size_t a = 0; a < 3; ++a) of[a] += images[m][a] * pairs.period[a];
        }
        for (size_t a = 0; a < 3; ++a) d[a][m] = static_cast<double>(of[a]) * shape[a];
      }
      HWY_DYNAMIC_DISPATCH(lengths)(along, count, unit, r);
      if (ring)
        for (size_t m = 0; m < count; ++m) {
          across[seams] = {static_cast<uint32_t>(i), others[m], images[m]};
          seams += images[m] != std::array<int8_t, 3>{} ? 1 : 0;
        }
      for (size_t m = 0; m < count; ++m) {
        inside.i[n] = static_cast<uint32_t>(i), inside.j[n] = others[m], inside.r[n] = r[m];
        n += r[m] < cutoff ? 1 : 0;
      }
    }
  }
  inside.count = n;
  if (ring) across.resize(seams);
}

}  // namespace cuboct
#endif
