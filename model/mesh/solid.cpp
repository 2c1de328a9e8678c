// SPDX-License-Identifier: MIT
#include "model/mesh/solid.h"

#include <embree3/rtcore.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

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

// Of rays from a point, those for which it is inside, and those for which it is inside more than once.
struct Votes {
  int inside = 0, twice = 0;
};

// Embree's searches are in floats: about the middle of the body, and a margin wider than their rounding.
class Solid final : public Shape {
 public:
  Solid(Surface surface, bool closed)
      : Shape(100), surface_(std::move(surface)), closed_(closed), volumes_(volumes_of(surface_)) {
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
    turn_outwards();
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

  bool in_bounds(const Vec3& x) const { return x.within(bounds_.low, bounds_.high); }
  // Of the first `rays`; those of the shell `but` set aside.
  Votes votes(const Vec3& x, int rays, uint32_t but = kNoShell) const {
    static const std::array<Vec3, kRays> kDirections = directions();
    Votes votes;
    for (int k = 0; k < rays; ++k) {
      const int windings = std::abs(windings_about(x, kDirections[k], but));
      votes.inside += windings > 0 ? 1 : 0;
      votes.twice += windings > 1 ? 1 : 0;
    }
    return votes;
  }
  double volume() const {
    double sum = 0;
    for (const double volume : volumes_) sum += volume;
    return sum;
  }
  size_t inside_out() const { return inside_out_; }

 private:
  static constexpr uint32_t kNoShell = std::numeric_limits<uint32_t>::max();

  // A shell whose normals point inwards is a cavity where another holds it, else a body that is inside out.
  // Where a body reaches into others, some of its corners do not.
  void turn_outwards() {
    sense_.assign(volumes_.size(), 1);
    if (volume() < 0)
      for (size_t s = 0; s < sense_.size(); ++s) sense_[s] = -1, volumes_[s] = -volumes_[s];
    constexpr size_t kCorners = 8;
    std::vector<size_t> size(volumes_.size()), seen(volumes_.size());
    for (const uint32_t shell : surface_.shells) ++size[shell];
    for (size_t t = 0; t < surface_.triangles.size(); ++t) {
      const uint32_t shell = surface_.shells[t];
      if (volumes_[shell] >= 0 || seen[shell]++ % (size[shell] / kCorners + 1) != 0) continue;
      if (2 * votes(surface_.corner(t, 0), kRays, shell).inside > kRays) continue;
      sense_[shell] = -sense_[shell], volumes_[shell] = -volumes_[shell];
      ++inside_out_;
    }
  }
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
      const int first = votes(x, 3).inside;
      if (first == 0 || first == 3) return first == 3;
    }
    return 2 * votes(x, kRays).inside > kRays;
  }

  // How often the surface winds about x: what a ray leaves less what it enters. Of bodies that overlap each
  // counts one, of a body's cavity none is left.
  struct Counter : RTCIntersectContext {
    const Solid* solid;
    Vec3 direction;
    uint32_t but;
    int windings = 0;
  };
  int windings_about(const Vec3& x, const Vec3& direction, uint32_t but) const {
    Counter counter;
    rtcInitIntersectContext(&counter);
    counter.solid = this, counter.direction = direction, counter.but = but;
    counter.filter = [](const RTCFilterFunctionNArguments* call) {
      auto& counter = *static_cast<Counter*>(call->context);
      const Solid& solid = *counter.solid;
      const uint32_t triangle = RTCHitN_primID(call->hit, call->N, 0);
      const uint32_t shell = solid.surface_.shells[triangle];
      const bool leaves = area_vector(solid.surface_, triangle).dot(counter.direction) > 0;
      if (shell != counter.but) counter.windings += leaves ? solid.sense_[shell] : -solid.sense_[shell];
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
    return counter.windings;
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
  std::vector<double> volumes_;  // m^3, of shells: negative of cavities
  std::vector<int8_t> sense_;    // of shells: -1 where the triangles' normals point into the body
  size_t inside_out_ = 0;        // bodies among others that were not
  Bounds bounds_{Vec3::Constant(std::numeric_limits<double>::infinity()),
                 Vec3::Constant(-std::numeric_limits<double>::infinity())};
  Vec3 middle_;
  double slack_, margin_;  // m
  RTCDevice device_;
  RTCScene scene_;
};

// Over points drawn in the bounds. One of a closed surface may still be in doubt: a ray grazes an edge.
void draw_points(const Solid& solid, MeshFacts& facts) {
  constexpr int kPoints = 4096;
  const Bounds bounds = solid.bounds();
  std::mt19937_64 random(1);
  int inside = 0, doubtful = 0, twice = 0;
  for (int i = 0; i < kPoints; ++i) {
    Vec3 x;
    for (int a = 0; a < 3; ++a)
      x[a] = bounds.low[a] +
             (bounds.high[a] - bounds.low[a]) * std::ldexp(static_cast<double>(random() >> 11), -53);
    const Votes votes = solid.votes(x, kRays);
    if (2 * votes.inside < kRays) continue;
    ++inside;
    doubtful += votes.inside < kRays ? 1 : 0;
    twice += 2 * votes.twice > kRays ? 1 : 0;
  }
  facts.doubt = inside > 0 ? static_cast<double>(doubtful) / inside : 1;
  facts.overlap = inside > 0 ? static_cast<double>(twice) / inside : 0;
}

}  // namespace

ShapePtr solid_within(Surface surface, MeshFacts& facts) {
  auto solid = std::make_shared<Solid>(std::move(surface), facts.closed());
  facts.volume = solid->volume();
  facts.inside_out = solid->inside_out();
  draw_points(*solid, facts);
  return solid;
}

}  // namespace cuboct
