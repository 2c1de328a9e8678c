// SPDX-License-Identifier: MIT
// The samples of a study's elements by a device's kernels, compiled for the host, beside those of the host
// itself.
#include "emu/gpu/samples/sample_relaxer.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "model/atoms/multiscale/element_study.h"
#include "model/atoms/multiscale/tersoff_law.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/run/element_run.h"

namespace cuboct::gpu {
namespace {

constexpr double kMass = 28.0855 * 1.66053906660e-27;  // kg
constexpr double kForce = 1e-6;                        // eV/angstrom, of samples at rest
constexpr size_t kSamples = 6;

const Tersoff& parameters() {
  static const Tersoff set = tersoff_set("si_multiscale");
  return set;
}
const SampleMaterial& silicon(int cells) {
  static const SampleMaterial of[] = {
      crystal_material(Crystal::diamond, tersoff_law(parameters()), 5.43, 1, kMass, kForce),
      crystal_material(Crystal::diamond, tersoff_law(parameters()), 5.43, 2, kMass, kForce)};
  return of[cells - 1];
}

class Beside {
 public:
  explicit Beside(int cells, const RelaxerOptions& options = {})
      : material_(silicon(cells)),
        host_(host_relaxer(1)(material_, kSamples)),
        device_(device_relaxer(parameters().terms[0], options)(material_, kSamples)) {}

  // All samples strained at random, by `size`; atoms shaken by `shake` (of an edge) first.
  void relax(double size, double shake = 0) {
    SampleRelaxer::Places places = host_->places();
    for (auto& sample : places)
      for (Vec3& at : sample) at += shake * Vec3(normal_(random_), normal_(random_), normal_(random_));
    if (shake > 0) host_->set_places(places), device_->set_places(places);
    std::vector<StrainedSample> due;
    for (size_t k = kSamples; k-- > 0;) {
      Mat3 strain = Mat3::Zero();
      for (double& component : strain.reshaped()) component = size * normal_(random_);
      due.push_back({k, (Mat3::Identity() + strain) * material_.lattice.cell});
    }
    host.resize(kSamples), device.resize(kSamples);
    host_->relax(due, host), device_->relax(due, device);
  }
  double energy_difference() const {
    double most = 0;
    for (size_t k = 0; k < kSamples; ++k) most = std::max(most, std::abs(host[k].energy - device[k].energy));
    return most;
  }
  double stress_difference() const {  // Pa
    double most = 0;
    for (size_t k = 0; k < kSamples; ++k)
      most = std::max(most, (host[k].stress - device[k].stress).cwiseAbs().maxCoeff());
    return most;
  }
  double evaluations(const std::vector<SampleAnswer>& of) const {
    double sum = 0;
    for (const SampleAnswer& answer : of) sum += static_cast<double>(answer.evaluations) / kSamples;
    return sum;
  }
  bool at_rest() const {
    return std::ranges::all_of(host, &SampleAnswer::at_rest) &&
           std::ranges::all_of(device, &SampleAnswer::at_rest);
  }
  SampleRelaxer& of_device() { return *device_; }

  std::vector<SampleAnswer> host, device;

 private:
  const SampleMaterial& material_;
  std::unique_ptr<SampleRelaxer> host_, device_;
  std::mt19937_64 random_{3};
  std::normal_distribution<double> normal_;
};

// Both follow the same steps, so that they differ by roundings alone: of energies of -300 eV, some 1e-12; of
// stresses, whose parts are some 1e11 Pa each, some 1e-12 of those. Both would be another's answer within the
// force that is left: 1e-6 eV/angstrom over a stiffness of 1 eV/angstrom^2 are 1e-6 angstrom, 1e5 Pa.
TEST(SampleRelaxer, TakesTheStepsOfTheHost) {
  for (const int cells : {1, 2}) {
    Beside both(cells);
    for (int turn = 0; turn < 3; ++turn) {
      both.relax(1e-3 * (turn + 1));
      ASSERT_TRUE(both.at_rest());
      EXPECT_EQ(both.evaluations(both.host), both.evaluations(both.device)) << turn;
      EXPECT_GT(both.evaluations(both.host), 1);
      EXPECT_LT(both.energy_difference(), 1e-9);
      EXPECT_LT(both.stress_difference(), 100);
    }
  }
}

// A batch for cells that have hardly changed needs fewer evaluations than the first one.
TEST(SampleRelaxer, BeginsWhereTheLastBatchEnded) {
  Beside both(2);
  std::vector<StrainedSample> due;
  Mat3 strain = Mat3::Zero();
  strain(0, 1) = 3e-3;
  std::vector<SampleAnswer> first(kSamples), second(kSamples);
  for (size_t k = 0; k < kSamples; ++k)
    due.push_back({k, (Mat3::Identity() + strain) * silicon(2).lattice.cell});
  both.of_device().relax(due, first);
  both.of_device().relax(due, second);
  for (size_t k = 0; k < kSamples; ++k) {
    EXPECT_GT(first[k].evaluations, 1U);
    EXPECT_EQ(second[k].evaluations, 1U);
    EXPECT_NEAR(second[k].energy, first[k].energy, 1e-10);
  }
}

// Shaken by 0.1 angstrom and strained by some per cent the lattice's list serves no more, and where room for
// bonds is short all begin with more. Both come to the lattice's own rest: its energy, within the square of
// the force that is left.
TEST(SampleRelaxer, ListsAnewWhereTheLatticesListDoesNotServe) {
  for (const double room : {5.0, 2.0}) {
    Beside both(2, {.skin = 0.3, .bonds_per_atom = room});
    both.relax(0.02, 0.1 / 10.86);
    ASSERT_TRUE(both.at_rest());
    EXPECT_GT(both.evaluations(both.device), 8);
    EXPECT_LT(both.energy_difference(), 1e-8);
    EXPECT_LT(both.stress_difference(), 1e5);
    both.relax(0.002);
    ASSERT_TRUE(both.at_rest());
    EXPECT_LT(both.energy_difference(), 1e-8);
  }
}

// Pressed to three quarters of its edge, second neighbours come from 3.84 to 2.88 angstrom, within the cutoff
// of 3: bonds that the lattice's list lacks.
TEST(SampleRelaxer, FindsBondsThatTheLatticeHasNot) {
  const SampleMaterial& material = silicon(2);
  const std::vector<StrainedSample> due{{0, 0.75 * material.lattice.cell}};
  std::vector<SampleAnswer> device(1), host(1);
  device_relaxer(parameters().terms[0])(material, 1)->relax(due, device);
  host_relaxer(1)(material, 1)->relax(due, host);
  EXPECT_NEAR(device[0].energy, host[0].energy, 1e-8);
  EXPECT_NEAR(device[0].stress(0, 0), host[0].stress(0, 0), 1e-9 * std::abs(host[0].stress(0, 0)));
}

TEST(SampleRelaxer, SaysWhichSampleFindsNoRest) {
  SampleMaterial hasty = silicon(1);
  hasty.relaxation.most = 2;
  const auto relaxer = device_relaxer(parameters().terms[0])(hasty, 3);
  Mat3 sheared = Mat3::Identity();
  sheared(0, 1) = 0.02;
  std::vector<SampleAnswer> answers(2);
  relaxer->relax(std::vector<StrainedSample>{{0, hasty.lattice.cell}, {2, sheared * hasty.lattice.cell}},
                 answers);
  EXPECT_TRUE(answers[0].at_rest);
  EXPECT_FALSE(answers[1].at_rest);
  EXPECT_EQ(answers[1].evaluations, 2U);
  EXPECT_GT(answers[1].force, kForce);
  SampleRelaxer::Places places = relaxer->places();
  places[1][3] = places[1][4];  // two atoms at one place
  relaxer->set_places(places);
  relaxer->relax(std::vector<StrainedSample>{{0, hasty.lattice.cell}, {1, hasty.lattice.cell}}, answers);
  EXPECT_TRUE(answers[0].at_rest);
  EXPECT_FALSE(answers[1].at_rest);
  try {
    relaxer->relax(std::vector<StrainedSample>{{2, 0.5 * hasty.lattice.cell}}, std::span(answers).first(1));
    FAIL();
  } catch (const ElementError& error) {
    EXPECT_EQ(std::string(error.what()).find("element 3: its sample is 2.7"), 0U) << error.what();
  }
}

// A rod, cut after every third step and gone on with by the other engine, has the speed of one that was not.
TEST(SampleRelaxer, LeavesProgressThatTheHostGoesOnWith) {
  const Scratch folder;
  const std::string file = folder.path("rod.toml");
  write_text(
      file,
      "[material]\npotential = \"si_multiscale\"\nedge = \"5.43 angstrom\"\nmass = \"28.0855 u\"\ncells = "
      "1\n[mesh]\ncubes = [12, 1, 1]\nsize = \"[12, 1, 1] um\"\n[samples]\nstrain_tolerance = 2e-5\n"
      "[wave]\nalong = \"x\"\npeak = \"10 MPa\"\npulse = \"0.3 ns\"\n");
  const ElementStudy study = read_element_study(file);
  const auto material = material_of(study);
  const RelaxerMaker device = device_relaxer(study.material.tersoff.value());
  const SetOutcome host = run_elements(study, material, {}).front();
  ElementRunOptions options;
  options.progress = folder.path("progress");
  int cuts = 0;
  std::vector<SetOutcome> parts;
  while (parts.empty()) {
    int calls = 0;
    options.relaxer = cuts % 2 == 0 ? device : RelaxerMaker();
    options.see = [&](size_t, double) { return ++calls < 3; };
    try {
      parts = run_elements(study, material, options);
    } catch (const ElementRunStopped&) {
      ++cuts;
    }
  }
  EXPECT_GT(cuts, 10);
  EXPECT_NEAR(parts.front().wave.speed.speed, host.wave.speed.speed, 1e-6 * host.wave.speed.speed);
  EXPECT_EQ(parts.front().work.updates, host.work.updates);
  EXPECT_NEAR(static_cast<double>(parts.front().work.relaxations), static_cast<double>(host.work.relaxations),
              1e-3 * static_cast<double>(host.work.relaxations));
}

}  // namespace
}  // namespace cuboct::gpu
