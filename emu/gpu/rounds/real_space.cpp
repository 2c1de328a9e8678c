// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/real_space.h"

#include <algorithm>
#include <cmath>

#include "model/contract/neighbours.h"

namespace cuboct::gpu {
namespace {

// A box that repeats leaves x so many bits to count boxes with. Its unit is then half an ulp of the box's
// length in doubles, or less.
constexpr int kBoxBits = 8;
// Of the body's length, or of 16 reaches: how far a body may fly apart.
constexpr double kRoom = 64;
// Places of 32 bits hold a reach in 28 to 29 of them: twice of it is seen, and a unit is below a float's
// rounding of a reach.
constexpr int kReachBits = 28;

Vec3 lowest(const Body& body) {
  Vec3 low = body.x[0];
  for (const Vec3& x : body.x) low = low.cwiseMin(x);
  return low;
}
Vec3 highest(const Body& body) {
  Vec3 high = body.x[0];
  for (const Vec3& x : body.x) high = high.cwiseMax(x);
  return high;
}

}  // namespace

RealSpace::RealSpace(const Body& body, const Periodic& periodic, double reach, bool wide)
    : RealSpace(lowest(body), (highest(body) - lowest(body)).cwiseMax(reach), periodic, reach, wide) {}

RealSpace::RealSpace(const Vec3& from, const Vec3& extent, const Periodic& periodic, double reach, bool wide)
    : low(from), length(extent) {
  CellList(reach, periodic);  // refuses a box in which pairs meet twice
  for (size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<int>(a);
    wraps[a] = periodic.extent[axis] > 0;
    ring[a] = {wraps[a] ? kBoxBits : 0, 0};
    if (wraps[a]) low[axis] = periodic.origin[axis], length[axis] = periodic.extent[axis];
    origin[axis] = wraps[a] ? low[axis] : low[axis] + length[axis] / 2;
    const double around = wraps[a] ? length[axis] : kRoom * std::max(length[axis], 16 * reach);
    unit[axis] = std::ldexp(around, ring[a].spare - 64);
    bound[a] = wraps[a] ? int64_t{1} << 62 : (int64_t{1} << 62) + (int64_t{1} << 61);
    if (!wide) ring[a].drop = std::clamp(std::ilogb(std::ldexp(reach / around, 64)) - kReachBits, 0, 32);
  }
}

int64_t RealSpace::whole(double x, size_t axis) const {
  return std::llround((x - origin[static_cast<int>(axis)]) / unit[static_cast<int>(axis)]);
}
double RealSpace::metres(int64_t x, size_t axis) const {
  return origin[static_cast<int>(axis)] + static_cast<double>(x) * unit[static_cast<int>(axis)];
}
double RealSpace::place_unit(size_t axis) const {
  return std::ldexp(unit[static_cast<int>(axis)], ring[axis].drop - ring[axis].spare);
}
double RealSpace::furthest(size_t axis, bool wide) const {
  return std::ldexp(1.0, std::min((wide ? 62 : 30) + ring[axis].drop - ring[axis].spare, 60));
}

}  // namespace cuboct::gpu
