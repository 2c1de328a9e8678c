// SPDX-License-Identifier: MIT
// What a body asks of whoever relaxes its samples: one batch a step, of the samples that are due alone.
#include <gtest/gtest.h>

#include <numeric>

#include "model/atoms/multiscale/element_body.h"
#include "model/base/error.h"
#include "tests/multiscale/springs.h"

namespace cuboct {
namespace {

std::shared_ptr<const SampleMaterial> spring_material() {
  constexpr double kMass = 28.0855 * 1.66053906660e-27;  // kg
  static const auto material = std::make_shared<const SampleMaterial>(
      crystal_material(Crystal::diamond, std::make_shared<test::Springs>(), 5.5, 1, kMass, 1e-9));
  return material;
}

struct Seen {
  std::vector<std::vector<size_t>> batches;
  int set = 0;                // calls of set_places
  size_t restless = 1 << 30;  // this sample finds no rest
};

// The host's, watched.
class Watched : public SampleRelaxer {
 public:
  Watched(std::unique_ptr<SampleRelaxer> inner, std::shared_ptr<Seen> seen)
      : inner_(std::move(inner)), seen_(std::move(seen)) {}
  void relax(std::span<const StrainedSample> due, std::span<SampleAnswer> answers) override {
    inner_->relax(due, answers);
    std::vector<size_t>& batch = seen_->batches.emplace_back();
    for (size_t k = 0; k < due.size(); ++k) {
      batch.push_back(due[k].sample);
      if (due[k].sample == seen_->restless) answers[k].at_rest = false, answers[k].force = 0.25;
    }
  }
  Places places() const override { return inner_->places(); }
  void set_places(Places places) override { ++seen_->set, inner_->set_places(std::move(places)); }

 private:
  std::unique_ptr<SampleRelaxer> inner_;
  std::shared_ptr<Seen> seen_;
};

ElementBody body(const std::shared_ptr<Seen>& seen, double tolerance, int threads = 1) {
  ElementMesh mesh = box_mesh({2, 2, 2}, {1e-6, 1e-6, 1e-6}, {}, 0);
  std::vector<Mat3> turns = random_turns(mesh.grains(), 5);
  ElementOptions options{tolerance, threads};
  options.relaxer = [seen, threads](const SampleMaterial& material, size_t samples) {
    return std::make_unique<Watched>(host_relaxer(threads)(material, samples), seen);
  };
  return {std::move(mesh), spring_material(), std::move(turns), options};
}

void shake_vertices(ElementBody& body, double size) {
  for (size_t v = 0; v < body.x().size(); ++v)
    for (int a = 0; a < 3; ++a) body.x()[v][a] += size * std::sin(static_cast<double>(7 * v + 3 * a + 1));
}

TEST(SampleRelaxer, IsAskedForTheSamplesThatAreDueAlone) {
  const auto seen = std::make_shared<Seen>();
  ElementBody b = body(seen, 1e-5);
  b.update();
  EXPECT_TRUE(seen->batches.empty());  // nothing is strained
  shake_vertices(b, 1e-9);
  b.update();
  std::vector<size_t> all(b.mesh().elements.size());
  std::iota(all.begin(), all.end(), 0);
  ASSERT_EQ(seen->batches.size(), 1U);
  EXPECT_EQ(seen->batches[0], all);
  b.x()[0][0] += 1e-9;  // one corner of the box: its elements alone
  b.update();
  std::vector<size_t> touched;
  for (const size_t e : all)
    for (const auto& corner : b.mesh().elements[e])
      if (corner.vertex == 0) touched.push_back(e);
  ASSERT_EQ(seen->batches.size(), 2U);
  EXPECT_EQ(seen->batches[1], touched);
  EXPECT_LT(touched.size(), 7U);
  EXPECT_EQ(b.work().relaxations, all.size() + touched.size());
  EXPECT_EQ(b.work().updates, 3 * all.size());
}

TEST(SampleRelaxer, ThatFindsNoRestEndsTheRunWithTheElement) {
  const auto seen = std::make_shared<Seen>();
  seen->restless = 12;
  ElementBody b = body(seen, 0);
  shake_vertices(b, 1e-9);
  try {
    b.update();
    FAIL();
  } catch (const ElementError& error) {
    EXPECT_EQ(
        std::string(error.what()).find("element 13: its sample found no rest: a force of 0.25 eV/angstrom"),
        0U)
        << error.what();
  }
}

// Places go to another body and back, with the same bits; threads change none.
TEST(SampleRelaxer, HandsItsPlacesOn) {
  const auto seen = std::make_shared<Seen>();
  ElementBody one = body(seen, 0), other = body(seen, 0, 2);
  shake_vertices(one, 2e-9);
  one.update();
  other.x() = one.x();
  other.restore(one.samples(), one.work());
  EXPECT_EQ(seen->set, 1);
  const auto moved = [&](const ElementSample& s) {
    return (s.place[1] - spring_material()->lattice.place[1]).norm();
  };
  EXPECT_GT(moved(one.samples()[3]), 1e-6);  // atoms did give way
  for (ElementBody* b : {&one, &other}) shake_vertices(*b, 1e-9), b->update();
  EXPECT_EQ(one.force(), other.force());
  EXPECT_EQ(one.energy(), other.energy());
  for (size_t e = 0; e < one.samples().size(); ++e)
    EXPECT_EQ(one.samples()[e].place, other.samples()[e].place);
  EXPECT_EQ(one.work().evaluations, other.work().evaluations);
}

}  // namespace
}  // namespace cuboct
