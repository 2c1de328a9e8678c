// SPDX-License-Identifier: MIT
// A pulse that runs through a body from one of its faces: where its front is at which time, and how fast.
#pragma once

#include <vector>

#include "model/atoms/multiscale/element_motion.h"
#include "model/solid/moduli.h"

namespace cuboct {

// A traction on the face at the low end of `axis`: peak sin^2(pi t/pulse) while t < pulse, along
// `polarisation`.
struct Pulse {
  int axis = 0, polarisation = 0;
  double peak = 0;    // Pa
  double length = 0;  // s
};

// The vertices of that face with their parts of its area (m^2): of each triangle a third.
struct FaceShare {
  uint32_t vertex;
  double area;
};
std::vector<FaceShare> low_face(const ElementMesh& mesh, int axis);

VertexLoad load_of(const ElementMesh& mesh, const Pulse& pulse);

// Slices across the axis, as many as there are elements' edges along it.
class WaveSlices {
 public:
  WaveSlices(const ElementBody& body, int axis);
  size_t size() const { return place_.size(); }
  double place(size_t slice) const { return place_[slice]; }  // m, of its mass, from the low end
  double length() const { return length_; }                   // m, of the body
  double width() const { return width_; }                     // m, of a slice
  // m/s, means over the mass of each slice, along `polarisation`.
  std::vector<double> velocities(const ElementMotion& motion, int polarisation) const;

 private:
  const std::vector<double>& mass_;
  std::vector<uint32_t> slice_of_;  // of each vertex
  std::vector<double> place_, weight_;
  double length_ = 0, width_ = 0;
};

struct FrontPoint {
  double time = 0, place = 0;  // s, m
};

// For each slice in [from, to] (m) the time at which its velocity first rises through half of its peak.
// `history` [step][slice] in m/s, dt in s. A slice that the front did not pass is left out.
std::vector<FrontPoint> front_of(const WaveSlices& slices, const std::vector<std::vector<double>>& history,
                                 double dt, double from, double to);

struct FrontSpeed {
  double speed = 0, error = 0;  // m/s; standard error of the fit
};
FrontSpeed speed_of(const std::vector<FrontPoint>& front);

// m/s, of isotropic matter: a plane wave of pressure, one of shear, one along a thin rod, one in a thin
// plate's plane.
double pressure_speed(const Isotropic& matter, double density);
double shear_speed(const Isotropic& matter, double density);
double rod_speed(const Isotropic& matter, double density);
double sheet_speed(const Isotropic& matter, double density);

// That of the four that a body shows with such sides.
double expected_speed(const Isotropic& matter, double density, const Pulse& pulse, const Vec3& period);

}  // namespace cuboct
