// SPDX-License-Identifier: MIT
// The example scenes as a machine gets them: each is read, quantised and run by golden for some steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/config/file_kind.h"
#include "model/contract/golden.h"
#include "model/contract/neighbours.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"

namespace cuboct {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

using MadeSetup = cuboct::Setup;  // testing::Test has a member of that name

// Every file of the tree is taken for what it is, and for nothing else.
TEST(FileKinds, OfAllExamples) {
  namespace fs = std::filesystem;
  const std::vector<FileKind> kinds{FileKind::scene,         FileKind::arch,          FileKind::study,
                                    FileKind::machine_study, FileKind::curve_fit,     FileKind::potential_fit,
                                    FileKind::learn_study,   FileKind::element_study, FileKind::technology,
                                    FileKind::run_record,    FileKind::rule};
  std::map<FileKind, int> seen;
  for (const char* folder : {"scenes", "technologies"})
    for (const auto& entry : fs::recursive_directory_iterator(kRoot + "/" + folder)) {
      const std::string path = entry.path().string(), name = entry.path().filename().string();
      // Tables of links and of others' machines have names of their own alone; one chip has none of the
      // figures.
      if (entry.path().extension() != ".toml" || name == "links.toml" || name == "boards.toml" ||
          name == "machines.toml" || path.ends_with("technologies/ecp5.toml"))
        continue;
      std::vector<FileKind> taken;
      const std::string text = read_config_text(path);
      for (const FileKind kind : kinds) {
        try {
          refuse_other_kind(kind, text, path);
          taken.push_back(kind);
        } catch (const InputError&) {
        }
      }
      ASSERT_EQ(taken.size(), 1u) << path;
      ++seen[taken[0]];
      const bool arch = path.find("/archs/") != std::string::npos;
      EXPECT_EQ(arch, taken[0] == FileKind::arch && arch) << path;
      EXPECT_EQ(path.find("/technologies/") != std::string::npos, taken[0] == FileKind::technology) << path;
      if (path.find("/failures/") != std::string::npos && !arch) {
        EXPECT_EQ(taken[0], FileKind::scene) << path;
      }
    }
  EXPECT_EQ(seen.size(), kinds.size() - 1);  // no record of a run
  EXPECT_THROW(refuse_other_kind(FileKind::scene, "scene = 'a'\nengine = 'b'\nstate = 'c'\n", "run.toml"),
               InputError);
}

struct Outcome {
  size_t moved = 0;   // particles that changed their node
  size_t corner = 0;  // of which along more than one axis in one step
};

Outcome run(const MadeSetup& setup, int steps) {
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  Outcome outcome;
  State before = setup.initial;
  for (int i = 0; i < steps; ++i) {
    golden.step();
    const State after = golden.state();
    for (size_t p = 0; p < after.particles.size(); ++p) {
      if (after.particles[p].cell == before.particles[p].cell) continue;
      ++outcome.moved;
      int axes = 0;
      for (int a = 0; a < 3; ++a)
        axes += setup.plan.lattice.cell(after.particles[p].cell)[a] !=
                setup.plan.lattice.cell(before.particles[p].cell)[a];
      outcome.corner += axes > 1;
    }
    before = after;
  }
  return outcome;
}

TEST(Examples, RunOnEveryArch) {
  for (const char* name : {"hot_cluster", "two_types", "undamped_block", "lj_block", "coupon", "composite"}) {
    const Scene scene = read_scene(kRoot + "/scenes/" + name + ".toml");
    for (const char* arch : {"default", "small", "fast", "solid"}) {
      SCOPED_TRACE(std::string(name) + " on " + arch);
      EXPECT_NO_THROW(run(make_setup(scene, read_arch(kRoot + "/scenes/archs/" + arch + ".toml")), 5));
    }
  }
}

// The whole length of the small ones.
TEST(Examples, RunToTheirEnd) {
  for (const char* name : {"hot_cluster", "two_types", "undamped_block", "lj_block"}) {
    SCOPED_TRACE(name);
    const Scene scene = read_scene(kRoot + "/scenes/" + std::string(name) + ".toml");
    const MadeSetup setup = make_setup(scene, {});
    const Outcome outcome = run(setup, static_cast<int>(scene.steps));
    EXPECT_GT(outcome.moved, 0U);
    if (std::string(name) == "hot_cluster") {
      EXPECT_GT(outcome.moved, 100U);
      EXPECT_GT(outcome.corner, 0U);
    }
  }
}

// Each boundary of the composite passes on 2 Z/(Z + Z') of the speed, Z of the side that the wave comes from.
TEST(Examples, TheCompositePassesOnWhatItsImpedancesSay) {
  const Scene scene = read_scene(kRoot + "/scenes/composite.toml");
  ASSERT_EQ(scene.rule.laws(), 3U);
  ASSERT_FALSE(scene.rule.masses.empty());
  const double ratio = std::sqrt(16 * 11.34 / (2.8 * 1.41));  // of the lead's Z to the acetal's
  const double entered = 2 / (1 + ratio), left = entered * 2 * ratio / (1 + ratio);
  Reference run(scene.rule, scene.body, scene.periodic);
  double in_lead = 0, behind = 0;
  uint64_t in_lead_steps = 0, behind_steps = 0;
  const auto speed = [&](const std::string& name) {
    const auto probe = std::ranges::find(scene.probes, name, &Probe::name);
    double sum = 0;
    for (const uint32_t id : probe->set.ids) sum += run.body().v[id].x();
    return sum / static_cast<double>(probe->set.ids.size());
  };
  for (uint64_t step = 1; step <= scene.steps; ++step) {
    run.step();
    const double time = static_cast<double>(step) * scene.rule.dt;
    if (time > 16e-6 && time < 27e-6) in_lead += speed("in_lead"), ++in_lead_steps;
    if (time > 28e-6) behind += speed("behind"), ++behind_steps;
  }
  ASSERT_GT(in_lead_steps, 200U);
  ASSERT_GT(behind_steps, 40U);
  EXPECT_NEAR(in_lead / static_cast<double>(in_lead_steps), entered, 0.01 * entered);
  EXPECT_NEAR(behind / static_cast<double>(behind_steps), left, 0.01 * left);
}

// The benchmark's claims: so many particles, 18 neighbours inside the cutoff, and migration.
TEST(Examples, TheBenchmarkBlockIsWhatItSays) {
  const Scene scene = read_scene(kRoot + "/scenes/bench/block_32k.toml");
  EXPECT_EQ(scene.body.size(), 32'000U);
  EXPECT_NEAR(scene.rule.law->cutoff(), 1.6 * scene.pitch, 1e-12);
  std::vector<int> neighbours(scene.body.size());
  CellList cells(scene.rule.law->cutoff(), scene.periodic);
  cells.build(scene.body.x);
  cells.for_each_pair(scene.body.x, [&](uint32_t i, uint32_t j, const Vec3&, double) {
    ++neighbours[i];
    ++neighbours[j];
  });
  EXPECT_EQ(*std::max_element(neighbours.begin(), neighbours.end()), 18);
  // Of 40 planes of sites along each axis two at either end lack a second neighbour; every other point of the
  // planes' grid is a site.
  EXPECT_EQ(std::count(neighbours.begin(), neighbours.end(), 18), 36 * 36 * 36 / 2);
  EXPECT_GT(run(make_setup(scene, {}), 20).moved, 0U);
}

}  // namespace
}  // namespace cuboct
