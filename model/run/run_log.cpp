// SPDX-License-Identifier: MIT
#include "model/run/run_log.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
namespace cuboct {
namespace {

constexpr uint64_t kParts = 20, kTenths = 10;
// Step, time, steps/s, time left: before the curves. Static loading has no speed by its time steps, and
// counts its load steps.
constexpr const char* kFixed = "{:>9} {:>10} {:>8} {:>8}";
constexpr size_t kFixedWidth = 38;

double between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

// At least two seconds, and of a long run a fiftieth of its age: some 50 rows per factor e of its length.
double interval(double age) { return std::max(2.0, age / 50); }

std::string clock_text(double seconds) {
  const auto s = static_cast<uint64_t>(seconds);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

// Characters per line; 0: no limit.
size_t line_width() {
  winsize size{};
  return isatty(STDERR_FILENO) && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

// The curves' order in the table: what a narrow terminal has no room for comes last.
int rank_of(const Curve& curve) {
  if (curve.name == "energy.kinetic" || curve.name == "energy.potential" || curve.name == "temperature")
    return 0;
  return curve.name.starts_with("energy.") || curve.name == "pressure" ? 2 : 1;
}

// Of each part the first sample, else its first step. With static loading the first load step: between two of
// them nothing changes.
std::vector<uint64_t> row_steps(uint64_t steps, const std::vector<uint64_t>& samples, uint64_t load) {
  const auto begin_of = [steps](uint64_t part) {
    return steps / kParts * part + steps % kParts * part / kParts;
  };
  std::vector<uint64_t> rows;
  for (uint64_t part = 0; part <= kParts; ++part) {
    if (load > 0) {
      rows.push_back((begin_of(part) + load - 1) / load * load);
      continue;
    }
    const auto sample = std::ranges::lower_bound(samples, begin_of(part));
    rows.push_back(sample != samples.end() && *sample < begin_of(part + 1) ? *sample : begin_of(part));
  }
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace

const char* to_string(LogRows rows) {
  constexpr std::array kNames{"off", "quiet", "seconds", "parts"};
  return kNames.at(static_cast<size_t>(rows));
}

RunLog::RunLog(Run run, const Scene& scene, const std::vector<Curve>& curves)
    : run_(std::move(run)),
      dt_(scene.rule.dt),
      load_(scene.loading ? scene.loading->every : 0),
      progress_(load_ > 0 ? run_.engine + ", loading" : run_.engine,
                load_ > 0 ? run_.steps / load_ : run_.steps, run_.particles, run_.rows != LogRows::quiet) {
  if (run_.rows == LogRows::parts) rows_ = row_steps(run_.steps, run_.samples, load_);
  if (!has_rows(run_.rows)) return;
  const bool falls = std::ranges::any_of(scene.rule.types, [](auto& type) { return !type.gravity.isZero(); });
  const size_t most = line_width();
  size_t width = kFixedWidth;
  for (const int rank : {0, 1, 2})
    for (size_t k = 0; k < curves.size(); ++k) {
      const Curve& curve = curves[k];
      if (rank_of(curve) != rank) continue;
      if (curve.name == "energy.gravity" && !falls) continue;
      Column column{curve.name, curve.unit, k, 0};
      if (column.name.starts_with("energy.")) column.name.erase(0, 7);
      column.width = std::max<size_t>(column.name.size() + 1, 11);
      width += column.width;
      // The last characters say how many there are besides.
      if (most > 0 && width + 5 > most)
        ++dropped_;
      else
        columns_.push_back(std::move(column));
    }
}

void RunLog::begin(uint64_t step) {
  first_ = shown_ = step;
  begin_ = last_ = Clock::now();
  progress_.begin(load_ > 0 ? step / load_ : step);
}

uint64_t RunLog::next_row(uint64_t step) const {
  const auto row = std::upper_bound(rows_.begin(), rows_.end(), step);
  return row == rows_.end() ? run_.steps : *row;
}

// Whether the next sample comes soon enough for a row to wait for it.
bool RunLog::waits(uint64_t step, Clock::time_point now) const {
  const auto sample = std::upper_bound(run_.samples.begin(), run_.samples.end(), step);
  if (sample == run_.samples.end() || step == first_) return false;
  const double per_step = between(begin_, now) / static_cast<double>(step - first_);
  return static_cast<double>(*sample - step) * per_step < interval(between(begin_, now));
}

bool RunLog::is_due(uint64_t step, bool sampled) const {
  if (run_.rows == LogRows::parts) return !any_ || next_row(shown_) <= step;
  if (run_.rows != LogRows::seconds) return false;
  if (!any_) return true;
  if (load_ > 0 && step % load_ != 0) return false;
  const auto now = Clock::now();
  const bool due = between(last_, now) >= interval(between(begin_, now)) ||
                   step - shown_ >= std::max<uint64_t>(run_.steps / kTenths, 1);
  return due && (sampled || !waits(step, now));
}

void RunLog::at(uint64_t step, bool sampled, const Latest& latest) {
  if (is_due(step, sampled)) row(step, sampled, latest);
  progress_.at(load_ > 0 ? step / load_ : step);
}

void RunLog::end(uint64_t step, bool sampled, const Latest& latest) {
  if (has_rows(run_.rows) && (!any_ || shown_ != step)) row(step, sampled, latest);
  progress_.wipe();
}

void RunLog::head() {
  std::string names =
                  fmt::format(fmt::runtime(kFixed), "step", "time", load_ > 0 ? "loads" : "steps/s", "left"),
              units = fmt::format(fmt::runtime(kFixed), "", "s", "", "h:m:s");
  for (const Column& column : columns_) {
    names += fmt::format("{:>{}}", column.name, column.width);
    units += fmt::format("{:>{}}", column.unit, column.width);
  }
  if (dropped_ > 0) names += " ...", units += fmt::format(" +{}", dropped_);
  fmt::print(stderr, "{}\n{}\n", names, units);
}

void RunLog::row(uint64_t step, bool sampled, const Latest& latest) {
  progress_.wipe();
  if (!any_) head();
  const auto now = Clock::now();
  const double age = between(begin_, now), since = between(last_, now);
  const bool moved = step > shown_ && since > 0;
  const double left =
      moved ? age / static_cast<double>(step - first_) * static_cast<double>(run_.steps - step) : 0;
  std::string text =
      fmt::format(fmt::runtime(kFixed), step, fmt::format("{:.4g}", static_cast<double>(step) * dt_),
                  load_ > 0 ? fmt::format("{}/{}", step / load_, run_.steps / load_)
                  : moved   ? fmt::format("{:.3g}", static_cast<double>(step - shown_) / since)
                            : "-",
                  moved || step == run_.steps ? clock_text(left) : "-");
  const std::vector<double> values = sampled ? latest() : std::vector<double>();
  for (const Column& column : columns_)
    text += column.curve < values.size() ? fmt::format("{:>{}.4g}", values[column.curve], column.width)
                                         : fmt::format("{:>{}}", "-", column.width);
  fmt::print(stderr, "{}\n", text);
  std::fflush(stderr);
  any_ = true;
  shown_ = step;
  last_ = now;
}

}  // namespace cuboct
