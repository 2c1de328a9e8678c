// SPDX-License-Identifier: MIT
// A body of macro-elements, each with its sample of atoms: from vertices to forces on vertices. Zhuravlev et
// al., Symmetry 13 (2021) 219: equations 5 to 7 and 9 to 11, the same for an element and its sample.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/atoms/multiscale/element_mesh.h"
#include "model/atoms/multiscale/sample_relaxer.h"
#include "model/base/mat3.h"

namespace cuboct {

// Ends a run: an element that turned inside out, or a sample that found no rest. Elements count from 1.
class ElementError : public std::runtime_error {
 public:
  ElementError(size_t element, const std::string& what);
  size_t element;
};

// What the last relaxation of an element's sample said.
struct SampleRest {
  Mat3 strain = Mat3::Zero();  // Green's, of that relaxation, in the axes of the lattice
  Mat3 stress = Mat3::Zero();  // Pa, second Piola-Kirchhoff's, in those too
  double energy = 0;           // J/m^3 of the undeformed element, 0 without strain
};

// The sample of an element, as its last relaxation left it.
struct ElementSample : SampleRest {
  std::vector<Vec3> place;  // fractions of the strained sample's edges
};

// What the samples did, and how far the stresses between relaxations were off.
struct SampleWork {
  uint64_t updates = 0;      // an element's stress for new places of its vertices
  uint64_t relaxations = 0;  // of those, the ones that relaxed its sample
  uint64_t evaluations = 0;  // of a sample's forces
  double largest_error = 0;  // Pa, of a component, where a relaxation ended a stretch without one
  double squared_error = 0;  // Pa^2, sum over the relaxations that did
  uint64_t measured = 0;     // how many those are
  void add(const SampleWork& other);
};

struct ElementOptions {
  // A sample is relaxed anew where a component of its Green strain moved by more than this since its last
  // relaxation; 0: always. Between, its stress changes by the constants of the undeformed sample.
  double strain_tolerance = 0;
  int threads = 1;         // they change no bit
  RelaxerMaker relaxer{};  // none: host_relaxer(threads)
};

class ElementBody {
 public:
  // `turn` of each grain takes lattice axes to those of space. Refuses a mesh as check_mesh does.
  ElementBody(ElementMesh mesh, std::shared_ptr<const SampleMaterial> material, std::vector<Mat3> turns,
              const ElementOptions& options, const std::string& name = "mesh");

  // Relaxes samples and fills `force` (N) of the vertices, which are at x() with the period() of now.
  // ElementError.
  void update();

  std::vector<Vec3>& x() { return x_; }  // m, vertices
  const std::vector<Vec3>& x() const { return x_; }
  Vec3& period() { return period_; }  // m, of now; 0: does not repeat
  const Vec3& period() const { return period_; }
  const ElementMesh& mesh() const { return mesh_; }
  const SampleMaterial& material() const { return *material_; }
  const std::vector<Mat3>& turns() const { return turns_; }

  // Of the last update.
  const std::vector<Vec3>& force() const { return force_; }    // N
  const std::vector<Mat3>& stress() const { return stress_; }  // Pa, Cauchy's, of each element
  double energy() const;                                       // J, of the samples' strain
  double volume() const;                                       // m^3, of now
  Mat3 mean_stress() const;                                    // Pa, over the volume of now

  const std::vector<double>& mass() const { return mass_; }                   // kg, of the vertices
  double rest_volume(size_t element) const { return rest_volume_[element]; }  // m^3
  Mat3 gradient(size_t element) const;                                        // equation 5
  // Pa, axes of space, of the undeformed samples of a grain.
  const Matrix6& constants(uint32_t grain) const { return constants_[grain]; }
  const Mat3& inverse_edges(size_t element) const {
    return inverse_edges_[element];
  }  // 1/m, of the undeformed

  const SampleWork& work() const { return work_; }
  std::vector<ElementSample> samples() const;
  // Of a run that goes on: the next update then ends as it did in the run before.
  void restore(std::vector<ElementSample> samples, const SampleWork& work);

 private:
  // An element in the update at hand, in the axes of its lattice.
  struct Strained {
    Mat3 gradient, strain;
    double expansion;
    bool due;       // to be relaxed
    Mat3 stretch;   // where due: the upper triangle H with H^T H = 1 + 2 strain
    size_t due_at;  // the same: in due_
  };
  template <typename Work>
  void for_each_element(const Work& work) const;
  void strain_elements();
  void relax_due();
  void stress_elements();
  void strain_element(size_t element);
  void take_answer(size_t element, const SampleAnswer& answer, SampleWork& work);
  void stress_element(size_t element);
  void push_corners(size_t element);
  void add_forces();

  ElementMesh mesh_;
  std::shared_ptr<const SampleMaterial> material_;
  std::vector<Mat3> turns_;
  ElementOptions options_;
  std::vector<Matrix6> constants_;
  std::vector<Mat3> inverse_edges_;
  std::vector<double> rest_volume_, mass_, volume_, energy_;
  std::vector<Vec3> x_, force_;
  Vec3 period_;
  std::vector<Mat3> stress_;
  std::vector<SampleRest> rest_;
  std::unique_ptr<SampleRelaxer> relaxer_;
  SampleWork work_;
  // Of the update at hand.
  std::vector<Strained> strained_;
  std::vector<std::array<Vec3, 4>> corner_force_;  // N
  std::vector<StrainedSample> due_;
  std::vector<SampleAnswer> answers_;  // of due_
};

// Uniformly random turns, one for each grain.
std::vector<Mat3> random_turns(size_t grains, uint64_t seed);

}  // namespace cuboct
