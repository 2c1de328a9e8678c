// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/element_stiffness.h"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace cuboct {
namespace {

using Triplet = Eigen::Triplet<double>;
using StrainOfVertices = Eigen::Matrix<double, 6, 12>;

constexpr int kIterations = 60;

// Voigt's strain (shears twice) of the displacements of the four corners.
StrainOfVertices strain_matrix(const Mat3& inverse_edges) {
  StrainOfVertices out = StrainOfVertices::Zero();
  for (int k = 0; k < 4; ++k) {
    const Vec3 g = k == 0 ? Vec3(-inverse_edges.colwise().sum().transpose())
                          : Vec3(inverse_edges.row(k - 1).transpose());
    for (int v = 0; v < 6; ++v) {
      const auto [a, b] = kVoigt[v];
      out(v, 3 * k + a) += g[b];
      if (a != b) out(v, 3 * k + b) += g[a];
    }
  }
  return out;
}

void add(std::vector<Triplet>& out, const ElementBody& body, size_t element) {
  const ElementMesh& mesh = body.mesh();
  const StrainOfVertices strain = strain_matrix(body.inverse_edges(element));
  const Eigen::Matrix<double, 12, 12> k =
      body.rest_volume(element) * strain.transpose() * body.constants(mesh.grain[element]) * strain;
  const auto row = [&](int i) {
    return static_cast<int>(3 * mesh.elements[element][static_cast<size_t>(i / 3)].vertex) + i % 3;
  };
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) out.emplace_back(row(i), row(j), k(i, j));
}

}  // namespace

Eigen::SparseMatrix<double> element_stiffness(const ElementBody& body) {
  std::vector<Triplet> triplets;
  for (size_t e = 0; e < body.mesh().elements.size(); ++e) add(triplets, body, e);
  const auto size = static_cast<Eigen::Index>(3 * body.x().size());
  Eigen::SparseMatrix<double> out(size, size);
  out.setFromTriplets(triplets.begin(), triplets.end());
  return out;
}

double fastest_vibration(const ElementBody& body, const Eigen::SparseMatrix<double>& stiffness) {
  Eigen::VectorXd root(stiffness.rows()), v(stiffness.rows());
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    root[i] = 1 / std::sqrt(body.mass()[static_cast<size_t>(i / 3)]);
    v[i] = std::sin(static_cast<double>(i * i));  // of all vibrations a part
  }
  double square = 0;
  for (int k = 0; k < kIterations; ++k) {
    v.normalize();
    v = root.cwiseProduct(stiffness * root.cwiseProduct(v));
    square = v.norm();
  }
  return std::sqrt(square);
}

}  // namespace cuboct
