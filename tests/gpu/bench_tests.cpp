// SPDX-License-Identifier: MIT
// The benchmark around engines of known speed.
#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <set>

#include "emu/gpu/bench/bench_report.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "tests/gpu/fake_clock.h"
#include "tests/gpu/fake_nvml.h"

namespace cuboct::gpu {
namespace {

constexpr double kStep = 2e-4;  // s, of a step

// What the benchmark asked for.
struct Asked {
  FakeClock* clock = nullptr;
  std::string arithmetic = {};
  int capacity = 0;  // of the plan
  bool damps = false;
  Options options = {};
  std::vector<uint64_t> advances = {};
};

// Takes kStep for a step and makes a list in each tenth.
class SlowEngine : public Engine {
 public:
  explicit SlowEngine(Asked& asked, std::function<void(uint64_t)> on_step)
      : asked_(asked), on_step_(std::move(on_step)) {}

  void advance(uint64_t steps, std::vector<uint64_t>*) override {
    asked_.advances.push_back(steps);
    for (uint64_t k = 0; k < steps; ++k) {
      if (++step_ % 10 == 0) ++counters_.list_builds;
      if (on_step_) on_step_(step_);
      asked_.clock->pass(kStep);
    }
    counters_.listed_pairs = 20.5;
    counters_.device_bytes = 86400;
  }
  uint64_t step_count() const override { return step_; }
  Reading read(bool) override { return {}; }
  void probe(const std::vector<uint32_t>&) override {}
  State state() override { return {}; }
  uint64_t hash() override { return 0; }
  Body body() override { return {}; }
  const Counters& counters() const override { return counters_; }

 private:
  Asked& asked_;
  std::function<void(uint64_t)> on_step_;
  uint64_t step_ = 0;
  Counters counters_;
};

BenchMachine machine_of(Asked& asked, const std::function<void(uint64_t)>& on_step = {}) {
  BenchMachine machine;
  machine.devices = [](std::string*) {
    return std::vector<Device>{{0, "NVIDIA H100 \"80GB\"", "0000:1b:00.0", 132, 85000000000, 84000000000},
                               {1, "NVIDIA H100 \"80GB\"", "0000:2c:00.0", 132, 85000000000, 84000000000}};
  };
  machine.fixed = [&asked, on_step](const Scene& scene, const Plan& plan, const State& initial,
                                    const Options& options) {
    EXPECT_EQ(initial.particles.size(), scene.body.size());
    asked = {asked.clock, "fixed", plan.arch.capacity, scene.rule.damping.coefficient > 0, options, {}};
    return std::make_unique<SlowEngine>(asked, on_step);
  };
  machine.real = [&asked, on_step](const Scene& scene, const Body& body, Arithmetic arithmetic,
                                   const Options& options) {
    EXPECT_EQ(&body, &scene.body);
    asked = {asked.clock, arithmetic == Arithmetic::float32 ? "float" : "double",
             0,           scene.rule.damping.coefficient > 0,
             options,     {}};
    return std::make_unique<SlowEngine>(asked, on_step);
  };
  machine.copy_bandwidth = [](int device) { return device == 0 ? 2e12 : 1e12; };
  machine.nvml = "/nowhere/nvml.so";
  machine.clock = asked.clock;
  return machine;
}

BenchRow row_of(BenchScene::Kind kind, const char* arithmetic) {
  return {{kind, 6, false}, arithmetic, "small", ""};
}

TEST(Statistics, OfFewNumbers) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(median({7}), 7);
  RowResult result;
  result.particles = 1000;
  result.steps = 50;
  result.seconds = {0.5, 0.25, 1.0 / 3, 0.5,
                    0.2};  // rates 2, 4, 3, 2, 5: mean 3.2, variance (1.44+0.64+0.04+1.44+3.24)/4
  EXPECT_DOUBLE_EQ(result.rate(), 150000);
  EXPECT_DOUBLE_EQ(result.mean_rate(), 250000 / (0.5 + 0.25 + 1.0 / 3 + 0.5 + 0.2));
  EXPECT_NEAR(result.spread(), std::sqrt(1.7) / 3.2, 1e-12);
  result.seconds = {0.5};
  EXPECT_EQ(result.spread(), 0);
}

TEST(Rows, AreWhatTheirNamesSay) {
  const std::vector<BenchRow> rows = bench_rows();
  EXPECT_EQ(rows.size(), 3 * 5 + 2 * 2 * 3u);
  std::set<std::string> names;
  for (const BenchRow& row : rows) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    const uint64_t size = row.name.find("_256k.") != std::string::npos ? 256000
                          : row.name.find("_2m.") != std::string::npos ? 2048000
                                                                       : 16384000;
    EXPECT_EQ(row.scene.particles(), size) << row.name;
    EXPECT_NE(row.scene.text().find(fmt::format("\ncells = [{0}, {0}, {0}]", row.scene.cells)),
              std::string::npos);
    EXPECT_TRUE(row.name.ends_with(std::string(".") + row.arithmetic));
    EXPECT_EQ(row.scene.damped, row.name.starts_with("damped_"));
    EXPECT_NE(row.scene.text().find(row.scene.damped ? "[damping]" : "[run]"), std::string::npos);
  }
  for (const char* name : {"block_256k.float", "block_16m.double", "block_2m.fixed", "damped_16m.float",
                           "damped_2m.fixed", "melt_256k.float", "melt_2m.fixed", "solid_2m.double"})
    EXPECT_TRUE(names.contains(name)) << name;
  // One size lies between its neighbours' of the same scene: a scene is made once.
  for (size_t k = 0; k < rows.size(); ++k)
    for (size_t j = k + 1; j < rows.size(); ++j)
      if (rows[j].scene == rows[k].scene) {
        EXPECT_TRUE(rows[j - 1].scene == rows[k].scene) << rows[j].name;
      }

  EXPECT_EQ(choose_rows(rows, "").size(), rows.size());
  EXPECT_EQ(choose_rows(rows, "block_2m").size(), 3u);
  EXPECT_EQ(choose_rows(rows, "melt").size(), 6u);
  EXPECT_THROW(choose_rows(rows, "block_2"), InputError);  // half a word
  EXPECT_EQ(choose_rows(rows, "melt_256k.float").size(), 1u);
  EXPECT_EQ(choose_rows(rows, "melt_256k.float")[0].name, "melt_256k.float");
}

TEST(Rows, HaveScenesThatCanBeRead) {
  for (const bool damped : {false, true}) {
    BenchBody block({BenchScene::Kind::block, 6, damped});
    EXPECT_EQ(block.scene().body.size(), 864u);
    EXPECT_EQ(block.scene().rule.damping.coefficient > 0, damped);
    EXPECT_EQ(block.setup().plan.particles, 864u);
  }
  BenchBody melt({BenchScene::Kind::melt, 6, false});
  EXPECT_NEAR(864 / melt.scene().periodic.extent.prod(), 0.8442, 1e-12);
  EXPECT_EQ(melt.setup().plan.arch.capacity, 48);
}

TEST(MeasureRow, TimesWhatItSays) {
  FakeClock clock;
  Asked asked{&clock};
  const BenchMachine machine = machine_of(asked);
  BenchBody body({BenchScene::Kind::block, 6, false});
  BenchOptions options;
  options.repeats = 3;
  options.seconds = 0.03;
  options.energy = false;
  options.engine.block = 256;
  PowerMeter power({"0000:1b:00.0"}, machine.nvml, clock);
  const auto result = measure_row(row_of(BenchScene::Kind::block, "float"), body, options, machine, power);
  ASSERT_TRUE(result);
  EXPECT_EQ(asked.arithmetic, "float");
  EXPECT_EQ(asked.options.block, 256);
  EXPECT_EQ(result->particles, 864u);
  ASSERT_EQ(result->seconds.size(), 3u);
  for (const double seconds : result->seconds) {
    EXPECT_GE(seconds, options.seconds);
    EXPECT_LT(seconds, 1.2 * options.seconds);
    EXPECT_NEAR(seconds, kStep * static_cast<double>(result->steps), 1e-9);
  }
  EXPECT_NEAR(result->rate(), 864 / kStep, 1);
  // Lists of the repeats alone.
  const double lists = static_cast<double>(result->after.list_builds - result->before.list_builds);
  EXPECT_NEAR(lists, 3 * static_cast<double>(result->steps) / 10, 1);
  EXPECT_GT(result->before.list_builds, 0u);
  // The last three are the repeats.
  ASSERT_GE(asked.advances.size(), 5u);
  for (size_t k = 0; k < 3; ++k) EXPECT_EQ(asked.advances[asked.advances.size() - 1 - k], result->steps);
  EXPECT_FALSE(result->energy);
  EXPECT_EQ(result->no_energy, "not asked for");
}

TEST(MeasureRow, AMeltMeltsFirst) {
  FakeClock clock;
  Asked asked{&clock};
  const BenchMachine machine = machine_of(asked);
  BenchBody body({BenchScene::Kind::melt, 6, false});
  BenchOptions options;
  options.repeats = 1;
  options.seconds = 0.01;
  options.energy = false;
  PowerMeter power({}, machine.nvml, clock);
  ASSERT_TRUE(measure_row(row_of(BenchScene::Kind::melt, "fixed"), body, options, machine, power));
  EXPECT_EQ(asked.arithmetic, "fixed");
  EXPECT_EQ(asked.capacity, 48);
  EXPECT_EQ(asked.advances.front(), 1000u);
  ASSERT_TRUE(measure_row(row_of(BenchScene::Kind::melt, "double"), body, options, machine, power));
  EXPECT_EQ(asked.arithmetic, "double");
  options.settle = 7;
  ASSERT_TRUE(measure_row(row_of(BenchScene::Kind::melt, "double"), body, options, machine, power));
  EXPECT_EQ(asked.advances.front(), 7u);
}

// 50 W at rest, 250 W from the first step on.
TEST(MeasureRow, MeasuresTheWorkAlone) {
  void* const library = dlopen(FAKE_NVML, RTLD_NOW);
  ASSERT_TRUE(library);
  auto& fake = *static_cast<test::FakeNvml*>(dlsym(library, "fake_nvml"));
  fake = {};
  fake.count = 1;
  test::FakeBoard& board = fake.boards[0];
  board.bus = "0000:1b:00.0";
  FakeClock clock;
  fake.time = clock.time();
  board.time[0] = clock.now() - 1;
  board.time[1] = 1e300;
  board.watts[0] = 50, board.watts[1] = 250;
  board.pieces = 2;
  Asked asked{&clock};
  const BenchMachine machine = machine_of(asked, [&](uint64_t step) {
    if (step == 1) board.time[1] = clock.now();
  });
  BenchBody body({BenchScene::Kind::block, 6, false});
  BenchOptions options;
  options.repeats = 2;
  options.seconds = 0.05;
  options.times = {.settle = 0.05, .idle = 0.3, .warm_up = 0.1, .window = 0.4};
  {
    PowerMeter power({"0000:1b:00.0"}, FAKE_NVML, clock);
    const auto result = measure_row(row_of(BenchScene::Kind::block, "float"), body, options, machine, power);
    ASSERT_TRUE(result && result->energy) << result->no_energy;
    const Energy& energy = *result->energy;
    EXPECT_NEAR(energy.idle.watts, 50, energy.idle.error);
    EXPECT_NEAR(energy.power.watts, 250, energy.power.error);
    EXPECT_LT(energy.power.error, 50);
    EXPECT_GE(energy.seconds, 0.4);
    EXPECT_LT(energy.seconds, 0.4 + 0.06);  // ends with a repeat
    // Nothing but steps in the window.
    EXPECT_NEAR(energy.seconds, kStep * static_cast<double>(energy.steps), 1e-9);
    EXPECT_EQ(energy.steps % result->steps, 0u);
    EXPECT_NEAR(energy.per_particle_step(864), 250 * kStep / 864, energy.power.error * kStep / 864);
  }
  dlclose(library);
}

BenchSetting setting_of() {
  BenchSetting setting;
  setting.devices = machine_of(*new Asked{}).devices(nullptr);
  setting.devices.pop_back();
  setting.driver = "580.1";
  setting.bandwidth = 2e12;
  return setting;
}

RowResult result_of() {
  RowResult result;
  result.particles = 256000;
  result.steps = 1000;
  result.seconds = {0.5, 0.25, 0.4};
  result.before.list_builds = 7;
  result.after.list_builds = 10;
  result.after.listed_pairs = 20.55;
  result.after.longest_list = 31;
  result.after.device_bytes = 25600000;
  result.energy.emplace();
  result.energy->method = "energy counter";
  result.energy->boards = 1;
  result.energy->seconds = 2;
  result.energy->steps = 5000;
  result.energy->power = {640, 2, 0.02};
  result.energy->idle = {128, 1, 0.02};
  result.energy->sm_clock = 1980;
  return result;
}

TEST(Report, TableIsWhatWasMeasured) {
  const BenchRow row{{}, "float", "block_256k.float", ""};
  BenchSetting setting = setting_of();
  EXPECT_EQ(
      table_head(setting),
      "# NVIDIA H100 \"80GB\", driver 580.1, 1 slab, blocks of 128 threads\n"
      "# copies in the devices' memory move 2000 GB/s, read and written\n"
      "# 1/s: particle-steps by the median of 5 repeats of 0.3 s or more; mean: of all; sd: of their rates\n"
      "# energies of whole boards over 2 s or more after 1 s of warm-up; idle: 1 s before the work, "
      "after 1 s at rest; net: less idle\n"
      "row                particles   steps        1/s       mean  sd %  lists  pairs      B  copy B         "
      "J    "
      " net J     W  idle   MHz\n");
  // 256e6 in 0.4 s; 2e12 B/s over it; rates 2, 4, 2.5: mean 2.8333, variance (0.6944+1.3611+0.1111)/2.
  EXPECT_EQ(table_line(setting, row, result_of()),
            "block_256k.float      256000    1000    6.4e+08  6.678e+08  36.7      3   20.6    100    3125   "
            "  1e-06    "
            " 8e-07   640   128  1980\n");
  RowResult without = result_of();
  without.energy.reset();
  EXPECT_EQ(table_line(setting, row, without),
            "block_256k.float      256000    1000    6.4e+08  6.678e+08  36.7      3   20.6    100    3125   "
            "      -    "
            "     -     -     -     -\n");
  setting.no_energy = "no library x";
  EXPECT_NE(table_head(setting).find("\n# no energies: no library x\nrow "), std::string::npos);
}

TEST(Report, JsonIsWhatWasMeasured) {
  const BenchRow row{{}, "float", "block_256k.float", ""};
  const BenchSetting setting = setting_of();
  EXPECT_EQ(
      json_line(setting),
      R"({"devices":[{"ordinal":0,"name":"NVIDIA H100 \"80GB\"","bus":"0000:1b:00.0","multiprocessors":132,)"
      R"("memory":85000000000}],"slabs":[0],"driver":"580.1","copy_bandwidth":2e+12,"block":128,"repeats":5,)"
      R"("least_seconds":0.3,"energy_settle":1,"energy_idle":1,"energy_warm_up":1,"energy_least_window":2})");
  EXPECT_EQ(
      json_line(setting, row, result_of()),
      R"({"row":"block_256k.float","arithmetic":"float","particles":256000,"steps":1000,"seconds":[0.5,0.25,0.4],)"
      R"("particle_steps_per_second":6.4e+08,"mean_particle_steps_per_second":6.67826e+08,"spread":0.367353,"copied_bytes":3125,"list_builds":3,)"
      R"("golden_steps":0,"listed_pairs":20.55,"longest_list":31,"halo_particles":0,)"
      R"("device_bytes":25600000,"energy_method":"energy counter","energy_board":1280,"energy_net":1024,)"
      R"("energy_error":4,"energy_window":2,"energy_power":640,"energy_idle_power":128,"energy_drift":0,)"
      R"("energy_update_period":0.02,"energy_boards":1,"energy_steps":5000,"joules_per_particle_step":1e-06,)"
      R"("joules_per_particle_step_net":8e-07,"sm_clock":1980})");
  EXPECT_EQ(json_left_out(row, "a \"b\"\nc"), R"({"row":"block_256k.float","left_out":"a \"b\"\u000ac"})");
  EXPECT_EQ(value_lines(setting, result_of()),
            "# 256000 particles on NVIDIA H100 \"80GB\", 1000 steps per repeat, median of 3 repeats of 0.4 "
            "s, standard "
            "deviation 36.7 %, 1e-06 J per particle-step, 8e-07 J above idle\n"
            "particle_steps 6.4e+08 1/s\nrepeat 0.4 s\n");
}

struct Answer {
  int code;
  std::string out, err;
};

Answer bench(std::vector<std::string> arguments, const BenchMachine& machine) {
  arguments.insert(arguments.begin(), "bench");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_bench(static_cast<int>(argv.size()), argv.data(), machine);
  std::fflush(stdout);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(Program, SaysWhatIsWrong) {
  FakeClock clock;
  Asked asked{&clock};
  BenchMachine machine = machine_of(asked);
  const auto error = [&](std::vector<std::string> arguments) {
    const Answer answer = bench(std::move(arguments), machine);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    return answer.err;
  };
  EXPECT_EQ(error({"--only", "block_256k.flaot"}),
            "no benchmark 'block_256k.flaot'\n  hint: did you mean 'block_256k.float'?\n");
  EXPECT_EQ(error({"--only", "everything"}), "no benchmark 'everything'\n  hint: --list names them\n");
  EXPECT_EQ(error({"--devices", "0,3"}),
            "--devices: there is no CUDA device 3\n  hint: there are 2, from 0\n");
  EXPECT_EQ(error({"--block", "100"}), "--block 100: not a multiple of 32 from 32 to 256\n");
  EXPECT_EQ(error({"--block", "512"}), "--block 512: not a multiple of 32 from 32 to 256\n");
  EXPECT_EQ(error({"--only", "block_256k", "--json", "/nowhere/x"}),
            "cannot write /nowhere/x: No such file or directory\n");
  EXPECT_NE(error({"--repeats", "0"}).find("--repeats"), std::string::npos);
  machine.devices = [](std::string* why) {
    *why = "no driver";
    return std::vector<Device>{};
  };
  EXPECT_EQ(error({}), "no GPU: no driver\n");
  EXPECT_TRUE(asked.arithmetic.empty());  // nothing was run
  const Answer list = bench({"--list"}, machine);
  EXPECT_EQ(list.code, 0);
  EXPECT_NE(list.out.find("\nmelt_2m.fixed      Lennard-Jones melt, 2048000 particles, fixed\n"),
            std::string::npos)
      << list.out;
}

TEST(Program, TellsTheMachine) {
  FakeClock clock;
  Asked asked{&clock};
  const Scratch scratch;
  const std::string path = scratch.path("machine");
  BenchMachine machine = machine_of(asked);
  EXPECT_EQ(bench({"--machine", path}, machine).code, 0);
  EXPECT_TRUE(read_text(path).starts_with(R"({"devices":[{"ordinal":0,)")) << read_text(path);
  machine.devices = [](std::string* why) {
    *why = "no driver";
    return std::vector<Device>{};
  };
  EXPECT_EQ(bench({"--machine", path}, machine).code, 0);
  EXPECT_EQ(read_text(path), "none: no driver\n");
}

int lines_of(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

TEST(Program, LeavesALineForEachRow) {
  FakeClock clock;
  Asked asked{&clock};
  const Scratch scratch;
  BenchMachine machine = machine_of(asked);
  const std::string json = scratch.path("json"), lines = scratch.path("lines");
  const Answer answer = bench({"--only", "damped_256k", "--quick", "--repeats", "2", "--seconds", "0.01",
                               "--devices", "0,1,0", "--json", json, "--lines", lines},
                              machine);
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(asked.arithmetic, "fixed");
  EXPECT_TRUE(asked.damps);
  EXPECT_EQ(asked.options.devices, (std::vector<int>{0, 1, 0}));
  EXPECT_TRUE(
      answer.out.starts_with("# 2 x NVIDIA H100 \"80GB\", 3 slabs, blocks of 128 threads\n"
                             "# copies in the devices' memory move 3000 GB/s, read and written\n"))
      << answer.out;
  EXPECT_NE(answer.out.find("\n# no energies: not asked for\n"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("\ndamped_256k.float "), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("\ndamped_256k.fixed "), std::string::npos) << answer.out;
  EXPECT_EQ(lines_of(read_text(json)), 3) << read_text(json);
  EXPECT_EQ(lines_of(read_text(lines)), 6) << read_text(lines);
}

TEST(Program, GoesOnAfterARowThatFails) {
  FakeClock clock;
  Asked asked{&clock};
  const Scratch scratch;
  BenchMachine machine = machine_of(asked);
  const auto real = machine.real;
  machine.real = [&](const Scene& scene, const Body& body, Arithmetic arithmetic, const Options& options) {
    if (arithmetic == Arithmetic::float32) throw std::runtime_error("CUDA says no");
    throw InputError("needs 90 GB of 80 GB");
    return real(scene, body, arithmetic, options);
  };
  const std::string json = scratch.path("json");
  const std::vector<std::string> arguments{"--only",    "solid_256k", "--quick", "--repeats", "1",
                                           "--seconds", "0.01",       "--json",  json};
  const Answer answer = bench(arguments, machine);
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find(
                "\n# solid_256k.float: failed: CUDA says no\n# solid_256k.double: skipped: needs 90 GB of "
                "80 GB\nsolid_256k.fixed "),
            std::string::npos)
      << answer.out;
  EXPECT_NE(read_text(json).find("\n{\"row\":\"solid_256k.double\",\"left_out\":\"needs 90 GB of 80 GB\"}\n"),
            std::string::npos);
  // One that does not fit is no failure.
  EXPECT_EQ(bench({"--only", "solid_256k.double", "--quick"}, machine).code, 0);
}

TEST(ProgramDeathTest, KeepsWhatItFoundWhenInterrupted) {
  const Scratch scratch;
  const std::string json = scratch.path("json");
  const auto interrupted_run = [&] {
    FakeClock clock;
    Asked asked{&clock};
    uint64_t fixed_steps = 0;
    const BenchMachine machine = machine_of(asked, [&](uint64_t) {
      if (asked.arithmetic == "fixed" && ++fixed_steps == 3) std::raise(SIGINT);
    });
    std::vector<std::string> arguments{"bench",     "--only", "damped_256k", "--quick",
                                       "--seconds", "0.01",   "--json",      json};
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    std::exit(run_bench(static_cast<int>(argv.size()), argv.data(), machine));
  };
  EXPECT_EXIT(interrupted_run(), testing::ExitedWithCode(1), "");
  EXPECT_EQ(lines_of(read_text(json)), 2) << read_text(json);
  EXPECT_NE(read_text(json).find("{\"row\":\"damped_256k.float\","), std::string::npos);
}

}  // namespace
}  // namespace cuboct::gpu
