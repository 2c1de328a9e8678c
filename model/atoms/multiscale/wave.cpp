// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/wave.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "model/base/error.h"

namespace cuboct {
namespace {

constexpr double kPlane = 1e-6;    // of an element's edge: a vertex that near to the end lies in its face
constexpr double kNothing = 1e-3;  // of the largest velocity of all: less is no front

double low_end(const ElementMesh& mesh, int axis) {
  double low = mesh.x[0][axis];
  for (const Vec3& x : mesh.x) low = std::min(low, x[axis]);
  return low;
}

double edge_of(const ElementMesh& mesh) {
  double sum = 0;
  for (size_t e = 0; e < mesh.elements.size(); ++e) sum += element_volume(mesh, e);
  return std::cbrt(6 * sum / static_cast<double>(mesh.elements.size()));
}

constexpr std::array<std::array<int, 3>, 4> kFaces{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

}  // namespace

std::vector<FaceShare> low_face(const ElementMesh& mesh, int axis) {
  const double low = low_end(mesh, axis), near = kPlane * edge_of(mesh);
  std::map<uint32_t, double> area;
  for (const auto& element : mesh.elements)
    for (const auto& face : kFaces) {
      std::array<Vec3, 3> p;
      for (int k = 0; k < 3; ++k) p[k] = corner_place(element[face[k]], mesh.x, mesh.period);
      if (std::ranges::any_of(p, [&](const Vec3& x) { return std::abs(x[axis] - low) > near; })) continue;
      for (const int k : face) area[element[k].vertex] += (p[1] - p[0]).cross(p[2] - p[0]).norm() / 6;
    }
  std::vector<FaceShare> out;
  for (const auto& [vertex, share] : area) out.push_back({vertex, share});
  return out;
}

VertexLoad load_of(const ElementMesh& mesh, const Pulse& pulse) {
  const std::vector<FaceShare> face = low_face(mesh, pulse.axis);
  if (face.empty()) throw InputError("no face of an element lies in the plane where the wave begins");
  return [face, pulse](double time, std::vector<Vec3>& force) {
    if (time >= pulse.length) return;
    const double s = std::sin(std::numbers::pi * time / pulse.length);
    for (const FaceShare& share : face)
      force[share.vertex][pulse.polarisation] += pulse.peak * s * s * share.area;
  };
}

WaveSlices::WaveSlices(const ElementBody& body, int axis) : mass_(body.mass()) {
  const ElementMesh& mesh = body.mesh();
  const double low = low_end(mesh, axis);
  for (const Vec3& x : mesh.x) length_ = std::max(length_, x[axis] - low);
  const double slices = std::max(1.0, std::round(length_ / edge_of(mesh)));
  width_ = length_ / slices;
  const auto count = static_cast<size_t>(slices) + 1;
  place_.assign(count, 0), weight_.assign(count, 0);
  for (size_t v = 0; v < mesh.x.size(); ++v) {
    const double at = mesh.x[v][axis] - low;
    slice_of_.push_back(static_cast<uint32_t>(std::lround(at / width_)));
    place_[slice_of_[v]] += mass_[v] * at, weight_[slice_of_[v]] += mass_[v];
  }
  for (size_t s = 0; s < count; ++s)
    if (weight_[s] > 0) place_[s] /= weight_[s];
}

std::vector<double> WaveSlices::velocities(const ElementMotion& motion, int polarisation) const {
  std::vector<double> out(place_.size(), 0);
  for (size_t v = 0; v < mass_.size(); ++v) out[slice_of_[v]] += mass_[v] * motion.v()[v][polarisation];
  for (size_t s = 0; s < out.size(); ++s)
    if (weight_[s] > 0) out[s] /= weight_[s];
  return out;
}

std::vector<FrontPoint> front_of(const WaveSlices& slices, const std::vector<std::vector<double>>& history,
                                 double dt, double from, double to) {
  double most = 0;
  for (const auto& row : history)
    for (const double v : row) most = std::max(most, v);
  std::vector<FrontPoint> out;
  for (size_t s = 0; s < slices.size(); ++s) {
    if (slices.place(s) < from || slices.place(s) > to) continue;
    double peak = 0;
    for (const auto& row : history) peak = std::max(peak, row[s]);
    if (!(peak > kNothing * most)) continue;
    for (size_t k = 1; k < history.size(); ++k) {
      const double before = history[k - 1][s], after = history[k][s];
      if (before < peak / 2 && after >= peak / 2) {
        const double part = (peak / 2 - before) / (after - before);
        out.push_back({(static_cast<double>(k - 1) + part) * dt, slices.place(s)});
        break;
      }
    }
  }
  return out;
}

FrontSpeed speed_of(const std::vector<FrontPoint>& front) {
  if (front.size() < 3)
    throw InputError(fmt::format("the front passed {} slices: a speed takes at least 3", front.size()),
                     "a longer body, a shorter pulse, or a longer time");
  double t = 0, x = 0, tt = 0, tx = 0;
  const auto n = static_cast<double>(front.size());
  for (const FrontPoint& p : front) t += p.time / n, x += p.place / n;
  for (const FrontPoint& p : front) tt += (p.time - t) * (p.time - t), tx += (p.time - t) * (p.place - x);
  FrontSpeed out{tx / tt, 0};
  double squares = 0;
  for (const FrontPoint& p : front) squares += std::pow(p.place - x - out.speed * (p.time - t), 2);
  out.error = std::sqrt(squares / (n - 2) / tt);
  return out;
}

double pressure_speed(const Isotropic& matter, double density) {
  return std::sqrt((matter.bulk + 4 * matter.shear / 3) / density);
}
double shear_speed(const Isotropic& matter, double density) { return std::sqrt(matter.shear / density); }
double rod_speed(const Isotropic& matter, double density) { return std::sqrt(matter.youngs() / density); }
double sheet_speed(const Isotropic& matter, double density) {
  return std::sqrt(matter.youngs() / (1 - matter.poisson() * matter.poisson()) / density);
}

double expected_speed(const Isotropic& matter, double density, const Pulse& pulse, const Vec3& period) {
  if (pulse.polarisation != pulse.axis) return shear_speed(matter, density);
  int repeats = 0;
  for (int a = 0; a < 3; ++a) repeats += a != pulse.axis && period[a] > 0;
  return repeats == 2   ? pressure_speed(matter, density)
         : repeats == 1 ? sheet_speed(matter, density)
                        : rod_speed(matter, density);
}

}  // namespace cuboct
