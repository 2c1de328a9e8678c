// SPDX-License-Identifier: MIT
// The results of a study in one file (SQLite), written point by point: a study that is killed goes on where
// it was. Points of other engines and machines (a GPU, a board) are rows as well.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "study/outcome.h"
#include "study/study.h"
#include "study/truth.h"

namespace cuboct::study {

// Everything a report is made of.
struct Results {
  std::string title, scene, machine;  // machine: processor, cores
  std::vector<std::string> figure_names, figure_units;
  Truth truth;                    // without its states
  std::vector<Outcome> outcomes;  // in the order of the study's points, then those from elsewhere
};

class Store {
 public:
  // Opens or makes `path`. Throws InputError where it is no store, or that of another study (its hash).
  Store(const std::string& path, const Study& study);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  void put_truth(const Truth& truth);
  bool has_truth() const;
  void put_errors(const Outcome& outcome);  // by settings.numbers_key()
  bool has_errors(const Settings& settings) const;
  void put_speed(const Settings& settings, const Speed& speed);  // by settings.key()
  bool has_speed(const Settings& settings) const;
  // Rows of another store of the same scene, measured elsewhere.
  void add(const std::string& path);

  Results results() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cuboct::study
