// SPDX-License-Identifier: MIT
// Radial distribution, displacement, coordination, common neighbours and stress of states whose answers are
// known.
#include "model/analysis/measurement.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "model/analysis/common_neighbours.h"
#include "model/analysis/displacement.h"
#include "model/analysis/near_within.h"
#include "model/analysis/particle_stress.h"
#include "model/analysis/radial_distribution.h"
#include "model/contract/law.h"
#include "tests/fcc_block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

struct Crystal {
  std::vector<Vec3> x;
  Periodic box;
};

Crystal fcc(int cells) { return {test::fcc_block(cells, 1).x, test::fcc_box(cells, 1)}; }

// `count` cells of the basis along each axis, of these edges.
Crystal crystal(const Vec3& edges, const std::vector<Vec3>& basis, const std::array<int, 3>& count) {
  Crystal of;
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i)
        for (const Vec3& site : basis) of.x.push_back((Vec3(i, j, k) + site).cwiseProduct(edges));
  of.box.extent = Vec3(count[0], count[1], count[2]).cwiseProduct(edges);
  return of;
}
Crystal bcc(int cells) {
  return crystal(Vec3::Ones(), {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0.5)}, {cells, cells, cells});
}
// Nearest distance 1; axes a, sqrt 3 a and sqrt(8/3) a.
Crystal hcp() {
  return crystal(Vec3(1, std::sqrt(3.0), std::sqrt(8.0 / 3)),
                 {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 5.0 / 6, 0.5), Vec3(0, 1.0 / 3, 0.5)},
                 {5, 3, 3});
}
// One in the middle, twelve on the corners of an icosahedron, at distance 1.
Crystal icosahedron() {
  Crystal of{{Vec3::Zero()}, {}};
  const double phi = std::numbers::phi, length = std::hypot(1, phi);
  for (const double a : {-1.0, 1.0})
    for (const double b : {-phi, phi}) {
      of.x.push_back(Vec3(0, a, b) / length);
      of.x.push_back(Vec3(a, b, 0) / length);
      of.x.push_back(Vec3(b, 0, a) / length);
    }
  return of;
}

std::map<Structure, size_t> counts(const std::vector<Structure>& of) {
  std::map<Structure, size_t> counts;
  for (const Structure structure : of) ++counts[structure];
  return counts;
}

TEST(Rdf, ShellsOfFccHold12And6And24And12) {
  const Crystal perfect = fcc(4);
  const double cutoff = 2.15;
  RdfMeter meter(perfect.box, cutoff, 86);  // of 0.025: no shell at a bin's end
  meter.add(perfect.x);
  meter.add(perfect.x);
  const size_t n = perfect.x.size();
  const Rdf rdf = meter.result(perfect.box.extent.prod());
  std::map<size_t, uint64_t> shells;
  uint64_t in_all = 0;
  for (const auto& [r, count] : {std::pair{1.0, 12}, {std::sqrt(2.0), 6}, {std::sqrt(3.0), 24}, {2.0, 12}}) {
    // Rounding puts a distance at a bin's end on either side: 1 and 2 are those of bins 40 and 80.
    const auto bin = static_cast<size_t>(r / 0.025 + 1e-9);
    EXPECT_EQ(rdf.pairs[bin] + rdf.pairs[bin - 1], 2 * n * static_cast<size_t>(count)) << r;
    in_all += 2 * n * static_cast<size_t>(count);
    EXPECT_NEAR(rdf.within[bin], static_cast<double>(in_all) / static_cast<double>(2 * n), 1e-12);
  }
  EXPECT_EQ(std::accumulate(rdf.pairs.begin(), rdf.pairs.end(), uint64_t{0}), in_all);
  // sqrt 2 is in bin 56: N (N - 1) pairs at random would put (N - 1) V_shell/V of them there about each.
  const double shell = 4.0 / 3 * std::numbers::pi * (std::pow(57 * 0.025, 3) - std::pow(56 * 0.025, 3));
  EXPECT_NEAR(rdf.g[56], 6 / (static_cast<double>(n - 1) / perfect.box.extent.prod() * shell), 1e-9);
}

// n particles at random have n (n - 1) V_shell/V pairs in a shell: their count has that mean, and g is 1 for
// few as for many.
TEST(Rdf, OfAnIdealGasIsOneForAnyNumber) {
  std::mt19937_64 random(3);
  for (const size_t n : {size_t{10}, size_t{1000}}) {
    Periodic box;
    box.extent = Vec3(1, 1.2, 0.9);
    const size_t frames = n == 10 ? 20000 : 20;
    RdfMeter meter(box, 0.45, 3);
    for (size_t k = 0; k < frames; ++k) {
      std::vector<Vec3> x(n);
      for (Vec3& one : x) one = (test::random_vector(random) + Vec3::Ones()).cwiseProduct(box.extent) / 2;
      meter.add(x);
    }
    const Rdf rdf = meter.result(box.extent.prod());
    for (size_t bin = 0; bin < 3; ++bin) {
      const double error = std::sqrt(2.0 / static_cast<double>(rdf.pairs[bin]));  // each pair counts twice
      ASSERT_LT(error, 0.02);
      EXPECT_NEAR(rdf.g[bin], 1, 4 * error) << n << ' ' << bin;
    }
  }
}

// Layers of A and of B by turns along z, in an FCC lattice: A has 4 of A and 8 of B nearest to it.
TEST(Rdf, OfTwoMaterials) {
  const Crystal perfect = fcc(3);
  RdfSets sets;
  for (const Vec3& x : perfect.x) {
    const bool a = std::lround(x.z() * std::numbers::sqrt2) % 2 == 0;
    sets.a.push_back(a), sets.b.push_back(!a);
  }
  const auto near = [&](const std::vector<char>& of, const std::vector<char>& about) {
    RdfMeter meter(perfect.box, 1.2, 1, {about, of});
    meter.add(perfect.x);
    return meter.result(perfect.box.extent.prod());
  };
  EXPECT_EQ(near(sets.a, sets.a).within[0], 4);
  EXPECT_EQ(near(sets.b, sets.a).within[0], 8);
  EXPECT_EQ(near(sets.a, sets.b).within[0], 8);
  const double n = static_cast<double>(perfect.x.size()) / 2,
               shell = 4.0 / 3 * std::numbers::pi * std::pow(1.2, 3);
  const double each = shell / perfect.box.extent.prod();
  EXPECT_NEAR(near(sets.a, sets.a).g[0], 4 / ((n - 1) * each), 1e-12);
  EXPECT_NEAR(near(sets.b, sets.a).g[0], 8 / (n * each), 1e-12);
}

TEST(Rdf, TheFirstMinimumPartsTheShells) {
  const Rdf liquid{0.1, {}, {0, 0, 1, 3, 2, 0.6, 0.5, 0.9, 1.1, 1}, {}};
  EXPECT_NEAR(first_minimum({0.1, {}, {0, 0, 1, 3, 2, 0.4, 0.6, 0.9}, {}}), 0.55, 1e-12);
  EXPECT_NEAR(first_minimum(liquid), 0.55, 1e-12);  // of 0.35, up to 0.56
  EXPECT_NEAR(first_minimum({0.1, {}, {0, 0, 0, 0, 0, 9, 0, 0, 4, 0}, {}}), 0.70, 1e-12);
  EXPECT_EQ(first_minimum({0.1, {}, {0, 0, 0}, {}}), 0);
}

// The second shell of diamond has 12 at a distance of 1.63 bonds: g(r) is higher there than at the first. Of
// the simple cubic crystal both are as high.
TEST(Rdf, TheFirstShellNeedNotBeTheHighest) {
  const std::vector<Vec3> face{{0, 0, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}};
  std::vector<Vec3> diamond = face;
  for (const Vec3& site : face) diamond.push_back(site + Vec3::Constant(0.25));
  const auto neighbours = [](const Crystal& of) {
    Scene scene;
    scene.periodic = of.box;
    scene.body.x = of.x;
    scene.body.type.assign(of.x.size(), 0);
    const std::unique_ptr<Measure> measure = make_measure("coordination", scene, {});
    Snapshot now;
    now.body = scene.body;
    measure->add(now);
    return measure->particles()->values;
  };
  const Crystal of_diamond = crystal(Vec3::Ones(), diamond, {4, 4, 4});
  EXPECT_EQ(neighbours(of_diamond), std::vector<double>(of_diamond.x.size(), 4));
  for (const int cells : {6, 8, 9}) {  // of 8 the first shell stands at a bin's end
    const Crystal cubic = crystal(Vec3::Ones(), {Vec3::Zero()}, {cells, cells, cells});
    EXPECT_EQ(neighbours(cubic), std::vector<double>(cubic.x.size(), 6)) << cells;
  }
}

TEST(Rdf, OfACutoffWithoutVolumeIsZero) {
  const Crystal perfect = fcc(2);
  for (const double cutoff : {1e-310, 1e-110, 1e-100}) {
    RdfMeter meter(perfect.box, cutoff, 2, {}, 1);
    meter.add(perfect.x);
    EXPECT_EQ(meter.result(perfect.box.extent.prod()).g, (std::vector<double>{0, 0})) << cutoff;
  }
}

TEST(Rdf, IsThatOfAnyThreads) {
  Body body = test::fcc_block(14, 1);  // 10,976 particles: several parts
  test::shake(body, 0.1, 0, 5);
  std::vector<Rdf> of;
  for (const int threads : {1, 3}) {
    RdfMeter meter(test::fcc_box(14, 1), 2, 50, {}, threads);
    meter.add(body.x);
    of.push_back(meter.result(1));
  }
  EXPECT_EQ(of[0].pairs, of[1].pairs);
  EXPECT_EQ(structures_adaptive(body.x, test::fcc_box(14, 1), 2, 1),
            structures_adaptive(body.x, test::fcc_box(14, 1), 2, 3));
}

TEST(Coordination, OfFccIsTwelve) {
  const Crystal perfect = fcc(3);
  size_t seen = 0;
  for_each_near(perfect.x, perfect.box, 1.2, 1, [&](size_t, uint32_t i, std::span<const uint32_t> near) {
    EXPECT_EQ(near.size(), 12u);
    for (const uint32_t j : near)
      EXPECT_NEAR(nearest_image(perfect.x[j] - perfect.x[i], perfect.box).norm(), 1, 1e-12);
    ++seen;
  });
  EXPECT_EQ(seen, perfect.x.size());
  EXPECT_EQ(refused_with([&] { check_range(2.2, perfect.box, "cutoff"); }),
            "the cutoff is 2.2 m, more than half of the box along x, 4.24264 m\n  hint: at most 2.12132 m");
}

TEST(Cna, KnowsPerfectCrystals) {
  const auto all = [](const Crystal& of, Structure structure) {
    return std::map<Structure, size_t>{{structure, of.x.size()}};
  };
  // Fixed cutoffs: half-way between the shells.
  EXPECT_EQ(counts(structures_within(fcc(3).x, fcc(3).box, 1.2)), all(fcc(3), Structure::fcc));
  EXPECT_EQ(counts(structures_within(hcp().x, hcp().box, 1.2)), all(hcp(), Structure::hcp));
  EXPECT_EQ(counts(structures_within(bcc(4).x, bcc(4).box, 1.2)), all(bcc(4), Structure::bcc));
  EXPECT_EQ(counts(structures_adaptive(fcc(3).x, fcc(3).box, 2)), all(fcc(3), Structure::fcc));
  EXPECT_EQ(counts(structures_adaptive(hcp().x, hcp().box, 2)), all(hcp(), Structure::hcp));
  EXPECT_EQ(counts(structures_adaptive(bcc(4).x, bcc(4).box, 1.7)), all(bcc(4), Structure::bcc));
  const std::map<Structure, size_t> cluster{{Structure::icosahedral, 1}, {Structure::other, 12}};
  EXPECT_EQ(counts(structures_within(icosahedron().x, {}, 1.2)), cluster);
  EXPECT_EQ(counts(structures_adaptive(icosahedron().x, {}, 3)), cluster);
}

// The adaptive analysis knows a crystal at any density, and a warm one; a vacancy's twelve neighbours are
// other.
TEST(Cna, AdaptsToDensityAndWarmth) {
  for (const double scale : {0.7, 1.3}) {
    Crystal of = fcc(4);
    for (Vec3& x : of.x) x *= scale;
    of.box.extent *= scale;
    EXPECT_EQ(counts(structures_adaptive(of.x, of.box, 1.9))[Structure::fcc], of.x.size()) << scale;
    EXPECT_EQ(counts(structures_within(of.x, of.box, 1.2))[Structure::fcc], 0u) << scale;
  }
  Body warm = test::fcc_block(5, 1);
  test::shake(warm, 0.07, 0, 2);
  EXPECT_EQ(counts(structures_adaptive(warm.x, test::fcc_box(5, 1), 2))[Structure::fcc], warm.size());
  Crystal with_vacancy = fcc(4);
  with_vacancy.x.pop_back();
  for (const auto& of : {structures_adaptive(with_vacancy.x, with_vacancy.box, 2),
                         structures_within(with_vacancy.x, with_vacancy.box, 1.2)})
    EXPECT_EQ(counts(of), (std::map<Structure, size_t>{{Structure::fcc, with_vacancy.x.size() - 12},
                                                       {Structure::other, 12}}));
}

// A stacking fault: two planes of hcp in fcc. Planes ABCABC|BCABC... of triangles, nearest distance 1.
TEST(Cna, SeesAStackingFault) {
  const std::string planes = "ABCABCBCABC";  // periodic: ...C|A
  Crystal of;
  const double height = std::sqrt(2.0 / 3);
  for (size_t k = 0; k < planes.size(); ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        for (const Vec3& site : {Vec3(0, 0, 0), Vec3(0.5, std::sqrt(3.0) / 2, 0)})
          of.x.push_back(site + Vec3(i, std::sqrt(3.0) * j + (planes[k] - 'A') / std::sqrt(3.0),
                                     height * static_cast<double>(k)));
  of.box.extent = Vec3(4, 4 * std::sqrt(3.0), height * static_cast<double>(planes.size()));
  for (const auto& found : {structures_adaptive(of.x, of.box, 2), structures_within(of.x, of.box, 1.2)})
    EXPECT_EQ(counts(found),
              (std::map<Structure, size_t>{{Structure::fcc, 9 * 32}, {Structure::hcp, 2 * 32}}));
}

TEST(Displacement, OfFreeFlightIsSpeedTimesTimeThroughTheBox) {
  Periodic box;
  box.extent = Vec3(2, 3, 0);
  std::mt19937_64 random(7);
  std::vector<Vec3> start, v;
  for (int i = 0; i < 50; ++i)
    start.push_back(test::random_vector(random)), v.push_back(0.4 * test::random_vector(random));
  DisplacementMeter meter(box, true);
  const double dt = 0.1;
  for (uint64_t step = 0; step <= 500; step += 10) {
    std::vector<Vec3> x;
    const double t = static_cast<double>(step) * dt;
    for (size_t i = 0; i < start.size(); ++i) {
      x.push_back(start[i] + t * v[i]);
      for (int axis = 0; axis < 2; ++axis)
        x[i][axis] -= box.extent[axis] * std::floor(x[i][axis] / box.extent[axis]);
    }
    meter.add(step, x, v, dt);
    double squares = 0;
    Vec3 mean = Vec3::Zero();
    for (const Vec3& one : v) squares += one.squaredNorm() / 50, mean += one / 50;
    EXPECT_NEAR(mean_squared(meter.moved(), {}, {}).sum(), squares * t * t, 1e-9);
    EXPECT_NEAR(mean_squared(meter.moved(), {}, std::vector<double>(50, 2.0)).sum(),
                (squares - mean.squaredNorm()) * t * t, 1e-9);
  }
  // 50 s at up to 0.4 m/s: ten boxes.
  double farthest = 0;
  for (const Vec3& one : meter.moved()) farthest = std::max(farthest, std::abs(one.x()));
  EXPECT_GT(farthest, 4 * box.extent.x());
  // Of one particle alone, and about the centre of mass of a light and a heavy one.
  std::vector<char> first(50, 0);
  first[0] = 1;
  EXPECT_NEAR(mean_squared(meter.moved(), first, {}).sum(), v[0].squaredNorm() * 2500, 1e-9);
  EXPECT_EQ(mean_squared({Vec3(1, 0, 0), Vec3(-2, 0, 0)}, {}, {2, 1}), Vec3(2.5, 0, 0));
}

TEST(Displacement, RefusesAWayThatIsNotKnown) {
  Periodic box;
  box.extent = Vec3(4, 0, 0);
  DisplacementMeter meter(box, true);
  meter.add(0, {Vec3(0, 0, 0), Vec3(1, 0, 0)}, {Vec3::Zero(), Vec3::Zero()}, 1);
  meter.add(5, {Vec3(0.9, 9, 0), Vec3(1, 0, 0)}, {Vec3::Zero(), Vec3::Zero()}, 1);
  EXPECT_EQ(refused_with([&] {
              meter.add(7, {Vec3(3.8, 9, 0), Vec3(1, 0, 0)}, {Vec3::Zero(), Vec3::Zero()}, 1);
            }),
            "between steps 5 and 7 particle 0 moves 1.1 m along x, more than a quarter of the box (4 m): its "
            "way is not "
            "known\n  hint: keep frames more often: 'cuboct run --frame-every N'");
  // One whole box in 2 steps leaves no mark in the positions.
  DisplacementMeter whole(box, true);
  whole.add(0, {Vec3::Zero()}, {Vec3(2, 0, 0)}, 1);
  EXPECT_EQ(refused_with([&] { whole.add(2, {Vec3::Zero()}, {Vec3(2, 0, 0)}, 1); }),
            "between steps 0 and 2 the whole moves 4 m along x, more than a quarter of the box (4 m): its "
            "way is not "
            "known\n  hint: keep frames more often: 'cuboct run --frame-every N'");
  DisplacementMeter unwrapped(box, false);  // of positions in no box nothing is unknown
  unwrapped.add(0, {Vec3::Zero()}, {Vec3(2, 0, 0)}, 1);
  unwrapped.add(20, {Vec3(40, 0, 0)}, {Vec3(2, 0, 0)}, 1);
  EXPECT_EQ(unwrapped.moved()[0], Vec3(40, 0, 0));
}

Scene pair_scene(double r) {
  Scene scene;
  scene.rule = test::simple_rule(preset_law("elastic", 1, 1), 2, 0.1);
  scene.body.x = {Vec3::Zero(), r * Vec3(1, 0, 0)};
  scene.body.v = {Vec3(0, 3, 0), Vec3(0, 0, -1)};
  scene.body.type = {0, 0};
  return scene;
}

// Two particles that push with f at a distance r have -f r/2 each along their line, and less m v (x) v.
TEST(ParticleStress, OfTwoParticlesByHand) {
  const double r = 0.9;
  const Scene scene = pair_scene(r);
  const double f = scene.rule.law->force(r);
  ASSERT_GT(f, 0);
  ParticleStress stress(scene, 1);
  Mat3 pair = Mat3::Zero();
  pair(0, 0) = -f * r / 2;
  for (const Mat3& of : stress.of(scene.body, false, 0)) EXPECT_LT((of - pair).norm(), 1e-12 * f);
  std::vector<Mat3> whole = stress.of(scene.body, true, 0);
  EXPECT_NEAR(whole[0](1, 1), -2 * 9, 1e-12);
  EXPECT_NEAR(whole[1](2, 2), -2 * 1, 1e-12);
  EXPECT_NEAR(whole[0](0, 0), -f * r / 2, 1e-12 * f);
  // Half a step later the first goes at -f/m dt/2 along x.
  whole = stress.of(scene.body, true, 0.05);
  EXPECT_NEAR(whole[0](0, 0), -f * r / 2 - 2 * std::pow(f / 2 * 0.05, 2), 1e-12 * f);
  EXPECT_NEAR(whole[0](0, 1), 2 * 3 * (f / 2 * 0.05), 1e-12 * f);
  // At another place, as another frame has it.
  const Scene near = pair_scene(0.8);
  EXPECT_NEAR(stress.of(near.body, false, 0)[0](0, 0), -near.rule.law->force(0.8) * 0.4, 1e-12);
}

TEST(MeasuredFrames, AreChosenByWordsStepsAndRanges) {
  const std::vector<uint64_t> steps{0, 100, 200, 300, 350};
  using Chosen = std::vector<size_t>;
  EXPECT_EQ(chosen_frames(steps, "all"), (Chosen{0, 1, 2, 3, 4}));
  EXPECT_EQ(chosen_frames(steps, "half"), (Chosen{2, 3, 4}));
  EXPECT_EQ(chosen_frames({0}, "half"), (Chosen{0}));
  EXPECT_EQ(chosen_frames({0, 9}, "half"), (Chosen{1}));
  EXPECT_EQ(chosen_frames(steps, "last"), (Chosen{4}));
  EXPECT_EQ(chosen_frames(steps, "300,0,0"), (Chosen{0, 3}));
  EXPECT_EQ(chosen_frames(steps, "100:300"), (Chosen{1, 2, 3}));
  EXPECT_EQ(chosen_frames(steps, "250:"), (Chosen{3, 4}));
  EXPECT_EQ(chosen_frames(steps, ":99"), (Chosen{0}));
  for (const char* wrong : {"first", "", "1", "100,", "101:199", "a:5", "5:b", "-1:"})
    EXPECT_EQ(refused_with([&] { chosen_frames(steps, wrong); }),
              "no frames '" + std::string(wrong) +
                  "'\n  hint: all, half, last, steps as 0,500 or from one step to another as 100:900; kept "
                  "are 0, 100, "
                  "200, 300, 350");
}

// Bins that no pair of the body can be in are told: two particles 0.9 m apart, in bins of 0.5 m up to 10 m.
TEST(Measures, TellOfACutoffBeyondTheBody) {
  const Scene scene = pair_scene(0.9);
  const auto empty = [&](double cutoff) {
    const auto rdf = make_measure("rdf", scene, {.cutoff = cutoff, .bins = 20, .volume = 1});
    rdf->add({.body = scene.body});
    for (const auto& [name, text] : rdf->result().notes)
      if (name == "empty") return text;
    return std::string("none");
  };
  EXPECT_EQ(empty(10),
            "no two particles within the cutoff are farther apart than 1 m: a shorter one has finer bins");
  EXPECT_EQ(empty(1), "none");
  EXPECT_EQ(empty(0.5), "no two particles are within the cutoff");
}

TEST(Measures, RefuseWhatTheyHaveNot) {
  const Scene scene = pair_scene(0.9);
  const auto refusal = [&](const std::string& name, const MeasureChoice& choice) {
    return refused_with([&] { make_measure(name, scene, choice); });
  };
  EXPECT_EQ(refusal("rfd", {}), "no measure 'rfd'\n  hint: did you mean 'rdf'?");
  EXPECT_EQ(refusal("x", {}), "no measure 'x'\n  hint: rdf, msd, coordination, cna or stress");
  EXPECT_EQ(refusal("msd", {.cutoff = 1}),
            "--cutoff is not an option of msd\n  hint: it is one of rdf, coordination or cna");
  EXPECT_EQ(refusal("cna", {.com = true}), "--com is not an option of cna\n  hint: it is one of msd");
  EXPECT_EQ(refusal("rdf", {}),
            "the body's volume is not known: its box does not repeat along x, y and z\n  hint: --volume says "
            "it: '1 "
            "mm^3'");
  EXPECT_EQ(refusal("rdf", {.types = {"free"}, .volume = 1}),
            "--types of rdf names two materials, not 1\n  hint: A,B: those of B about those of A; A,A of one "
            "with itself");
  EXPECT_EQ(refusal("msd", {.types = {"fre"}}), "no material 'fre'\n  hint: did you mean 'free'?");
}

}  // namespace
}  // namespace cuboct
