// SPDX-License-Identifier: MIT
// Studies of machines: counts of many machines from one run, bands against limits, fronts, searches.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cli/machine/machine_cycles.h"
#include "study/machines/counts.h"
#include "study/machines/machine_evolution.h"
#include "study/machines/machine_front.h"
#include "study/machines/machine_table.h"
#include "tests/study/small_study.h"

namespace cuboct::study {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

Technology technology_named(const std::string& name) {
  return read_technology(kRoot + "/technologies/" + name + ".toml");
}

MachineStudy read(const test::SmallStudy& files, const std::string& text) {
  return read_machine_study(
      files.study(text), {technology_named, [](Technology t, const std::string&) { return t; }, {"ecp5-85"}});
}

// Of kinds that take different ways through the timing model.
const std::vector<std::vector<Change>> kArchs{
    {},
    {{"node.filter_lanes", "2"}, {"node.force_pipes", "2"}, {"node.queue_depth", "3"}},
    {{"node.brick", "[2, 1, 2]"}, {"node.overlap", "false"}},
    {{"node.halos", "\"arrival\""}, {"node.streamers", "2"}, {"node.force_pipes", "2"}},
    {{"node.multipliers", "\"serial\""}, {"link.bits", "9"}},
    {{"node.multipliers", "\"shared\""}, {"link.check", "\"detect\""}},
    {{"node.memories", "\"narrow\""},
     {"node.filter_lanes", "1"},
     {"node.overlap", "false"},
     {"link.bits", "16"}}};

// One run for all machines counts what a run of each counts, and their plans are those of a run.
TEST(Machines, OneRunCountsEachMachineAsItsOwnRunDoes) {
  const Base base = read_base(kRoot + "/scenes/undamped_block.toml", "");
  const SharedSetup shared(base, of_bits({}));
  std::vector<Plan> plans;
  std::vector<cuboct::Setup> own;
  for (const auto& changes : kArchs) {
    Settings settings;
    settings.arch = changes;
    EXPECT_TRUE(of_bits(settings).arch.empty());
    const Case c = resolve(base, settings);
    own.push_back(make_setup(c.scene, c.arch));
    plans.push_back(shared.plan_of(c.arch));
    EXPECT_EQ(plans.back().hash, own.back().plan.hash) << c.arch_text;
  }
  const auto counted = count_machines(shared, plans, 12);
  std::set<uint64_t> cycles;
  for (size_t k = 0; k < own.size(); ++k) {
    const auto alone = count_run(own[k].plan, own[k].initial, 12);
    ASSERT_TRUE(alone && counted[k]);
    EXPECT_EQ(counted[k]->steps, 12U);
    EXPECT_EQ(counted[k]->cycles, alone->cycles.cycles) << k;
    EXPECT_EQ(counted[k]->most, alone->cycles.most) << k;
    EXPECT_EQ(counted[k]->events, sum(alone->nodes)) << k;
    // The parts of a step are all of it.
    double parts = 0;
    for (const double part : counted[k]->parts) parts += part;
    EXPECT_NEAR(parts, counted[k]->mean(), 1e-9 * parts) << k;
    cycles.insert(counted[k]->cycles);
  }
  EXPECT_EQ(cycles.size(), kArchs.size());  // no two machines of the list are one
}

// Lanes and pipes demand no more cycles than there are, and the pipes' demand is the busiest node's pairs.
TEST(Machines, DemandsAreThoseOfTheBusiestNode) {
  const Base base = read_base(kRoot + "/scenes/undamped_block.toml", "");
  const SharedSetup shared(base, of_bits({}));
  Settings settings;
  settings.arch = {{"node.force_pipes", "2"}, {"node.filter_lanes", "4"}};
  const Case c = resolve(base, settings);
  const std::vector<Plan> plans{shared.plan_of(c.arch)};
  const auto counted = count_machines(shared, plans, 4);
  const auto alone = count_run(plans[0], shared.initial(), 4);
  uint64_t pairs = 0, candidates = 0;
  for (const MachineEvents& node : alone->nodes)
    pairs = std::max(pairs, node.pairs), candidates = std::max(candidates, node.candidates);
  EXPECT_DOUBLE_EQ(counted[0]->demands[static_cast<size_t>(Demand::pipes)], static_cast<double>(pairs) / 8);
  EXPECT_DOUBLE_EQ(counted[0]->demands[static_cast<size_t>(Demand::lanes)],
                   static_cast<double>(candidates) / 4);
  for (const double demand : counted[0]->demands) EXPECT_LE(demand, counted[0]->mean());
}

// Nothing but links binds this machine, and they are used nearly all the time: a demand that counted the axes
// one after another would be more than there is.
TEST(Machines, LinksDemandNoMoreThanThereIs) {
  const Base base = read_base(kRoot + "/scenes/lj_block.toml", "");
  const SharedSetup shared(base, of_bits({}));
  Settings settings;
  settings.arch = {{"node.halos", "\"arrival\""},
                   {"node.streamers", "2"},
                   {"node.force_pipes", "64"},
                   {"node.filter_lanes", "64"},
                   {"node.queue_depth", "256"}};
  const Case c = resolve(base, settings);
  const std::vector<Plan> plans{shared.plan_of(c.arch)};
  const auto counted = count_machines(shared, plans, 4);
  const double links = counted[0]->demands[static_cast<size_t>(Demand::links)];
  EXPECT_LE(links, counted[0]->mean());
  EXPECT_GE(links, 0.5 * counted[0]->mean());
  EXPECT_EQ(bound_of(*counted[0]), "links");
}

MachineValue band(double low, double high, bool open = false) {
  return {{low, high}, Known::estimated, open};
}

TEST(Machines, AConstraintHoldsOnlyWhereAllOfTheBandKeepsIt) {
  MachineConstraint most;
  most.limit = 10;
  EXPECT_EQ(judge(most, band(2, 10)), Verdict::holds);
  EXPECT_EQ(judge(most, band(2, 10.1)), Verdict::undecided);
  EXPECT_EQ(judge(most, band(10.1, 12)), Verdict::fails);
  EXPECT_EQ(judge(most, band(2, 3, true)), Verdict::undecided);  // what is missing may be anything
  EXPECT_EQ(judge(most, band(11, 12, true)), Verdict::fails);
  EXPECT_EQ(judge(most, MachineValue()), Verdict::undecided);
  MachineConstraint least = most;
  least.at_most = false;
  EXPECT_EQ(judge(least, band(10, 12)), Verdict::holds);
  EXPECT_EQ(judge(least, band(9, 12)), Verdict::undecided);
  EXPECT_EQ(judge(least, band(2, 9)), Verdict::fails);
  EXPECT_EQ(judge(least, band(2, 9, true)), Verdict::undecided);
  EXPECT_DOUBLE_EQ(excess(most, band(2, 20)), 2);
  EXPECT_DOUBLE_EQ(excess(least, band(5, 20)), 2);
}

TEST(Machines, BandsOfOneTechnologyAreComparedEndByEndOthersAsAWhole) {
  MachineStudy study;
  study.minimise = {static_cast<size_t>(MachineQuantity::energy)};
  const auto machine = [](double low, double high, size_t technology) {
    MachineFinding f;
    f.values.resize(kMachineQuantities);
    f.values[static_cast<size_t>(MachineQuantity::energy)] = band(low, high);
    f.choice.technology = technology;
    return f;
  };
  EXPECT_TRUE(dominates(study, machine(1, 5, 0), machine(2, 6, 0)));
  EXPECT_FALSE(dominates(study, machine(1, 5, 0), machine(2, 6, 1)));
  EXPECT_TRUE(dominates(study, machine(1, 2, 0), machine(2, 6, 1)));
  EXPECT_FALSE(dominates(study, machine(1, 6, 0), machine(2, 5, 0)));
  EXPECT_FALSE(dominates(study, machine(1, 5, 0), machine(1, 5, 0)));
  std::vector<MachineFinding> all{machine(1, 5, 0), machine(2, 6, 0), machine(3, 4, 1)};
  EXPECT_EQ(machine_front(study, all), (std::vector<size_t>{0, 2}));
  EXPECT_EQ(best_machine(study, all), 2U);  // its high end is least
  all.push_back(all[0]);
  EXPECT_EQ(machine_front(study, all), (std::vector<size_t>{0, 2}));  // the first of equals
  all[2].why = "refused";
  EXPECT_EQ(best_machine(study, all), 0U);
}

constexpr const char* kSpace = R"(technology = "cmos45"
clock = ["50 MHz", "200 MHz"]
filter_lanes = [1, 2, 4, 8]
force_pipes = [1, 2, 4]
brick = [[1, 1, 1], [2, 2, 2], [7, 7, 7]]
)";

#ifdef CUBOCT_HAS_EVOLUTION
std::vector<std::string> machines_of(const MachineStudy& study, const std::vector<MachineFinding>& findings,
                                     const std::vector<size_t>& some) {
  std::vector<std::string> texts;
  for (const size_t n : some) texts.push_back(machine_text(study, findings[n].choice));
  std::ranges::sort(texts);
  return texts;
}

// The same axes as a grid and as a search, which looks at part of them: one front.
TEST(Machines, ASearchFindsTheGridsFront) {
  const test::SmallStudy files;
  const std::string head = "steps = 8\nminimise = [\"time\", \"energy\", \"area\"]\n";
  const MachineStudy grid = read(files, head + "[[machines]]\n" + kSpace);
  ASSERT_EQ(grid.points.size(), 72U);
  MachineRunner grid_runner(grid, {"", 2, false, {}});
  const auto all = grid_runner.evaluate(grid.points, grid.steps);
  const auto expected = machines_of(grid, all, machine_front(grid, all));
  ASSERT_GT(expected.size(), 3U);
  ASSERT_LT(expected.size(), 50U);
  const MachineStudy search = read(files, head + "[evolve]\npopulation = 24\ngenerations = 12\n" + kSpace);
  ASSERT_TRUE(search.evolution);
  EXPECT_EQ(search.evolution->space.points(), 72);
  MachineRunner runner(search, {"", 2, false, {}});
  const Evolved evolved = evolve_machines(search, runner);
  EXPECT_GT(evolved.visited, 24U);
  std::vector<size_t> whole(evolved.front.size());
  for (size_t n = 0; n < whole.size(); ++n) whole[n] = n;
  EXPECT_EQ(machines_of(search, evolved.front, whole), expected);
  for (const MachineFinding& f : evolved.front) {
    EXPECT_FALSE(f.screened);
    EXPECT_EQ(f.counts->steps, 8U);
    EXPECT_EQ(f.value(MachineQuantity::cycles).known, Known::exact);
  }
}
#endif

// Bricks larger than the lattice and more pipes than lanes make no machine; all others are there.
TEST(Machines, CombinationsThatMakeNoMachineAreTold) {
  const test::SmallStudy files;
  const MachineStudy study = read(files, std::string("steps = 2\n[[machines]]\n") + kSpace);
  MachineRunner runner(study, {"", 2, false, {}});
  size_t large = 0, wide = 0;
  for (const MachineFinding& f : runner.evaluate(study.points, study.steps)) {
    const std::string text = machine_text(study, f.choice);
    const auto has = [&](const char* words) { return text.find(words) != std::string::npos; };
    const bool too_wide = (has("lanes 1,") && !has("pipes 1,")) || (has("lanes 2,") && has("pipes 4,"));
    const bool too_large = has("[7, 7, 7]");
    EXPECT_EQ(f.done(), !too_wide && !too_large) << text;
    EXPECT_EQ(f.why.starts_with("force_pipes = "), too_wide) << text << f.why;
    large += too_large, wide += too_wide;
  }
  EXPECT_EQ(large, 24U);
  EXPECT_EQ(wide, 18U);
}

}  // namespace
}  // namespace cuboct::study
