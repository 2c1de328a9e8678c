// SPDX-License-Identifier: MIT
#include "emu/gpu/samples/sample_relaxer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "emu/gpu/messages.h"
#include "emu/gpu/samples/relax_kernel.h"
#include "model/base/parallel.h"

namespace cuboct::gpu {
namespace {

using Real = double;

constexpr size_t kLeast = 512;  // samples for a thread of the host

std::vector<Real> edges_of(const Mat3& cell) { return {cell.data(), cell.data() + 9}; }  // columns

class DeviceRelaxer final : public SampleRelaxer {
 public:
  DeviceRelaxer(const SampleMaterial& material, size_t samples, const TersoffTerm<double>& term,
                const RelaxerOptions& options)
      : options_(options),
        lattice_(material.lattice),
        count_(samples),
        rule_{term, options.skin, static_cast<uint32_t>(material.lattice.place.size())},
        task_{.kind = SampleTask<Real>::Kind::relax,
              .steps = static_cast<uint32_t>(material.relaxation.most),
              .tolerance = material.relaxation.force,
              .stiffness = material.relaxation.stiffness},
        stream_(options.device),
        place_(options.device),
        lattice_place_(options.device),
        lattice_cell_(options.device),
        lattice_inverse_(options.device),
        cell_(options.device),
        inverse_(options.device),
        due_(options.device),
        list_(options.device),
        sums_(options.device) {
    set_places(Places(count_, lattice_.place));
    lattice_place_.set(stream_, by_axis({lattice_.place}));
    lattice_cell_.set(stream_, edges_of(lattice_.cell));
    // Its rows, one after the other.
    lattice_inverse_.set(stream_, edges_of(lattice_.cell.inverse().transpose()));
    if (!(thickness(lattice_.cell) > reach())) throw_thin_cell(0, thickness(lattice_.cell), reach());
    give_room(static_cast<uint32_t>(std::ceil(options_.bonds_per_atom * rule_.atoms)));
  }

  void relax(std::span<const StrainedSample> due, std::span<SampleAnswer> answers) override {
    std::vector<uint32_t> left(due.size());  // places in `due`
    for (size_t k = 0; k < due.size(); ++k) left[k] = static_cast<uint32_t>(k);
    while (true) {
      left = relax_some(due, left, answers);
      if (left.empty()) return;
      give_room(rule_.most_bonds + rule_.most_bonds / 2);
    }
  }

  Places places() const override {
    const std::vector<Real> all = place_.host(stream_, 0, place_.size());
    const size_t n = rule_.atoms;
    Places out(count_, std::vector<Vec3>(n));
    for (size_t s = 0; s < count_; ++s)
      for (size_t i = 0; i < n; ++i)
        for (size_t a = 0; a < 3; ++a) out[s][i][static_cast<int>(a)] = all[(3 * s + a) * n + i];
    return out;
  }
  void set_places(Places places) override { place_.set(stream_, by_axis(places)); }

 private:
  static std::vector<Real> by_axis(const Places& places) {
    std::vector<Real> out;
    out.reserve(places.size() * 3 * places.front().size());
    for (const std::vector<Vec3>& sample : places)
      for (int a = 0; a < 3; ++a)
        for (const Vec3& at : sample) out.push_back(at[a]);
    return out;
  }

  double reach() const { return rule_.term.R + rule_.term.D + rule_.skin; }
  // Above `reach` each image of an atom that is near stands in the cell or beside it.
  static double thickness(const Mat3& cell) {
    double widest = 0;
    for (int e = 0; e < 3; ++e)
      widest = std::max(widest, cell.col((e + 1) % 3).cross(cell.col((e + 2) % 3)).norm());
    return std::abs(cell.determinant()) / widest;
  }

  LatticeView<Real> lattice() {
    // Half of the least distance between planes of atoms across an edge, in fractions: that of diamond's
    // cubes.
    const double cubes = std::cbrt(static_cast<double>(rule_.atoms) / 8);
    return {lattice_place_.data(), lattice_cell_.data(), lattice_inverse_.data(), list_.data(),
            1 / (8 * std::max(cubes, 1.0))};
  }
  int threads() const { return sample_threads(rule_.atoms); }

  // Lists the lattice's bonds, with room for so many or more.
  void give_room(uint32_t bonds) {
    while (true) {
      rule_.most_bonds = bonds;
      require_sample(options_.device, rule_.atoms, bonds, SampleMemory<Real>::bytes(rule_));
      list_.resize(SampleMemory<Real>::list_words(rule_));
      sums_.resize(std::max<size_t>(sums_.size(), 1));
      for_each_block(stream_, 1, threads(), SampleMemory<Real>::bytes(rule_),
                     ListKernel<Real>{lattice(), rule_, sums_.data()});
      if (sums_.host(stream_, 0, 1).front().fault == SampleFault::none) return;
      bonds += bonds / 2;
    }
  }

  // Of those of `due` that `which` names. Returns the ones that had no room for their bonds.
  std::vector<uint32_t> relax_some(std::span<const StrainedSample> due, const std::vector<uint32_t>& which,
                                   std::span<SampleAnswer> answers) {
    due_host_.resize(which.size()), cells_host_.resize(9 * which.size());
    in_ranges(which.size(), [&](size_t k) {
      const auto& [sample, cell] = due[which[k]];
      if (!(thickness(cell) > reach())) throw_crushed_element(sample, thickness(cell), reach());
      due_host_[k] = static_cast<uint32_t>(sample);
      std::copy_n(cell.data(), 9, cells_host_.data() + 9 * k);
    });
    due_.set(stream_, due_host_), cell_.set(stream_, cells_host_);
    if (inverse_.size() < cells_host_.size()) inverse_.resize(cells_host_.size());
    if (sums_.size() < which.size()) sums_.resize(which.size());
    for_each_block(stream_, static_cast<uint32_t>(which.size()), threads(), SampleMemory<Real>::bytes(rule_),
                   RelaxKernel<Real>{lattice(),
                                     {due_.data(), cell_.data(), inverse_.data(), sums_.data()},
                                     place_.data(),
                                     rule_,
                                     task_});
    const std::vector<SampleSums<Real>> sums = sums_.host(stream_, 0, which.size());
    in_ranges(which.size(), [&](size_t k) { answers[which[k]] = answer_of(sums[k], due[which[k]].cell); });
    std::vector<uint32_t> left;
    for (size_t k = 0; k < which.size(); ++k)
      if (sums[k].fault == SampleFault::too_many_bonds) left.push_back(which[k]);
    return left;
  }

  template <class Work>
  void in_ranges(size_t count, const Work& work) const {
    for_each_range(
        count, kLeast,
        [&](size_t begin, size_t end) {
          for (size_t k = begin; k < end; ++k) work(k);
        },
        options_.threads);
  }

  SampleAnswer answer_of(const SampleSums<Real>& sums, const Mat3& cell) const {
    const auto& v = sums.virial;
    Mat3 virial;
    virial << v[0], v[5], v[4], v[5], v[1], v[3], v[4], v[3], v[2];
    return {sums.energy, kPascal / std::abs(cell.determinant()) * virial, sums.steps,
            sums.force <= task_.tolerance, sums.force};
  }

  RelaxerOptions options_;
  AtomicLattice lattice_;
  size_t count_;
  SampleRule<Real> rule_;
  SampleTask<Real> task_;
  mutable Stream stream_;
  Array<Real> place_, lattice_place_, lattice_cell_, lattice_inverse_, cell_, inverse_;
  Array<uint32_t> due_, list_;
  Array<SampleSums<Real>> sums_;
  std::vector<uint32_t> due_host_;  // kept from batch to batch for their memory
  std::vector<Real> cells_host_;
};

}  // namespace

RelaxerMaker device_relaxer(const TersoffTerm<double>& term, const RelaxerOptions& options) {
  return [=](const SampleMaterial& material, size_t samples) {
    return std::make_unique<DeviceRelaxer>(material, samples, term, options);
  };
}

}  // namespace cuboct::gpu
