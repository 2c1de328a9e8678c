// SPDX-License-Identifier: MIT
#include "model/run/element_progress.h"

#include <fmt/format.h>

#include <filesystem>

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
  void word(uint64_t value) { file_.word(value); }
  void item(const uint64_t& value) { word(value); }
  void item(const bool& value) { word(value ? 1 : 0); }
  void item(const int& value) { word(static_cast<uint64_t>(value)); }
  void item(const double& value) { file_.number(value); }
  template <typename T>
  void size(const std::vector<T>& items) {
    word(items.size());
  }
  void end() {
    word(file_.mark().hash);
    file_.sync();
  }

 private:
  WordWriter file_;
};

class In {
 public:
  explicit In(const std::string& path) : path_(path), file_(path) {}
  uint64_t word() { return file_.word(); }
  void item(uint64_t& value) { value = word(); }
  void item(bool& value) { value = word() != 0; }
  void item(int& value) { value = static_cast<int>(word()); }
  void item(double& value) { value = file_.number(); }
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

template <class File, class... Items>
void walk(File& file, Items&... items);

template <class File, typename T>
requires requires(File& f, T& t) { f.item(t); }
void visit(File& file, T& value) { file.item(value); }
template <class File, typename T>
requires requires(T& t) { t.squaredNorm(); }
void visit(File& file, T& matrix) {
  for (size_t k = 0; k < static_cast<size_t>(matrix.size()); ++k) file.item(matrix.data()[k]);
}
template <class File>
void visit(File& file, auto& point) requires requires {
  point.iterations;
}
{ walk(file, point.strain, point.stress, point.expansion, point.across, point.iterations); }
template <class File>
void visit(File& file, auto& point) requires requires {
  point.place, point.time;
}
{ walk(file, point.time, point.place); }
template <class File>
void visit(File& file, auto& snapshot) requires requires {
  snapshot.points;
}
{ walk(file, snapshot.time, snapshot.points); }
template <class File>
void visit(File& file, auto& work) requires requires {
  work.relaxations;
}
{
  walk(file, work.updates, work.relaxations, work.evaluations, work.largest_error, work.squared_error,
       work.measured);
}
template <class File>
void visit(File& file, auto& wave) requires requires {
  wave.snapshots;
}
{
  walk(file, wave.front, wave.speed.speed, wave.speed.error, wave.dt, wave.steps, wave.largest_strain,
       wave.snapshots);
}
template <class File>
void visit(File& file, auto& outcome) requires requires {
  outcome.moduli;
}
{
  walk(file, outcome.stretch, outcome.moduli.youngs, outcome.moduli.poisson, outcome.wave, outcome.work,
       outcome.seconds, outcome.processor);
}
template <class File>
void visit(File& file, auto& sample) requires requires {
  sample.energy, sample.strain;
}
{ walk(file, sample.place, sample.strain, sample.stress, sample.energy); }
template <class File>
void visit(File& file, auto& progress) requires requires {
  progress.waving;
}
{
  walk(file, progress.outcome, progress.waving, progress.steps, progress.history, progress.x, progress.v,
       progress.period, progress.samples, progress.begun);
}
template <class File>
void visit(File& file,
           auto& three) requires std::is_same_v<std::remove_cvref_t<decltype(three)>, std::array<double, 3>> {
  walk(file, three[0], three[1], three[2]);
}
template <class File, typename T>
void visit(File& file, std::vector<T>& items) {
  file.size(items);
  for (T& item : items) visit(file, item);
}
template <class File, typename T>
void visit(File& file, const std::vector<T>& items) {
  file.size(items);
  for (const T& item : items) visit(file, item);
}

template <class File, class... Items>
void walk(File& file, Items&... items) {
  (visit(file, items), ...);
}

}  // namespace

void save_progress(const std::string& path, uint64_t study, const ElementProgressFile& progress) {
  write_whole(path, [&](const std::string& temporary) {
    Out file(temporary);
    file.word(kLayout);
    file.word(study);
    walk(file, progress.done, progress.now);
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
  walk(file, out.done, out.now);
  file.end();
  return out;
}

}  // namespace cuboct
