// SPDX-License-Identifier: MIT
#include "model/run/element_progress.h"

#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <span>

#include "model/base/error.h"
#include "model/base/output.h"
#include "model/run/word_file.h"

namespace cuboct {
namespace {

constexpr uint64_t kLayout = 0x6375626f'656c6d32;  // changes with what is saved

// The same walk over all members writes and reads.
class Out {
 public:
  explicit Out(const std::string& path) : file_(path) {}
  void word(uint64_t& value) { file_.word(value); }
  template <typename T>
  void size(std::vector<T>& items) {
    file_.word(items.size());
  }
  void end() {
    file_.word(file_.mark().hash);
    file_.sync();
  }

 private:
  WordWriter file_;
};

class In {
 public:
  explicit In(const std::string& path) : path_(path), file_(path) {}
  uint64_t word() { return file_.word(); }
  void word(uint64_t& value) { value = word(); }
  template <typename T>
  void size(std::vector<T>& items) {
    items.resize(file_.count(1));
  }
  void end() {
    const uint64_t hash = file_.mark().hash;
    if (word() != hash)
      throw InputError(fmt::format("{} is damaged: its words are not those that were saved", path_));
  }

 private:
  std::string path_;
  WordReader file_;
};

void walk(auto& file, auto&... items) { (visit(file, items), ...); }

void visit(auto& file, uint64_t& value) { file.word(value); }
void visit(auto& file, bool& value) {
  uint64_t word = value ? 1 : 0;
  file.word(word);
  value = word != 0;
}
void visit(auto& file, int& value) {
  auto word = static_cast<uint64_t>(value);
  file.word(word);
  value = static_cast<int>(word);
}
void visit(auto& file, double& value) {
  auto word = std::bit_cast<uint64_t>(value);
  file.word(word);
  value = std::bit_cast<double>(word);
}
template <class Matrix>
requires requires(Matrix& m) { m.squaredNorm(); }
void visit(auto& file, Matrix& matrix) {
  for (double& value : std::span(matrix.data(), static_cast<size_t>(matrix.size()))) visit(file, value);
}
void visit(auto& file, std::array<double, 3>& three) { walk(file, three[0], three[1], three[2]); }
template <typename T>
void visit(auto& file, std::vector<T>& items) {
  file.size(items);
  for (T& item : items) visit(file, item);
}
void visit(auto& file, StretchPoint& point) {
  walk(file, point.strain, point.stress, point.expansion, point.across, point.iterations);
}
void visit(auto& file, FrontPoint& point) { walk(file, point.time, point.place); }
void visit(auto& file, WaveSnapshot& snapshot) { walk(file, snapshot.time, snapshot.points); }
void visit(auto& file, SetOutcome& outcome) {
  WaveOutcome& wave = outcome.wave;
  SampleWork& work = outcome.work;
  walk(file, outcome.stretch, outcome.moduli.youngs, outcome.moduli.poisson, wave.front, wave.speed.speed,
       wave.speed.error, wave.dt, wave.steps, wave.largest_strain, wave.snapshots, work.updates,
       work.relaxations, work.evaluations, work.largest_error, work.squared_error, work.measured,
       outcome.seconds, outcome.processor);
}
void visit(auto& file, ElementSample& sample) {
  walk(file, sample.place, sample.strain, sample.stress, sample.energy);
}
void visit(auto& file, ElementProgressFile& progress) {
  ElementProgress& now = progress.now;
  walk(file, progress.done, now.outcome, now.waving, now.steps, now.history, now.x, now.v, now.period,
       now.samples, now.begun);
}

}  // namespace

void save_progress(const std::string& path, uint64_t study, const ElementProgressFile& progress) {
  write_whole(path, [&](const std::string& temporary) {
    Out file(temporary);
    uint64_t layout = kLayout;
    ElementProgressFile copy = progress;
    walk(file, layout, study, copy);
    file.end();
  });
}

ElementProgressFile load_progress(const std::string& path, uint64_t study) {
  ElementProgressFile out;
  if (!std::filesystem::exists(path)) return out;
  In file(path);
  if (file.word() != kLayout)
    throw InputError(fmt::format("{} is no progress of this version's studies", path));
  if (file.word() != study)
    throw InputError(fmt::format("{} is the progress of another study", path),
                     "remove it, or give another directory");
  walk(file, out);
  file.end();
  return out;
}

}  // namespace cuboct
