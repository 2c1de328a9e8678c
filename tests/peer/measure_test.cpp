// SPDX-License-Identifier: MIT
// `cuboct measure` beside LAMMPS's computes rdf, msd, coord/atom, cna/atom, stress/atom and pressure, at the
// positions and velocities that LAMMPS itself wrote.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "model/analysis/common_neighbours.h"
#include "model/analysis/displacement.h"
#include "model/analysis/near_within.h"
#include "model/analysis/particle_stress.h"
#include "model/analysis/radial_distribution.h"
#include "model/scene/scene.h"
#include "tests/fcc_block.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

constexpr size_t kBins = 100;
constexpr double kRdfCutoff = 3;

// A frame as LAMMPS dumps it.
struct Dumped {
  uint64_t step = 0;
  Body body;  // positions in the box
  std::vector<double> coordination, structure;
  std::vector<std::array<double, 6>> stress, virial;  // xx, yy, zz, xy, xz, yz
};

std::vector<Dumped> dumped(const std::string& text, size_t count, const std::vector<uint8_t>& type) {
  std::vector<Dumped> frames;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("ITEM: TIMESTEP")) frames.emplace_back(), in >> frames.back().step;
    if (!line.starts_with("ITEM: ATOMS")) continue;
    Dumped& of = frames.back();
    of.body.type = type;
    for (size_t i = 0; i < count; ++i) {
      size_t id = 0;
      Vec3 x, v;
      double coordination = 0, structure = 0;
      std::array<double, 6> stress{}, virial{};
      in >> id >> x[0] >> x[1] >> x[2] >> v[0] >> v[1] >> v[2] >> coordination >> structure;
      for (double& one : stress) in >> one;
      for (double& one : virial) in >> one;
      if (!in || id != i + 1) throw std::runtime_error("LAMMPS wrote a broken frame");
      of.body.x.push_back(x), of.body.v.push_back(v);
      of.coordination.push_back(coordination), of.structure.push_back(structure);
      of.stress.push_back(stress), of.virial.push_back(virial);
    }
  }
  return frames;
}

// Rows of numbers: of a file of `fix ave/time` all that hold `columns` of them.
std::vector<std::vector<double>> rows_of(const std::string& text, size_t columns) {
  std::vector<std::vector<double>> rows;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream words(line);
    std::vector<double> row;
    for (double value = 0; words >> value;) row.push_back(value);
    if (row.size() == columns) rows.push_back(std::move(row));
  }
  return rows;
}

constexpr const char* kComputes = R"(neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
comm_modify cutoff 4.0
timestep 0.004
compute near all coord/atom cutoff {0}
compute structure all cna/atom {0}
compute stress all stress/atom NULL
compute virial all stress/atom NULL virial
compute rdf all rdf {1} * * 1 2 1 1 cutoff {2}
compute msd all msd
compute about all msd com yes
fix rdf all ave/time 1 1 {4} c_rdf[*] file rdf.txt mode vector format " %.17g"
fix msd all ave/time 1 1 {4} c_msd[*] c_about[*] c_thermo_press c_thermo_press[*] file msd.txt format " %.17g"
dump frames all custom {4} frames.txt id x y z vx vy vz c_near c_structure c_stress[*] c_virial[*]
dump_modify frames sort id format float %.17g
fix nve all nve
thermo {4}
run {3}
)";

struct Answer {
  std::vector<Dumped> frames;
  std::vector<std::vector<double>> rdf;  // of each frame kBins rows: bin, r, then g and n of three pairs
  std::vector<std::vector<double>>
      msd;  // of each frame a row: step, msd, about the centre of mass, pressure, its tensor
};

Answer ask(const Body& body, const Periodic& box, double cutoff, int steps, int every) {
  test::LammpsRun run{.periodic = box,
                      .pair = "pair_style lj/smooth/linear 2.5\npair_coeff * * 1 1",
                      .files = {},
                      .types = 2};
  const std::vector<std::string> texts =
      test::ask_lammps(run, body, fmt::format(kComputes, cutoff, kBins, kRdfCutoff, steps, every),
                       {"frames.txt", "rdf.txt", "msd.txt"});
  return {dumped(texts[0], body.size(), body.type), rows_of(texts[1], 8), rows_of(texts[2], 16)};
}

class MeasuredByLammps : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  }

  // Neighbours and structures by LAMMPS's fixed cutoff: of each particle equal. What LAMMPS calls 5 is
  // `other`. By structure how many.
  static std::array<size_t, 6> expect_structures(const Dumped& frame, const Periodic& box, double cutoff) {
    std::array<size_t, 6> seen{};
    const std::vector<Structure> found = structures_within(frame.body.x, box, cutoff);
    for (size_t i = 0; i < found.size(); ++i) {
      const auto theirs = static_cast<size_t>(frame.structure[i]);
      EXPECT_EQ(static_cast<size_t>(found[i]), theirs % 5) << i;
      ++seen.at(theirs);
    }
    std::vector<double> near(found.size());
    for_each_near(frame.body.x, box, cutoff, 0, [&](size_t, uint32_t i, std::span<const uint32_t> of) {
      near[i] = static_cast<double>(of.size());
    });
    EXPECT_EQ(near, frame.coordination);
    // LAMMPS's analysis keeps 16 neighbours of a particle, and warns of those that have more.
    EXPECT_LE(*std::ranges::max_element(near), 16);
    return seen;
  }
};

// A crystal at kT = 0.75 and at 0.3 that moves on: what is solid, what melts, and what goes through the box's
// faces.
TEST_F(MeasuredByLammps, AMeltIsMeasuredAlike) {
  constexpr int kSteps = 200, kEvery = 25;
  const double cutoff = 1.45;
  Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/validation/melt_864.toml");
  for (size_t i = 0; i < scene.body.size(); ++i) {
    scene.body.v[i] = 0.6 * scene.body.v[i] + Vec3(0.5, 0, 0);  // a drift that the centre of mass has
    scene.body.type[i] = i % 3 == 0;
  }
  scene.body.exact = nullptr;
  const Answer theirs = ask(scene.body, scene.periodic, cutoff, kSteps, kEvery);
  const size_t frames = kSteps / kEvery + 1, n = scene.body.size();
  ASSERT_EQ(theirs.frames.size(), frames);
  ASSERT_EQ(theirs.rdf.size(), frames * kBins);
  ASSERT_EQ(theirs.msd.size(), frames);

  const double volume = scene.periodic.extent.prod();
  RdfSets of_two, of_one;
  for (const uint8_t type : scene.body.type) {
    of_two.a.push_back(type == 0), of_two.b.push_back(type == 1);
    of_one.a.push_back(type == 0), of_one.b.push_back(type == 0);
  }
  DisplacementMeter displacement(scene.periodic, true);
  for (uint8_t& type : scene.body.type) type = 0;  // of one material in the rule
  ParticleStress stress(scene, 1);
  std::array<size_t, 6> seen{};
  uint64_t pairs = 0;
  double largest_stress = 0, largest_difference = 0;
  for (size_t k = 0; k < frames; ++k) {
    Dumped frame = theirs.frames[k];
    const std::vector<Vec3>& x = frame.body.x;
    size_t column = 2;
    for (const RdfSets& sets : {RdfSets{}, of_two, of_one}) {
      RdfMeter meter(scene.periodic, kRdfCutoff, kBins, sets);
      meter.add(x);
      const Rdf rdf = meter.result(volume);
      const double about = sets.a.empty() ? static_cast<double>(n)
                                          : static_cast<double>(std::count(sets.a.begin(), sets.a.end(), 1));
      double before = 0;
      for (size_t bin = 0; bin < kBins; ++bin) {
        const std::vector<double>& row = theirs.rdf[k * kBins + bin];
        // LAMMPS tells counts by the running coordination number. They are whole: equal.
        EXPECT_EQ(static_cast<double>(rdf.pairs[bin]), std::round((row[column + 1] - before) * about))
            << k << ' ' << bin;
        before = row[column + 1];
        EXPECT_NEAR(rdf.middle(bin), row[1], 1e-12);
        EXPECT_NEAR(rdf.g[bin], row[column], 1e-12 * (1 + row[column]));
        EXPECT_NEAR(rdf.within[bin], row[column + 1], 1e-10);  // a sum of a hundred
        pairs += rdf.pairs[bin];
      }
      column += 2;
    }
    displacement.add(frame.step, x, frame.body.v, 0.004);
    const Vec3 whole = mean_squared(displacement.moved(), {}, {});
    const Vec3 about = mean_squared(displacement.moved(), {}, std::vector<double>(n, 1));
    const std::vector<double>& row = theirs.msd[k];
    EXPECT_EQ(row[0], static_cast<double>(frame.step));
    // Sums of 864 squares of differences of numbers near 10, which are read to 17 digits.
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(whole[axis], row[static_cast<size_t>(1 + axis)], 1e-12);
      EXPECT_NEAR(about[axis], row[static_cast<size_t>(5 + axis)], 1e-12);
    }
    EXPECT_NEAR(whole.sum(), row[4], 3e-12);
    EXPECT_NEAR(about.sum(), row[8], 3e-12);

    const std::array<size_t, 6> here = expect_structures(frame, scene.periodic, cutoff);
    for (size_t s = 0; s < 6; ++s) seen[s] += here[s];

    frame.body.type.assign(n, 0);
    std::array<double, 6> sum{};
    constexpr int kAt[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (const bool kinetic : {false, true}) {
      const std::vector<Mat3> of = stress.of(frame.body, kinetic, 0);
      for (size_t i = 0; i < n; ++i)
        for (size_t c = 0; c < 6; ++c) {
          const double ours = of[i](kAt[c][0], kAt[c][1]),
                       other = (kinetic ? frame.stress : frame.virial)[i][c];
          largest_stress = std::max(largest_stress, std::abs(other));
          largest_difference = std::max(largest_difference, std::abs(ours - other));
          if (kinetic) sum[c] += ours / volume;
        }
    }
    EXPECT_NEAR(-(sum[0] + sum[1] + sum[2]) / 3, row[9],
                1e-12 * largest_stress * static_cast<double>(n) / volume);
    for (size_t c = 0; c < 6; ++c)
      EXPECT_NEAR(-sum[c], row[10 + c], 1e-12 * largest_stress * static_cast<double>(n) / volume) << c;
  }
  // Sums of some 80 pairs, each rounded in its own order.
  EXPECT_LT(largest_difference, 1e-13 * largest_stress);
  EXPECT_GT(mean_squared(displacement.moved(), {}, {})[0], 0.1);  // the drift's 0.4^2
  EXPECT_GT(pairs, 1000000u);
  // A crystal, what is left of it, and what is none.
  EXPECT_GT(seen[1], n);
  EXPECT_GT(seen[5], n);
  fmt::print(
      "{} pairs; fcc, hcp, bcc, icosahedral, other: {}, {}, {}, {}, {}; stress to {:.1e} of its largest\n",
      pairs, seen[1], seen[2], seen[3], seen[4], seen[5], largest_difference / largest_stress);
}

// Crystals of each structure, warm enough that some of them are lost.
TEST_F(MeasuredByLammps, StructuresOfWarmCrystals) {
  struct Case {
    const char* name;
    size_t structure;
    Vec3 edges;
    std::vector<Vec3> basis;
    double cutoff, shift;
  };
  const double root3 = std::sqrt(3.0), half = 0.5;
  for (const Case& of :
       {Case{"fcc",
             1,
             Vec3::Constant(std::sqrt(2.0)),
             {Vec3(0, 0, 0), Vec3(half, half, 0), Vec3(half, 0, half), Vec3(0, half, half)},
             1.2,
             0.1},
        Case{"hcp",
             2,
             Vec3(1, root3, std::sqrt(8.0 / 3)),
             {Vec3(0, 0, 0), Vec3(half, half, 0), Vec3(half, 5.0 / 6, half), Vec3(0, 1.0 / 3, half)},
             1.2,
             0.1},
        Case{"bcc", 3, Vec3::Constant(1.2), {Vec3(0, 0, 0), Vec3(half, half, half)}, 1.45, 0.12}}) {
    Body body;
    Periodic box;
    const std::array<int, 3> count{8, of.edges.y() > 1.5 ? 5 : 8, 6};
    for (int k = 0; k < count[2]; ++k)
      for (int j = 0; j < count[1]; ++j)
        for (int i = 0; i < count[0]; ++i)
          for (const Vec3& site : of.basis)
            body.x.push_back((Vec3(i, j, k) + site + Vec3::Constant(0.1)).cwiseProduct(of.edges));
    for (int axis = 0; axis < 3; ++axis) box.extent[axis] = count[static_cast<size_t>(axis)] * of.edges[axis];
    body.v.assign(body.x.size(), Vec3::Zero());
    body.type.assign(body.x.size(), 0);
    test::shake(body, of.shift, 0, 4);
    const Answer theirs = ask(body, box, of.cutoff, 0, 1);
    ASSERT_EQ(theirs.frames.size(), 1u);
    const std::array<size_t, 6> seen = expect_structures(theirs.frames[0], box, of.cutoff);
    EXPECT_GT(seen[of.structure], body.size() / 20) << of.name;
    EXPECT_GT(seen[5], body.size() / 20) << of.name;
    fmt::print("{}: {} of {} are left\n", of.name, seen[of.structure], body.size());
  }
}

}  // namespace
}  // namespace cuboct
