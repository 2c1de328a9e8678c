// SPDX-License-Identifier: MIT
#include "model/mesh/solid.h"

#include <embree3/rtcore.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace cuboct {
namespace {

// Of rays, evenly over the sphere by the golden angle, turned so that none lies in a plane that a CAD part is
// likely to have: a ray along a face or through an edge tells nothing.
constexpr int kRays = 11;
std::array<Vec3, kRays> directions() {
  const double golden = M_PI * (3 - std::sqrt(5.0));
  std::array<Vec3, kRays> all;
  for (int k = 0; k < kRays; ++k) {
    const double z = 1 - (2 * k + 1.0) / kRays, r = std::sqrt(1 - z * z), turn = 0.7317 + golden * k;
    all[k] = Mat3{{0.8138, -0.4698, 0.3420}, {0.5438, 0.8232, -0.1632}, {-0.2049, 0.3188, 0.9254}} *
             Vec3(r * std::cos(turn), r * std::sin(turn), z);
  }
  return all;
}

// Embree's searches are in floats: about the middle of the body, and a margin wider than their rounding.
class Solid final : public Shape {
 public:
  Solid(Surface surface, bool closed) : Shape(100), surface_(std::move(surface)), closed_(closed) {
    for (const Vec3& x : surface_.points) {
      bounds_.low = bounds_.low.cwiseMin(x);
      bounds_.high = bounds_.high.cwiseMax(x);
    }
    middle_ = 0.5 * (bounds_.low + bounds_.high);
    slack_ = std::ldexp(bounds_.low.cwiseAbs().cwiseMax(bounds_.high.cwiseAbs()).maxCoeff(), -22);
    margin_ = std::ldexp((bounds_.high - bounds_.low).norm(), -20);
    device_ = rtcNewDevice("threads=1");  // of a few of these no one wants a thread per core each
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    add_triangles();
    rtcCommitScene(scene_);
  }
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;
  ~Solid() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  double distance(const Vec3& x) const override {
    const double far = to_surface(x);
    return (holds(x) ? -far : far) - slack_;
  }
  Bounds bounds() const override { return {bounds_.low, bounds_.high}; }

  bool in_bounds(const Vec3& x) const {
    return (x.array() >= bounds_.low.array()).all() && (x.array() <= bounds_.high.array()).all();
  }
  // Of the first `rays`, how many say that x is inside.
  int votes(const Vec3& x, int rays) const {
    static const std::array<Vec3, kRays> kDirections = directions();
    int votes = 0;
    for (int k = 0; k < rays; ++k) votes += crossings(x, kDirections[k]) & 1;
    return votes;
  }

 private:
  void add_triangles() {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), surface_.points.size()));
    for (const Vec3& x : surface_.points)
      for (int a = 0; a < 3; ++a) *points++ = static_cast<float>(x[a] - middle_[a]);
    auto* corners =
        static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                       3 * sizeof(uint32_t), surface_.triangles.size()));
    for (const auto& triangle : surface_.triangles)
      for (const uint32_t point : triangle) *corners++ = point;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  // Where the surface leaks, one ray in many goes astray: then all are asked.
  bool holds(const Vec3& x) const {
    if (!in_bounds(x)) return false;
    if (closed_) {
      const int first = votes(x, 3);
      if (first == 0 || first == 3) return first == 3;
    }
    return 2 * votes(x, kRays) > kRays;
  }

  struct Counter : RTCIntersectContext {
    int hits = 0;
  };
  int crossings(const Vec3& x, const Vec3& direction) const {
    Counter counter;
    rtcInitIntersectContext(&counter);
    counter.filter = [](const RTCFilterFunctionNArguments* call) {
      ++static_cast<Counter*>(call->context)->hits;
      call->valid[0] = 0;  // go on
    };
    RTCRay ray{};
    const Vec3 from = x - middle_;
    ray.org_x = static_cast<float>(from[0]), ray.org_y = static_cast<float>(from[1]);
    ray.org_z = static_cast<float>(from[2]), ray.dir_x = static_cast<float>(direction[0]);
    ray.dir_y = static_cast<float>(direction[1]), ray.dir_z = static_cast<float>(direction[2]);
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
    rtcOccluded1(scene_, &counter, &ray);
    return counter.hits;
  }

  struct Nearest {
    const Solid* solid;
    Vec3 x;
    double d2;
  };
  double to_surface(const Vec3& x) const {
    Nearest nearest{this, x, std::numeric_limits<double>::infinity()};
    const Vec3 from = x - middle_;
    RTCPointQuery query{static_cast<float>(from[0]), static_cast<float>(from[1]), static_cast<float>(from[2]),
                        0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(
        scene_, &query, &context,
        [](RTCPointQueryFunctionArguments* call) {
          auto& best = *static_cast<Nearest*>(call->userPtr);
          const Surface& surface = best.solid->surface_;
          const size_t t = call->primID;
          const Vec3 point =
              nearest_point(best.x, surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2));
          const double d2 = (point - best.x).squaredNorm();
          if (d2 >= best.d2) return false;
          best.d2 = d2;
          call->query->radius = static_cast<float>(std::sqrt(d2) + best.solid->margin_);
          return true;
        },
        &nearest);
    return std::sqrt(nearest.d2);
  }

  Surface surface_;
  bool closed_;
  Bounds bounds_{Vec3::Constant(std::numeric_limits<double>::infinity()),
                 Vec3::Constant(-std::numeric_limits<double>::infinity())};
  Vec3 middle_;
  double slack_, margin_;  // m
  RTCDevice device_;
  RTCScene scene_;
};

// Over points drawn in the bounds. One of a closed surface may still be in doubt: a ray grazes an edge.
double doubt_of(const Solid& solid) {
  constexpr int kPoints = 4096;
  const Bounds bounds = solid.bounds();
  std::mt19937_64 random(1);
  int inside = 0, doubtful = 0;
  for (int i = 0; i < kPoints; ++i) {
    Vec3 x;
    for (int a = 0; a < 3; ++a)
      x[a] = bounds.low[a] +
             (bounds.high[a] - bounds.low[a]) * std::ldexp(static_cast<double>(random() >> 11), -53);
    const int votes = solid.votes(x, kRays);
    inside += 2 * votes > kRays;
    doubtful += 2 * votes > kRays && votes < kRays;
  }
  return inside > 0 ? static_cast<double>(doubtful) / inside : 1;
}

}  // namespace

ShapePtr solid_within(Surface surface, MeshFacts& facts) {
  auto solid = std::make_shared<Solid>(std::move(surface), facts.closed());
  facts.doubt = doubt_of(*solid);
  return solid;
}

}  // namespace cuboct
