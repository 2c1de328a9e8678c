// SPDX-License-Identifier: MIT
// Energies against made-up boards whose power is known.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <memory>

#include "emu/gpu/bench/power.h"
#include "tests/gpu/fake_clock.h"
#include "tests/gpu/fake_nvml.h"
#include "tests/support/refused_with.h"

namespace cuboct::gpu {
namespace {

using test::FakeBoard;
using test::FakeNvml;

// A counter of `watts` that moves each `period` s from `start` on, asked for each `asked` s; readings are cut
// to mJ.
std::vector<Update> counted(double watts, double period, double asked, double start, double end) {
  std::vector<Update> updates;
  uint64_t latest = 0;
  for (int k = 0; k * asked < end; ++k) {
    const double t = k * asked;
    const auto value = static_cast<uint64_t>(7e12 + 1e3 * watts * std::floor((t - start) / period) * period);
    if (k > 0 && value != latest) updates.push_back({t - asked, t, value});
    latest = value;
  }
  return updates;
}

TEST(MeanOfCounter, IsThePowerWithinItsError) {
  for (const double period : {0.1, 0.02, 0.0013})
    for (const double start : {-0.013, -0.0008, -0.0191}) {
      const auto updates = counted(317.5, period, 0.002, start, 3);
      const auto mean = mean_of_counter(updates, 0.75, 2.75);
      ASSERT_TRUE(mean);
      EXPECT_NEAR(mean->watts, 317.5, mean->error) << period << " " << start;
      // Two askings of 2 ms, half of each, in at least 2 s less two periods; 1 mJ in 500 J.
      EXPECT_LT(mean->error, 317.5 * 0.0021 / (2 - 2 * period));
      EXPECT_GT(mean->error, 317.5 * 0.0019 / 2);
      EXPECT_NEAR(mean->period, std::max(period, 0.002), 2e-3 * period + 1e-3);
    }
}

// The counter's difference over the window itself would be off by the last step: 100 ms of 450 ms.
TEST(MeanOfCounter, DoesNotHangOnTheWindowsEnds) {
  const auto updates = counted(200, 0.1, 0.001, -0.05, 2);
  for (double end = 1.40; end < 1.55; end += 0.01) {
    const auto mean = mean_of_counter(updates, 1.0, end);
    ASSERT_TRUE(mean);
    EXPECT_NEAR(mean->watts, 200, 1.5) << end;
  }
}

TEST(MeanOfCounter, WorkBeforeTheWindowDoesNotCount) {
  std::vector<Update> updates = counted(100, 0.02, 0.001, 0, 1);
  const uint64_t sum = updates.back().value;
  for (Update update : counted(400, 0.02, 0.001, 0, 1)) {
    update.value = update.value - static_cast<uint64_t>(7e12) + sum;
    update.earliest += 1, update.latest += 1;
    updates.push_back(update);
  }
  EXPECT_NEAR(mean_of_counter(updates, 0.1, 0.99)->watts, 100, 0.5);
  EXPECT_NEAR(mean_of_counter(updates, 1.03, 2)->watts, 400, 2);
  EXPECT_NEAR(mean_of_counter(updates, 0, 2)->watts, 250, 6);
}

TEST(MeanOfCounter, NeedsThreeUpdates) {
  const auto updates = counted(100, 0.1, 0.001, -0.0495, 1);  // at 0.0505, 0.1505, 0.2505, ...
  EXPECT_FALSE(mean_of_counter(updates, 0.06, 0.26));
  EXPECT_TRUE(mean_of_counter(updates, 0.0499, 0.2511));
  EXPECT_FALSE(mean_of_counter(updates, 0.0503, 0.2511));  // the first of the three may have come before,
  EXPECT_FALSE(mean_of_counter(updates, 0.0499, 0.2508));  // the last after the window
}

TEST(MeanOfCounter, RefusesOneThatRunsBackwards) {
  std::vector<Update> updates = counted(100, 0.02, 0.001, 0, 1);
  updates[20].value = 5;
  EXPECT_EQ(refused_with<NvmlError>([&] { mean_of_counter(updates, 0, 1); }),
            "the energy counter ran backwards: was the driver loaded anew?");
  EXPECT_TRUE(mean_of_counter(updates, 0.6, 1));
}

// 100 W + 50 W/s: trapezoids are exact.
TEST(MeanOfSamples, IntegratesARamp) {
  std::vector<Update> updates;
  for (int k = 0; k <= 100; ++k)
    updates.push_back({0.01 * k, 0.01 * k, static_cast<uint64_t>(100000 + 500 * k)});
  const auto mean = mean_of_samples(updates, 0.2, 0.6001);
  ASSERT_TRUE(mean);
  EXPECT_NEAR(mean->watts, 120, 1e-6);
  EXPECT_NEAR(mean->period, 0.01, 1e-9);
  EXPECT_NEAR(mean->error, 0.0005 + 20 * 2 * 0.01 / 0.4, 1e-6);  // 20 W between least and most
  // Unequal distances: the same area with each second reading of the first half gone.
  std::vector<Update> uneven;
  for (size_t k = 0; k < updates.size(); ++k)
    if (k > 50 || k % 2 == 0) uneven.push_back(updates[k]);
  EXPECT_NEAR(mean_of_samples(uneven, 0.2, 0.6001)->watts, 120, 1e-6);
}

constexpr char kBus[] = "0000:1b:00.0";
constexpr EnergyTimes kQuick{.settle = 0.05, .idle = 0.3, .warm_up = 0.1, .window = 0.4};

class Power : public ::testing::Test {
 protected:
  Power() : library_(dlopen(FAKE_NVML, RTLD_NOW)) {
    EXPECT_TRUE(library_) << dlerror();
    fake_ = static_cast<FakeNvml*>(dlsym(library_, "fake_nvml"));
    *fake_ = FakeNvml{};
    fake_->time = clock_.time();
  }
  ~Power() override {
    EXPECT_EQ(fake_->sessions, 0);
    dlclose(library_);
  }

  // 60 W from now on, `watts` once `works` was called.
  FakeBoard& board(const char* bus, double watts) {
    FakeBoard& board = fake_->boards[fake_->count++];
    board.bus = bus;
    board.time[0] = clock_.now() - 0.0071;
    board.watts[0] = 60;
    board.time[1] = 1e300;
    board.watts[1] = watts;
    board.pieces = 2;
    board.counted = 123456789012345;
    board.clock = 1755;
    return board;
  }
  void works(FakeBoard& board) const { board.time[1] = *clock_.time(); }

  // The work of a run that begins with `begins`: batches of 10 steps in 5 ms.
  std::optional<Energy> measure(PowerMeter& power, double seconds, std::string* why,
                                const std::function<void()>& begins) {
    EnergyMeter meter(power, kQuick);
    meter.idle();
    begins();
    for (const double end = clock_.now() + seconds; clock_.now() < end;) {
      clock_.pass(5e-3);
      meter.did(10);
    }
    return meter.finish(why);
  }

  FakeClock clock_;
  void* library_;
  FakeNvml* fake_;
};

TEST_F(Power, TellsIdleAndWorkApart) {
  FakeBoard& only = board(kBus, 400);
  PowerMeter power({kBus}, FAKE_NVML, clock_);
  ASSERT_TRUE(power.works()) << power.why();
  EXPECT_EQ(power.driver(), "123.45.06");
  std::string why;
  const auto energy = measure(power, 0.7, &why, [&] { works(only); });
  ASSERT_TRUE(energy) << why;
  EXPECT_EQ(energy->method, "energy counter");
  EXPECT_EQ(energy->boards, 1);
  EXPECT_NEAR(energy->idle.watts, 60, energy->idle.error);
  EXPECT_NEAR(energy->power.watts, 400, energy->power.error);
  EXPECT_LT(energy->power.error, 40);
  EXPECT_GE(energy->power.period, 0.018);
  EXPECT_NEAR(energy->drift, 0, 0.2);
  EXPECT_EQ(energy->sm_clock, 1755);
  EXPECT_GE(energy->seconds, 0.4);
  EXPECT_GT(energy->steps, 0u);
  EXPECT_EQ(energy->steps % 10, 0u);
  EXPECT_LE(static_cast<double>(energy->steps), 10 * energy->seconds / 0.005 + 10);
  EXPECT_DOUBLE_EQ(energy->joules(), energy->power.watts * energy->seconds);
  EXPECT_NEAR(energy->net_joules() / energy->seconds, 340, energy->power.error + energy->idle.error);
}

TEST_F(Power, AddsUpBoardsOnce) {
  board(kBus, 400);
  board("0000:2c:00.0", 400).watts[0] = 100;
  fake_->boards[1].period = 0.05;
  PowerMeter power({kBus, "0000:2c:00.0", kBus}, FAKE_NVML, clock_);
  ASSERT_TRUE(power.works()) << power.why();
  EXPECT_EQ(power.boards(), 2);
  power.start();
  const double begin = clock_.now();
  clock_.pass(0.5);
  const auto window = power.between(begin, clock_.now());
  EXPECT_NEAR(window.power.watts, 160, window.power.error);
  EXPECT_LT(window.power.error, 16);
  EXPECT_GE(window.power.period, 0.045);  // the longest
}

TEST_F(Power, IntegratesSamplesWithoutACounter) {
  FakeBoard& only = board(kBus, 400);
  only.energy = false;
  PowerMeter power({kBus}, FAKE_NVML, clock_);
  ASSERT_TRUE(power.works()) << power.why();
  EXPECT_STREQ(power.method(), "power samples");
  std::string why;
  const auto energy = measure(power, 0.7, &why, [&] { works(only); });
  ASSERT_TRUE(energy) << why;
  EXPECT_NEAR(energy->power.watts, 400, 0.001);  // steady: but for its millijoules
  EXPECT_NEAR(energy->idle.watts, 60, 0.001 + energy->idle.error);
  EXPECT_EQ(energy->method, "power samples");
}

TEST_F(Power, SaysWhatIsMissing) {
  PowerMeter nowhere({kBus}, "/nowhere/libnvidia-ml.so.1");
  EXPECT_FALSE(nowhere.works());
  EXPECT_EQ(nowhere.why(), "no library /nowhere/libnvidia-ml.so.1");
  std::string why;
  EnergyMeter meter(nowhere);
  meter.idle();
  meter.did(10);
  EXPECT_FALSE(meter.enough());
  EXPECT_FALSE(meter.finish(&why));
  EXPECT_EQ(why, nowhere.why());

  EXPECT_EQ(PowerMeter({kBus}, "libdl.so.2").why(), "NVML has no function nvmlInit_v2");
  EXPECT_EQ(PowerMeter({}, FAKE_NVML).why(), "no GPU");
  EXPECT_EQ(PowerMeter({kBus}, FAKE_NVML).why(), "NVML gives no board at PCI bus 0000:1b:00.0: Not Found");
  fake_->init = 9;
  EXPECT_EQ(PowerMeter({kBus}, FAKE_NVML).why(), "NVML does not start: Driver Not Loaded");
  fake_->init = 0;
  FakeBoard& dumb = board(kBus, 400);
  dumb.energy = dumb.power = false;
  EXPECT_EQ(PowerMeter({kBus}, FAKE_NVML).why(),
            "Fake H100 at PCI bus 0000:1b:00.0 tells neither energy nor power");
}

TEST_F(Power, SaysWhyARunHasNoEnergy) {
  FakeBoard& only = board(kBus, 400);
  PowerMeter power({kBus}, FAKE_NVML, clock_);
  std::string why;
  EXPECT_FALSE(measure(power, 0.05, &why, [] {}));
  EXPECT_EQ(why, "the steps took 0 s after a warm-up of 0.1 s; a measurement needs 0.4 s");

  EnergyMeter no_idle(power, kQuick);
  no_idle.did(10);
  EXPECT_FALSE(no_idle.finish(&why));
  EXPECT_EQ(why, "the idle power was not measured");

  only.period = 5;
  EXPECT_FALSE(measure(power, 0.6, &why, [] {}));
  EXPECT_EQ(why, "the board at PCI bus 0000:1b:00.0 told its energy less than three times in 0.3 s");
  only.period = 0.02;
  EXPECT_FALSE(measure(power, 0.7, &why, [&] { only.loaded_anew = clock_.now() + 0.4; }));
  EXPECT_EQ(why, "the energy counter ran backwards: was the driver loaded anew?");
  only.loaded_anew = 1e300;
  EXPECT_FALSE(measure(power, 0.7, &why, [&] { only.lost = clock_.now() + 0.1; }));
  EXPECT_EQ(why, "NVML gives no energy: GPU is lost");
}

// The clock of the programs, whose pace is the machine's own.
TEST(SteadyClock, LooksFromAThreadUntilItIsLetGo) {
  MeterClock& clock = steady_clock();
  const double begin = clock.now();
  std::atomic<int> looks = 0;
  std::unique_ptr<MeterClock::Watch> watch = clock.watch([&] { return ++looks, 1e-4; });
  while (looks < 5) clock.sleep(1e-3);
  watch.reset();
  const int seen = looks;
  clock.sleep(5e-3);
  EXPECT_EQ(looks, seen);
  EXPECT_GE(clock.now() - begin, 6e-3);
  watch = clock.watch([&] { return ++looks, -1.0; });  // once, and no more
  while (looks == seen) clock.sleep(1e-3);
  watch.reset();
  EXPECT_EQ(looks, seen + 1);
  watch = clock.watch([&] { return ++looks, 3600.0; });
  while (looks == seen + 1) clock.sleep(1e-3);
  watch.reset();  // does not wait for an hour
}

TEST(Energy, IsSharedByParticleSteps) {
  Energy energy;
  energy.boards = 1;
  energy.seconds = 2;
  energy.steps = 1000;
  energy.power = {500, 1.5, 0.02};
  energy.idle = {100, 0.5, 0.02};
  energy.drift = 0.01;
  const std::vector<std::pair<std::string, double>> expected{{"energy_board", 1000},
                                                             {"energy_net", 800},
                                                             {"energy_error", 3},
                                                             {"energy_window", 2},
                                                             {"energy_power", 500},
                                                             {"energy_idle_power", 100},
                                                             {"energy_drift", 0.01},
                                                             {"energy_update_period", 0.02},
                                                             {"energy_boards", 1},
                                                             {"energy_steps", 1000},
                                                             {"joules_per_particle_step", 1e-6},
                                                             {"joules_per_particle_step_net", 8e-7}};
  EXPECT_EQ(energy.counters(1000000), expected);
  energy.sm_clock = 1980;
  EXPECT_EQ(energy.counters(1000000).back(), (std::pair<std::string, double>{"sm_clock", 1980}));
}

}  // namespace
}  // namespace cuboct::gpu
