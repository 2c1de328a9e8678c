// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/element_body.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <utility>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/base/parallel.h"
#include "model/body/random_turn.h"
#include "model/solid/moduli.h"

namespace cuboct {
namespace {

constexpr size_t kElementsAtOnce = 8;  // elements that a thread takes at a time

// The three edges from corner 0.
Mat3 edges_of(const std::array<ElementMesh::Corner, 4>& element, const std::vector<Vec3>& x,
              const Vec3& period) {
  const Vec3 origin = corner_place(element[0], x, period);
  Mat3 out;
  for (int k = 0; k < 3; ++k) out.col(k) = eigen(corner_place(element[k + 1], x, period) - origin);
  return out;
}

size_t parts_of(size_t elements) { return (elements + kElementsAtOnce - 1) / kElementsAtOnce; }

}  // namespace

ElementError::ElementError(size_t element, const std::string& what)
    : std::runtime_error(fmt::format("element {}: {}", element + 1, what)), element(element) {}

void SampleWork::add(const SampleWork& other) {
  updates += other.updates, relaxations += other.relaxations, evaluations += other.evaluations;
  largest_error = std::max(largest_error, other.largest_error);
  squared_error += other.squared_error, measured += other.measured;
}

ElementBody::ElementBody(ElementMesh mesh, std::shared_ptr<const SampleMaterial> material,
                         std::vector<Mat3> turns, const ElementOptions& options, const std::string& name)
    : mesh_(std::move(mesh)), material_(std::move(material)), turns_(std::move(turns)), options_(options) {
  check_mesh(mesh_, name);
  if (turns_.size() < mesh_.grains())
    throw InputError(
        fmt::format("{}: {} grains, but {} lattice orientations", name, mesh_.grains(), turns_.size()));
  x_ = mesh_.x, period_ = mesh_.period;
  const size_t count = mesh_.elements.size();
  for (const Mat3& turn : turns_) constants_.push_back(in_axes(material_->constants, turn.transpose()));
  mass_.assign(x_.size(), 0), force_.assign(x_.size(), Vec3::Zero());
  for (size_t e = 0; e < count; ++e) {
    const Mat3 edges = edges_of(mesh_.elements[e], x_, period_);
    inverse_edges_.push_back(edges.inverse());
    rest_volume_.push_back(edges.determinant() / 6);
    for (const auto& corner : mesh_.elements[e])
      mass_[corner.vertex] += material_->lattice.density() * rest_volume_[e] / 4;
  }
  volume_ = rest_volume_, energy_.assign(count, 0), stress_.assign(count, Mat3::Zero());
  rest_.resize(count), strained_.resize(count), corner_force_.resize(count);
  relaxer_ = (options_.relaxer ? options_.relaxer : host_relaxer(options_.threads))(*material_, count);
}

Mat3 ElementBody::gradient(size_t element) const {
  return edges_of(mesh_.elements[element], x_, period_) * inverse_edges_[element];
}

void ElementBody::update() {
  strain_elements();
  relax_due();
  stress_elements();
  add_forces();
}

// Calls work(element, part) of all elements, in threads; the parts are the same with any number of those.
template <typename Work>
void ElementBody::for_each_element(const Work& work) const {
  const size_t count = mesh_.elements.size();
  for_each_part(parts_of(count), options_.threads, [&](size_t part, int) {
    for (size_t e = part * kElementsAtOnce; e < std::min(count, (part + 1) * kElementsAtOnce); ++e)
      work(e, part);
  });
}

void ElementBody::strain_elements() {
  for_each_element([&](size_t e, size_t) { strain_element(e); });
}

void ElementBody::relax_due() {
  due_.clear();
  for (size_t e = 0; e < strained_.size(); ++e) {
    if (!strained_[e].due) continue;
    strained_[e].due_at = due_.size();
    due_.push_back({e, strained_[e].stretch * material_->lattice.cell});
  }
  answers_.resize(due_.size());
  if (!due_.empty()) relaxer_->relax(due_, answers_);
}

void ElementBody::stress_elements() {
  std::vector<SampleWork> works(parts_of(mesh_.elements.size()));
  for_each_element([&](size_t e, size_t part) {
    ++works[part].updates;
    if (strained_[e].due) take_answer(e, answers_[strained_[e].due_at], works[part]);
    stress_element(e);
    push_corners(e);
  });
  for (const SampleWork& work : works) work_.add(work);
}

// With G = D Q of equation 7 all is told in the axes of the lattice: Green's strain (G^T G - 1)/2, the second
// Piola-Kirchhoff stress S, and Cauchy's G S G^T/det G in those of space. A rotation of the element changes G
// alone, and the atoms' energy does not see it: H, the upper triangle with H^T H = G^T G, stands for G. So
// samples of all grains are alike, and a list of neighbours serves them all.
void ElementBody::strain_element(size_t element) {
  Strained& now = strained_[element];
  now.gradient = gradient(element) * turns_[mesh_.grain[element]];
  now.expansion = now.gradient.determinant();
  if (!(now.expansion > 0)) throw ElementError(element, "it turned inside out");
  now.strain = green_strain(now.gradient);
  now.due = (now.strain - rest_[element].strain).cwiseAbs().maxCoeff() > options_.strain_tolerance;
  if (now.due) now.stretch = (Mat3::Identity() + 2 * now.strain).llt().matrixU();
}

void ElementBody::stress_element(size_t element) {
  const Mat3& g = strained_[element].gradient;
  const double expansion = strained_[element].expansion;
  const SampleRest& rest = rest_[element];
  const Mat3 moved = strained_[element].strain - rest.strain;
  const Mat3 change = stress_of(material_->constants, moved);
  energy_[element] = rest.energy + (rest.stress + change / 2).cwiseProduct(moved).sum();
  stress_[element] = g * (rest.stress + change) * g.transpose() / expansion;
  volume_[element] = rest_volume_[element] * expansion;
}

void ElementBody::take_answer(size_t element, const SampleAnswer& answer, SampleWork& work) {
  const auto &strain = strained_[element].strain, &h = strained_[element].stretch;
  SampleRest& rest = rest_[element];
  work.evaluations += answer.evaluations, ++work.relaxations;
  if (!answer.at_rest)
    throw ElementError(element,
                       fmt::format("its sample found no rest: a force of {:.3g} eV/angstrom is left after "
                                   "{} evaluations, {:.3g} were asked for",
                                   answer.force, answer.evaluations, material_->relaxation.force));
  const Mat3 inverse = h.inverse(), stress = h.determinant() * inverse * answer.stress * inverse.transpose();
  if (options_.strain_tolerance > 0) {
    const Mat3 expected = rest.stress + stress_of(material_->constants, strain - rest.strain);
    const double error = (stress - expected).cwiseAbs().maxCoeff();
    work.largest_error = std::max(work.largest_error, error);
    work.squared_error += error * error, ++work.measured;
  }
  const auto atoms = static_cast<double>(material_->lattice.place.size());
  rest.energy = kPascal * (answer.energy - atoms * material_->energy) / material_->lattice.cell.determinant();
  rest.strain = strain, rest.stress = stress;
}

// Equation 11: of the force S n on a face its vertices carry a third each. A vertex takes the reaction of its
// three faces; since the four normals of an element add up to 0, that is S times a third of the normal of the
// face across.
void ElementBody::push_corners(size_t element) {
  const Mat3 edges = edges_of(mesh_.elements[element], x_, period_);
  const Vec3 a = edges.col(0), b = edges.col(1), c = edges.col(2);
  const std::array<Vec3, 4> normal{(b - a).cross(c - a) / 2, c.cross(b) / 2, a.cross(c) / 2, b.cross(a) / 2};
  for (size_t k = 0; k < 4; ++k) corner_force_[element][k] = stress_[element] * normal[k] / 3;
}

// In the order of the elements, whatever the threads.
void ElementBody::add_forces() {
  std::ranges::fill(force_, Vec3::Zero());
  for (size_t e = 0; e < mesh_.elements.size(); ++e)
    for (size_t k = 0; k < 4; ++k) force_[mesh_.elements[e][k].vertex] += corner_force_[e][k];
}

double ElementBody::energy() const {
  double sum = 0;
  for (size_t e = 0; e < energy_.size(); ++e) sum += rest_volume_[e] * energy_[e];
  return sum;
}

double ElementBody::volume() const {
  double sum = 0;
  for (const double one : volume_) sum += one;
  return sum;
}

Mat3 ElementBody::mean_stress() const {
  Mat3 sum = Mat3::Zero();
  for (size_t e = 0; e < stress_.size(); ++e) sum += volume_[e] * stress_[e];
  return sum / volume();
}

void ElementBody::restore(std::vector<ElementSample> samples, const SampleWork& work) {
  SampleRelaxer::Places places;
  for (size_t e = 0; e < samples.size(); ++e) {
    rest_[e] = samples[e];
    places.push_back(std::move(samples[e].place));
  }
  relaxer_->set_places(std::move(places));
  work_ = work;
}

std::vector<ElementSample> ElementBody::samples() const {
  SampleRelaxer::Places places = relaxer_->places();
  std::vector<ElementSample> out;
  for (size_t e = 0; e < places.size(); ++e) out.push_back({rest_[e], std::move(places[e])});
  return out;
}

std::vector<Mat3> random_turns(size_t grains, uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::vector<Mat3> out;
  for (size_t g = 0; g < grains; ++g) out.push_back(random_turn(generator));
  return out;
}

}  // namespace cuboct
