// SPDX-License-Identifier: MIT
#include "model/solid/dynamical_matrix.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>

#include "model/base/error.h"
#include "model/base/mat3.h"

namespace cuboct {
namespace {

// A neighbour and what its bond does for small displacements: the force constants are
// `axial` e e^T + `lateral` (1 - e e^T), axial = U'' = -df/dr, lateral = U'/r = -f/r, in N/m.
struct Bond {
  Vec3 d;
  Mat3 constants;
};

// One of each pair of opposite neighbours.
std::vector<Bond> half_bonds(const PairLaw& law, double pitch) {
  std::vector<Bond> bonds;
  for (const Vec3& d : fcc_neighbours(pitch, law.cutoff())) {
    const bool upper = d.z() > 0 || (d.z() == 0 && (d.y() > 0 || (d.y() == 0 && d.x() > 0)));
    if (!upper) continue;
    const double r = d.norm();
    const double axial = -law.slope(r), lateral = -law.force(r) / r;
    const Vec3 e = d / r;
    bonds.push_back({d, lateral * Mat3::Identity() + (axial - lateral) * e * e.transpose()});
  }
  return bonds;
}

// Of m D(q) = sum over all neighbours of constants * (1 - cos q.d); opposite ones contribute the same.
Vec3 wave_stiffness(const std::vector<Bond>& bonds, const Vec3& q) {
  Mat3 sum = Mat3::Zero();
  for (const Bond& bond : bonds) sum += 2 * (1 - std::cos(q.dot(bond.d))) * bond.constants;
  return eigenvalues(sum);
}

// The reciprocal cell in as many parts along each edge: the points hold Gamma, X (1/2), L (1/2), W (1/4), K
// (3/8) and U (5/8).
constexpr int kGrid = 24;
// Of the grid's points, those whose surroundings are searched.
constexpr size_t kKept = 8;

// Columns: the reciprocal vectors, b_i . a_j = 2 pi for the primitive cell of edges (0,1,1), (1,0,1), (1,1,0)
// half cubic edges.
Mat3 reciprocal_vectors(double pitch) {
  Mat3 b;
  b << -1, 1, 1, 1, -1, 1, 1, 1, -1;
  return b * (std::numbers::pi * std::numbers::sqrt2 / pitch);
}

// The points of half the grid (q and -q are equal) among whose values the kKept largest are, in the grid's
// order. There q.d is 2 pi/kGrid times a whole number, and bonds that differ by a multiple of kGrid along an
// edge do the same: a law that reaches over thousands of neighbours costs no more than kGrid^3/2.
std::vector<Vec3> best_of_grid(const std::vector<Bond>& bonds, const Mat3& reciprocal) {
  constexpr double kRounding = 1e-9;  // of the values: they are sums of thousands at the most
  std::map<std::array<int, 3>, Mat3> classes;
  for (const Bond& bond : bonds) {
    std::array<int, 3> turns;  // b_i . d over 2 pi, modulo kGrid
    for (int a = 0; a < 3; ++a) {
      const auto whole = std::lround(reciprocal.col(a).dot(eigen(bond.d)) / (2 * std::numbers::pi));
      turns[a] = static_cast<int>((whole % kGrid + kGrid) % kGrid);
    }
    classes.try_emplace(turns, Mat3::Zero()).first->second += bond.constants;
  }
  std::array<double, kGrid> weight;
  for (int n = 0; n < kGrid; ++n) weight[n] = 2 * (1 - std::cos(2 * std::numbers::pi * n / kGrid));
  std::vector<Vec3> points;
  std::vector<double> values;
  for (int k = 0; k <= kGrid / 2; ++k)
    for (int j = 0; j < kGrid; ++j)
      for (int i = 0; i < kGrid; ++i) {
        Mat3 sum = Mat3::Zero();
        for (const auto& [turns, constants] : classes)
          sum += weight[(i * turns[0] + j * turns[1] + k * turns[2]) % kGrid] * constants;
        points.push_back(Vec3(i, j, k) / kGrid);
        values.push_back(eigenvalues(sum)[2]);
      }
  std::vector<double> sorted = values;
  std::ranges::nth_element(sorted, sorted.begin() + kKept - 1, std::greater());
  const double least = sorted[kKept - 1] - kRounding * std::abs(*std::ranges::max_element(values));
  std::vector<Vec3> best;
  for (size_t n = 0; n < points.size(); ++n)
    if (values[n] >= least) best.push_back(points[n]);
  return best;
}

}  // namespace

void check_neighbours(double pitch, double cutoff, double most) {
  const double count = 4 * std::numbers::pi / 3 * std::pow(cutoff, 3) / fcc_volume(pitch);
  if (count > most)
    throw InputError(
        fmt::format("a cutoff of {:.4g} m reaches over some {:.3g} neighbours at a pitch of {:.4g} m: "
                    "at most {:.3g} are summed",
                    cutoff, count, pitch, most),
        "a shorter cutoff, or a larger pitch");
}

std::vector<Vec3> fcc_neighbours(double pitch, double cutoff) {
  check_neighbours(pitch, cutoff, kMostOnce);
  const double half_edge = pitch / std::numbers::sqrt2;  // of the cubic cell
  const int n = static_cast<int>(std::ceil(cutoff / half_edge));
  std::vector<Vec3> neighbours;
  for (int z = -n; z <= n; ++z) {
    for (int y = -n; y <= n; ++y) {
      for (int x = -n; x <= n; ++x) {
        if ((x + y + z) % 2 != 0 || (x == 0 && y == 0 && z == 0)) continue;
        const Vec3 d = half_edge * Vec3(x, y, z);
        if (d.norm() < cutoff) neighbours.push_back(d);
      }
    }
  }
  return neighbours;
}

double fcc_volume(double pitch) { return pitch * pitch * pitch / std::numbers::sqrt2; }

double fcc_energy(const PairLaw& law, double pitch) {
  double sum = 0;
  for (const Vec3& d : fcc_neighbours(pitch, law.cutoff())) sum += law.energy(d.norm());
  return sum / 2;
}

double fcc_pressure(const PairLaw& law, double pitch) {
  double virial = 0;
  for (const Vec3& d : fcc_neighbours(pitch, law.cutoff())) virial += law.force(d.norm()) * d.norm();
  return virial / (6 * fcc_volume(pitch));
}

Vec3 squared_frequencies(const PairLaw& law, double mass, double pitch, const Vec3& q) {
  return wave_stiffness(half_bonds(law, pitch), q) / mass;
}

double largest_frequency(const PairLaw& law, double mass, double pitch, double tolerance) {
  const std::vector<Bond> bonds = half_bonds(law, pitch);
  const Mat3 reciprocal = reciprocal_vectors(pitch);
  struct Candidate {
    double value;
    Vec3 at;
  };
  std::vector<Candidate> best;
  for (const Vec3& at : best_of_grid(bonds, reciprocal))
    best.push_back({wave_stiffness(bonds, reciprocal * at)[2], at});
  std::ranges::stable_sort(best, std::greater(), &Candidate::value);
  best.resize(std::min(best.size(), kKept));
  // Compass search: the largest eigenvalue is continuous, but kinks where branches cross. Off the top by s
  // (of a reciprocal edge) it falls by (2 pi n s)^2/2 of itself at most, n the neighbours along the cutoff;
  // some ten make the least step.
  const double least = std::max(1e-7, 0.02 * std::sqrt(tolerance));
  double largest = 0;
  for (Candidate c : best) {
    for (double step = 0.5 / kGrid; step > least; step /= 2) {
      for (bool moved = true; moved;) {
        moved = false;
        for (int axis = 0; axis < 3; ++axis) {
          for (const double sign : {-1.0, 1.0}) {
            Vec3 at = c.at;
            at[axis] += sign * step;
            const double value = wave_stiffness(bonds, reciprocal * at)[2];
            // Above rounding, or the search could wander on a flat top; it lies below 0 where no wave comes
            // back.
            if (value > c.value + tolerance * std::abs(c.value)) {
              c = {value, at};
              moved = true;
            }
          }
        }
      }
    }
    largest = std::max(largest, c.value);
  }
  return std::sqrt(largest / mass);
}

double largest_frequency(const Rule& rule, double pitch) {
  double fastest = 0;
  for (size_t k = 0; k < rule.laws(); ++k) {
    const double rate = rule.largest_rate(k);
    if (rate > 0)
      fastest = std::max(fastest, largest_frequency(rule.law_at(k), rule.mass, pitch) * std::sqrt(rate));
  }
  return fastest;
}

double relaxed_pitch(const PairLaw& law, double guess) {
  if (!(guess > 0)) throw InputError(fmt::format("relaxed_pitch: the guess {:g} m is not above 0", guess));
  const auto pressure = [&](double pitch) { return fcc_pressure(law, pitch); };
  // The root of the crossing between a < b, or nothing where it is a jump.
  const auto root = [&](double a, double b) -> std::optional<double> {
    const double before = std::max(std::abs(pressure(a)), std::abs(pressure(b)));
    for (double middle = a + (b - a) / 2; middle > a && middle < b; middle = a + (b - a) / 2) {
      (pressure(middle) > 0 ? a : b) = middle;
    }
    const bool jump = std::min(std::abs(pressure(a)), std::abs(pressure(b))) > 1e-6 * before;
    return jump ? std::nullopt : std::optional(std::abs(pressure(a)) < std::abs(pressure(b)) ? a : b);
  };
  constexpr double kStep = 1.002;  // per stride of the search
  const double here = pressure(guess);
  if (here == 0 && pressure(guess / kStep) > 0 && pressure(guess * kStep) < 0) return guess;
  double low = guess, high = guess;
  double at_low = here, at_high = here;
  while (high < 2 * guess) {
    const double lower = low / kStep, higher = high * kStep;
    const double at_lower = pressure(lower), at_higher = pressure(higher);
    if (at_high >= 0 && at_higher < 0) {
      if (const auto found = root(high, higher)) return *found;
    }
    if (at_lower > 0 && at_low <= 0) {
      if (const auto found = root(lower, low)) return *found;
    }
    low = lower, high = higher, at_low = at_lower, at_high = at_higher;
  }
  throw InputError(fmt::format("the packing has no pitch of zero pressure between {:g} m and {:g} m",
                               guess / 2, 2 * guess));
}

}  // namespace cuboct
