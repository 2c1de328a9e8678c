// SPDX-License-Identifier: MIT
#include "emu/gpu/bench/power.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <set>

#include "model/base/interrupt.h"

namespace cuboct::gpu {
namespace {

// A steady stretch of time is asked for each 2 ms at first and then ever more rarely, so that the times of
// two updates stay a fixed share of it: 2 * 1/1000. An hour's watch keeps some ten thousand updates.
constexpr double kShortest = 2e-3, kLongest = 0.1, kShare = 1e-3;  // s, s, of the time watched
constexpr double kSamplePeriod = 0.1;  // s: a power that does not change is kept so often
constexpr double kClockPeriod = 0.05;  // s

// The updates that came inside a window whatever their exact time.
std::vector<Update> inside(const std::vector<Update>& updates, double begin, double end) {
  std::vector<Update> found;
  for (const Update& update : updates)
    if (update.earliest >= begin && update.latest <= end) found.push_back(update);
  return found;
}

double middle(const Update& update) { return 0.5 * (update.earliest + update.latest); }
double half_width(const Update& update) { return 0.5 * (update.latest - update.earliest); }

double period_of(const std::vector<Update>& found) {
  return (middle(found.back()) - middle(found.front())) / static_cast<double>(found.size() - 1);
}

}  // namespace

std::optional<MeanPower> mean_of_counter(const std::vector<Update>& updates, double begin, double end) {
  const std::vector<Update> found = inside(updates, begin, end);
  for (size_t k = 1; k < found.size(); ++k)
    if (found[k].value < found[k - 1].value)
      throw NvmlError("the energy counter ran backwards: was the driver loaded anew?");
  if (found.size() < 3) return std::nullopt;
  const Update &first = found.front(), &last = found.back();
  const double seconds = middle(last) - middle(first);
  const double joules = 1e-3 * static_cast<double>(last.value - first.value);
  const double doubt = half_width(first) + half_width(last);  // s
  MeanPower mean;
  mean.watts = joules / seconds;
  // The largest that the true (joules + 0.001) / (seconds - doubt) can differ.
  mean.error = doubt < seconds ? (joules + 1e-3) / (seconds - doubt) - mean.watts : mean.watts;
  mean.period = period_of(found);
  return mean;
}

std::optional<MeanPower> mean_of_samples(const std::vector<Update>& updates, double begin, double end) {
  const std::vector<Update> found = inside(updates, begin, end);
  if (found.size() < 3) return std::nullopt;
  const double seconds = middle(found.back()) - middle(found.front());
  double area = 0;  // mW s
  for (size_t k = 1; k < found.size(); ++k)
    area += 0.5 * static_cast<double>(found[k].value + found[k - 1].value) *
            (middle(found[k]) - middle(found[k - 1]));
  const auto [least, most] = std::minmax_element(
      found.begin(), found.end(), [](const Update& a, const Update& b) { return a.value < b.value; });
  MeanPower mean;
  mean.watts = 1e-3 * area / seconds;
  mean.period = period_of(found);
  mean.error = 0.5e-3 + 1e-3 * static_cast<double>(most->value - least->value) *
                            std::min(1.0, 2 * mean.period / seconds);
  return mean;
}

struct PowerMeter::Impl {
  struct Board {
    Nvml::Board handle = nullptr;
    std::string bus;
    bool counter = false;
    double asked = 0;  // s: when the latest value was asked for
    std::vector<Update> updates;
  };
  struct Clock {
    double time = 0, mhz = 0;  // s
  };

  explicit Impl(MeterClock& clock) : clock(clock) {}
  double now() const { return clock.now(); }

  MeterClock& clock;
  std::unique_ptr<Nvml> nvml;
  std::string why, driver;
  std::vector<Board> boards;

  double begin = 0, next_clock = 0;  // s: of the watch, of the next look at clocks
  mutable std::mutex mutex;          // of what follows, and of the boards' updates
  std::string failure;
  std::vector<Clock> clocks;
  std::unique_ptr<MeterClock::Watch> watch;  // last: it goes before what it looks at

  void ask(Board& board) {
    const double from = now();
    const std::optional<uint64_t> value =
        board.counter ? nvml->energy(board.handle) : std::optional<uint64_t>(nvml->power(board.handle));
    const double until = now();
    if (!value)
      throw NvmlError(
          fmt::format("NVML gave no more {} of {}", board.counter ? "energy" : "power", board.bus));
    const std::lock_guard lock(mutex);
    const bool first = board.updates.empty();
    // A first counter's reading is no update: when it came is not known.
    const bool keep = board.counter ? first || value != board.updates.back().value
                                    : first || value != board.updates.back().value ||
                                          until - board.updates.back().latest > kSamplePeriod;
    if (keep) {
      const double earliest = board.counter ? (first ? 0.0 : board.asked) : from;
      board.updates.push_back({earliest, until, *value});
    }
    board.asked = from;
  }

  void ask_clocks() {
    double sum = 0;
    int count = 0;
    for (const Board& board : boards)
      if (const auto mhz = nvml->sm_clock(board.handle)) sum += *mhz, ++count;
    const std::lock_guard lock(mutex);
    if (count > 0) clocks.push_back({now(), sum / count});
  }

  // Returns the time to the next look.
  double look() {
    try {
      for (Board& board : boards) ask(board);
      const double interval = std::clamp(kShare * (now() - begin), kShortest, kLongest);
      if (now() >= next_clock) {
        ask_clocks();
        next_clock = now() + std::max(kClockPeriod, 10 * interval);
      }
      return interval;
    } catch (const NvmlError& e) {
      const std::lock_guard lock(mutex);
      failure = e.what();
      return -1;
    }
  }
};

PowerMeter::PowerMeter(const std::vector<std::string>& buses, const std::string& library, MeterClock& clock)
    : impl_(std::make_unique<Impl>(clock)) {
  try {
    if (buses.empty()) throw NvmlError("no GPU");
    impl_->nvml = std::make_unique<Nvml>(library);
    const Nvml& nvml = *impl_->nvml;
    impl_->driver = nvml.driver();
    std::set<std::string> seen;
    for (const std::string& bus : buses) {
      if (!seen.insert(bus).second) continue;
      Impl::Board board;
      board.handle = nvml.board(bus);
      board.bus = bus;
      board.counter = nvml.energy(board.handle).has_value();
      if (!board.counter && !nvml.power(board.handle))
        throw NvmlError(
            fmt::format("{} at PCI bus {} tells neither energy nor power", nvml.name(board.handle), bus));
      impl_->boards.push_back(board);
    }
  } catch (const NvmlError& e) {
    impl_->why = e.what();
    impl_->boards.clear();
  }
}

PowerMeter::~PowerMeter() { stop(); }

bool PowerMeter::works() const { return impl_->why.empty(); }
const std::string& PowerMeter::why() const { return impl_->why; }
const std::string& PowerMeter::driver() const { return impl_->driver; }
int PowerMeter::boards() const { return static_cast<int>(impl_->boards.size()); }

const char* PowerMeter::method() const {
  const auto counting = std::count_if(impl_->boards.begin(), impl_->boards.end(),
                                      [](const Impl::Board& board) { return board.counter; });
  return counting == boards() ? "energy counter" : counting == 0 ? "power samples" : "mixed";
}

MeterClock& PowerMeter::clock() const { return impl_->clock; }

void PowerMeter::start() {
  stop();
  impl_->failure.clear();
  impl_->clocks.clear();
  for (Impl::Board& board : impl_->boards) board.updates.clear();
  impl_->begin = impl_->next_clock = impl_->now();
  if (works()) impl_->watch = impl_->clock.watch([impl = impl_.get()] { return impl->look(); });
}

void PowerMeter::stop() { impl_->watch.reset(); }

PowerMeter::Window PowerMeter::between(double begin, double end) const {
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->failure.empty()) throw NvmlError(impl_->failure);
  Window window;
  double halves[2] = {};
  bool has_halves = true;
  for (const Impl::Board& board : impl_->boards) {
    const auto mean = [&](double from, double to) {
      return board.counter ? mean_of_counter(board.updates, from, to)
                           : mean_of_samples(board.updates, from, to);
    };
    const auto whole = mean(begin, end);
    if (!whole)
      throw NvmlError(fmt::format("the board at PCI bus {} told its {} less than three times in {:.3g} s",
                                  board.bus, board.counter ? "energy" : "power", end - begin));
    window.power.watts += whole->watts;
    window.power.error += whole->error;
    window.power.period = std::max(window.power.period, whole->period);
    const double half = 0.5 * (begin + end);
    const auto early = mean(begin, half), late = mean(half, end);
    has_halves = has_halves && early && late;
    if (!has_halves) continue;
    halves[0] += early->watts;
    halves[1] += late->watts;
  }
  if (has_halves && halves[0] > 0) window.drift = halves[1] / halves[0] - 1;
  double sum = 0;
  int count = 0;
  for (const Impl::Clock& clock : impl_->clocks)
    if (clock.time >= begin && clock.time <= end) sum += clock.mhz, ++count;
  if (count > 0) window.sm_clock = sum / count;
  return window;
}

double Energy::per_particle_step(uint64_t particles) const {
  return joules() / (static_cast<double>(steps) * static_cast<double>(particles));
}

double Energy::net_per_particle_step(uint64_t particles) const {
  return net_joules() / (static_cast<double>(steps) * static_cast<double>(particles));
}

std::vector<std::pair<std::string, double>> Energy::counters(uint64_t particles) const {
  std::vector<std::pair<std::string, double>> list{
      {"energy_board", joules()},
      {"energy_net", net_joules()},
      {"energy_error", power.error * seconds},
      {"energy_window", seconds},
      {"energy_power", power.watts},
      {"energy_idle_power", idle.watts},
      {"energy_drift", drift},
      {"energy_update_period", power.period},
      {"energy_boards", boards},
      {"energy_steps", static_cast<double>(steps)},
      {"joules_per_particle_step", per_particle_step(particles)},
      {"joules_per_particle_step_net", net_per_particle_step(particles)}};
  if (sm_clock > 0) list.emplace_back("sm_clock", sm_clock);
  return list;
}

void EnergyMeter::idle() {
  if (!power_.works()) return;
  power_.start();
  MeterClock& clock = power_.clock();
  const auto wait = [&clock](double seconds) {
    const double end = clock.now() + seconds;
    for (double left = seconds; left > 0 && !interrupted(); left = end - clock.now())
      clock.sleep(std::min(0.05, left));
  };
  wait(times_.settle);
  idle_begin_ = clock.now();
  wait(times_.idle);
  idle_end_ = clock.now();
}

void EnergyMeter::did(uint64_t steps) {
  if (!power_.works()) return;
  const double now = power_.clock().now();
  if (begin_ >= 0) {
    steps_ += steps;
    end_ = now;
  } else if (now - idle_end_ >= times_.warm_up) {
    begin_ = end_ = now;
  }
}

bool EnergyMeter::enough() const { return begin_ >= 0 && end_ - begin_ >= times_.window; }

std::optional<Energy> EnergyMeter::finish(std::string* why) {
  const auto none = [&](const std::string& text) {
    if (why) *why = text;
    power_.stop();
    return std::nullopt;
  };
  if (!power_.works()) return none(power_.why());
  if (idle_end_ < 0) return none("the idle power was not measured");
  if (!enough())
    return none(
        fmt::format("the steps took {:.3g} s after a warm-up of {:.3g} s; a measurement needs {:.3g} s",
                    begin_ < 0 ? 0.0 : end_ - begin_, times_.warm_up, times_.window));
  try {
    const PowerMeter::Window idle = power_.between(idle_begin_, idle_end_),
                             work = power_.between(begin_, end_);
    power_.stop();
    Energy energy;
    energy.method = power_.method();
    energy.boards = power_.boards();
    energy.seconds = end_ - begin_;
    energy.steps = steps_;
    energy.power = work.power;
    energy.idle = idle.power;
    energy.drift = work.drift;
    energy.sm_clock = work.sm_clock;
    return energy;
  } catch (const NvmlError& e) {
    return none(e.what());
  }
}

}  // namespace cuboct::gpu
