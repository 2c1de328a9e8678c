// SPDX-License-Identifier: MIT
// Macro-elements under a law of springs, for which all that is checked holds exactly: kinematics, forces,
// energies. What needs the physics of silicon is in silicon_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "model/atoms/multiscale/element_motion.h"
#include "model/atoms/multiscale/element_stiffness.h"
#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/solid/moduli.h"
#include "tests/multiscale/springs.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

constexpr double kMass = 28.0855 * 1.66053906660e-27;  // kg

std::shared_ptr<const SampleMaterial> springs() {
  static const auto material = std::make_shared<const SampleMaterial>(
      crystal_material(Crystal::diamond, std::make_shared<test::Springs>(), 5.5, 2, kMass, 1e-9));
  return material;
}

ElementBody small_body(const std::array<bool, 3>& repeats, double tolerance = 0, int threads = 1) {
  ElementMesh mesh = box_mesh({2, 2, 2}, {1e-6, 1.2e-6, 0.9e-6}, repeats, 0);
  std::vector<Mat3> turns = random_turns(mesh.grains(), 5);
  return {std::move(mesh), springs(), std::move(turns), {tolerance, threads}};
}

// Vertices moved by some per mille of their distance, all unlike.
void shake(ElementBody& body, double size) {
  for (size_t v = 0; v < body.x().size(); ++v)
    for (int a = 0; a < 3; ++a) body.x()[v][a] += size * std::sin(static_cast<double>(7 * v + 3 * a + 1));
}

// The springs' edge is where no spring is strained; of their constants the first two have closed forms. With
// per-bond stiffness k1 and k2 of nearest (4 per atom) and next (12): 8 atoms in a^3,
//   B = a^2/3V (sum over bonds k r^2/3 a^2) = (k1 3/16 + k2 6/2 ... )  written out below as a sum over bonds.
TEST(SampleMaterial, SpringsRestAtTheirEdgeWithTheirBulkModulus) {
  const SampleMaterial& material = *springs();
  const test::Springs law;
  EXPECT_NEAR(material.edge(2), law.edge, 1e-6);
  const double a = law.edge, volume = a * a * a / 8;  // of an atom
  // E(strain e) = 1/2 sum over an atom's half bonds k (r e)^2, and E = 9/2 B V e^2.
  const double sum = 2 * law.near * 3.0 / 16 * a * a + 6 * law.next * a * a / 2;
  EXPECT_NEAR(voigt_mean(material.constants).bulk, kPascal * sum / (9 * volume), 1e-6 * 1e11);
  EXPECT_NEAR(material.energy, 0, 1e-9);
  EXPECT_LT(material.constants(3, 3), material.clamped(3, 3));
}

TEST(ElementMesh, OfABoxFillsItWithoutBias) {
  const ElementMesh mesh = box_mesh({4, 2, 3}, {4, 3, 2}, {true, false, false}, 0);
  ASSERT_EQ(mesh.elements.size(), 6 * 4 * 2 * 3U);
  EXPECT_EQ(mesh.x.size(), 4 * 3 * 4U);
  check_mesh(mesh, "box");
  double sum = 0;
  for (size_t e = 0; e < mesh.elements.size(); ++e) {
    const double volume = element_volume(mesh, e);
    EXPECT_NEAR(volume, 4.0 * 3 * 2 / 24 / 6, 1e-12);
    sum += volume;
  }
  EXPECT_NEAR(sum, 24, 1e-12);
}

// Equation 11 is the derivative of the samples' energy: of all vertices at once, along a random direction.
TEST(ElementBody, ForcesAreTheDerivativeOfTheEnergy) {
  for (const bool repeats : {false, true}) {
    ElementBody body = small_body({repeats, false, repeats});
    shake(body, 4e-9);
    body.update();
    const std::vector<Vec3> force = body.force(), x = body.x();
    constexpr double kStep = 1e-12;  // m: strains of 1e-6
    double work = 0;
    std::array<double, 2> energy;
    for (const int side : {0, 1}) {
      for (size_t v = 0; v < x.size(); ++v)
        body.x()[v] =
            x[v] + (side == 0 ? kStep : -kStep) * Vec3(std::sin(v), std::cos(3. * v), std::sin(5. * v + 1));
      body.update();
      energy[side] = body.energy();
    }
    for (size_t v = 0; v < x.size(); ++v)
      work += force[v].dot(Vec3(std::sin(v), std::cos(3. * v), std::sin(5. * v + 1)));
    EXPECT_GT(std::abs(work), 0);
    EXPECT_NEAR(-(energy[0] - energy[1]) / (2 * kStep) / work, 1, 1e-6);
  }
}

TEST(ElementBody, ForcesAddUpToNothing) {
  ElementBody body = small_body({true, false, false});
  shake(body, 4e-9);
  body.update();
  Vec3 sum = Vec3::Zero(), moment = sum;
  double most = 0;
  ElementBody free = small_body({false, false, false});
  shake(free, 4e-9);
  free.update();
  for (size_t v = 0; v < body.x().size(); ++v) sum += body.force()[v];
  for (size_t v = 0; v < free.x().size(); ++v) {
    moment += free.x()[v].cross(free.force()[v]);
    most = std::max(most, free.force()[v].norm());
  }
  EXPECT_LT(sum.norm(), 1e-12 * most);
  EXPECT_LT(moment.norm(), 1e-12 * most * 1e-6 * 27);
}

TEST(ElementBody, TurnedTurnsItsForces) {
  ElementBody body = small_body({false, false, false});
  shake(body, 4e-9);
  body.update();
  const std::vector<Vec3> force = body.force();
  const double energy = body.energy();
  const Mat3 turn = random_turns(1, 9)[0];
  double most = 0;
  for (Vec3& x : body.x()) x = turn * x + Vec3(3e-6, 0, -1e-6);
  body.update();
  EXPECT_NEAR(body.energy() / energy, 1, 1e-9);
  for (const Vec3& f : force) most = std::max(most, f.norm());
  for (size_t v = 0; v < force.size(); ++v)
    EXPECT_LT((body.force()[v] - turn * force[v]).norm(), 1e-7 * most);
}

// A crystal of one grain that is strained evenly has one stress, and forces on its surface alone.
TEST(ElementBody, PassesThePatchTest) {
  ElementMesh mesh = box_mesh({3, 2, 2}, {1e-6, 1e-6, 1e-6}, {false, false, false}, 100);
  ElementBody body(std::move(mesh), springs(), random_turns(1, 4), {});
  Mat3 gradient;
  gradient << 1.004, 0.002, 0, -0.001, 0.997, 0.003, 0.002, 0, 1.001;
  for (Vec3& x : body.x()) x = gradient * x;
  body.update();
  const Mat3 mean = body.mean_stress();
  for (const Mat3& stress : body.stress()) EXPECT_LT((stress - mean).norm(), 1e-7 * mean.norm());
  int inner = 0;
  for (size_t v = 0; v < body.x().size(); ++v) {
    const Vec3 x = body.mesh().x[v];
    if (!(x.minCoeff() > 1e-9 && x.maxCoeff() < 1e-6 - 1e-9)) continue;
    ++inner;
    EXPECT_LT(body.force()[v].norm(), 1e-7 * mean.norm() * 1e-13);
  }
  EXPECT_EQ(inner, 2);
}

// A single crystal under a pull along an axis of its own has the modulus that its constants say.
TEST(ElementRest, HasTheModulusOfTheConstants) {
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1)}) {
    ElementMesh mesh = box_mesh({2, 2, 2}, {1e-6, 1e-6, 1e-6}, {true, false, false}, 100);
    // The lattice is turned so that `direction` lies along x.
    const Mat3 turn =
        Eigen::Quaterniond::FromTwoVectors(eigen(direction), eigen(Vec3::UnitX())).toRotationMatrix();
    ElementBody body(std::move(mesh), springs(), {turn}, {});
    const double strain = 1e-4;
    body.period()[0] *= 1 + strain;
    for (Vec3& x : body.x()) x[0] *= 1 + strain;
    const RestResult rest = ElementRest(body)(body, 1e-12);
    EXPECT_TRUE(rest.at_rest) << rest.force;
    EXPECT_NEAR(body.mean_stress()(0, 0) / strain / youngs_modulus(springs()->constants, direction), 1, 2e-3);
    EXPECT_LT(std::abs(body.mean_stress()(1, 1)), 1e-4 * body.mean_stress()(0, 0));
  }
}

TEST(ElementMotion, KeepsItsEnergyAndMomentum) {
  ElementBody body = small_body({false, true, false});
  const double dt = 0.2 / fastest_vibration(body, element_stiffness(body));
  shake(body, 1e-9);
  ElementMotion motion(body, dt);
  for (size_t v = 0; v < motion.v().size(); ++v) motion.v()[v] = Vec3(0, 3, -2);
  const Vec3 momentum = motion.momentum();
  const double strained = body.energy(), begin = motion.kinetic_energy() + strained;
  double least = strained, largest_error = 0;
  for (int k = 0; k < 200; ++k) {
    motion.step();
    least = std::min(least, body.energy());
    largest_error = std::max(largest_error, std::abs(motion.kinetic_energy() + body.energy() - begin));
  }
  EXPECT_LT(least, 0.7 * strained);           // it moves
  EXPECT_LT(largest_error, 0.02 * strained);  // of (omega dt)^2/8 in the fastest vibration
  EXPECT_LT((motion.momentum() - momentum).norm(), 1e-10 * momentum.norm());
}

TEST(ElementBody, ThreadsChangeNoBit) {
  ElementBody one = small_body({true, true, false}), two = small_body({true, true, false}, 0, 2);
  shake(one, 2e-9), shake(two, 2e-9);
  one.update(), two.update();
  for (size_t v = 0; v < one.x().size(); ++v) EXPECT_EQ(one.force()[v], two.force()[v]);
}

// Between relaxations the stress is off by what it bends over the tolerance, and that is measured.
TEST(ElementBody, ToleranceSavesRelaxationsAndItsErrorIsMeasured) {
  double last = 1e300;
  for (const double tolerance : {1e-3, 3e-4}) {
    ElementBody exact = small_body({false, false, false}),
                body = small_body({false, false, false}, tolerance);
    double largest = 0, most = 0;
    for (int k = 0; k < 24; ++k) {
      shake(exact, 3e-11), shake(body, 3e-11);
      exact.update(), body.update();
      for (size_t e = 0; e < body.stress().size(); ++e) {
        largest = std::max(largest, (body.stress()[e] - exact.stress()[e]).cwiseAbs().maxCoeff());
        most = std::max(most, exact.stress()[e].cwiseAbs().maxCoeff());
      }
    }
    EXPECT_LT(body.work().relaxations, exact.work().relaxations / 2);
    EXPECT_GT(body.work().measured, 0U);
    EXPECT_LT(largest, 1.5 * body.work().largest_error);
    EXPECT_LT(largest, last / 2);
    EXPECT_LT(largest, 20 * tolerance * most);
    last = largest;
  }
}

TEST(ElementBody, RefusesWhatIsNoMesh) {
  const auto refusal = [](ElementMesh mesh) { return refused_with([&] { check_mesh(mesh, "box.msh"); }); };
  const ElementMesh good = box_mesh({1, 1, 1}, {1, 1, 1}, {false, false, false}, 0);
  EXPECT_EQ(refusal(good), "accepted");
  ElementMesh bad = good;
  std::swap(bad.elements[2][1], bad.elements[2][2]);
  EXPECT_EQ(refusal(bad),
            "box.msh: element 3 is inverted: its volume is -0.167 m^3\n  hint: exchange two of its vertices");
  bad = good;
  bad.x.push_back({3, 3, 3});
  EXPECT_EQ(refusal(bad),
            "box.msh: vertex 9 belongs to no element\n  hint: a vertex without an element has no mass and no "
            "force");
  bad = good;
  bad.x[0] = {1, 1, 1};
  EXPECT_NE(refusal(bad).find("element 1 is flat"), std::string::npos);
}

TEST(ElementBody, StopsAtAnElementThatTurnsInsideOut) {
  ElementBody body = small_body({false, false, false});
  body.x()[0] = Vec3(2e-6, 2e-6, 2e-6);
  try {
    body.update();
    FAIL();
  } catch (const ElementError& error) {
    EXPECT_EQ(std::string(error.what()),
              "element " + std::to_string(error.element + 1) + ": it turned inside out");
  }
}

// Springs that push their neighbours apart hold no lattice.
TEST(SampleMaterial, RefusesUnstableParameters) {
  const auto law = std::make_shared<test::Springs>();
  law->next = -0.5;
  EXPECT_THROW(crystal_material(Crystal::diamond, law, 5.43, 2, kMass, 1e-9), InputError);
}

}  // namespace
}  // namespace cuboct
