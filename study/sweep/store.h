// SPDX-License-Identifier: MIT
// The results of a study in one file (SQLite), written point by point: a study that is killed goes on where
// it was. Points of other engines and machines (a GPU, a board) are rows as well. docs/user/study.md
// describes the tables.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "study/sweep/outcome.h"
#include "study/sweep/study.h"
#include "study/sweep/truth.h"

namespace cuboct::study {

// Everything a report is made of.
struct Results {
  std::string title, scene, machine;  // machine: processor, cores
  std::vector<std::string> figure_names, figure_units;
  Truth truth;                    // without its states
  std::vector<Outcome> outcomes;  // in the order of the study's points, then those from elsewhere
};

// May be used by several threads. A process may be killed at any time: each `put` is there, whole, when it
// returns. Only a loss of power may take the last ones.
class Store {
 public:
  // Opens or makes `path`. Throws InputError where it is no store, that of another study (its hash), or at
  // work in another process.
  Store(const std::string& path, const Study& study);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // By physics_key (truth.h); "" is the study's own.
  void put_truth(const std::string& physics, const Truth& truth);
  std::optional<Truth> truth(const std::string& physics) const;
  void drop_truth(const std::string& physics);
  void put_truth(const Truth& truth) { put_truth("", truth); }

  void put_errors(const Outcome& outcome);  // by settings.numbers_key()
  bool has_errors(const Settings& settings) const;
  // Without its speed.
  std::optional<Outcome> errors(const Settings& settings) const;

  void put_speed(const Settings& settings, const Speed& speed);  // by settings.key()
  bool has_speed(const Settings& settings) const;
  std::optional<Speed> speed(const Settings& settings) const;

  // Rows of another store of the same scene, figures and times, measured elsewhere; what is here already
  // stays. Throws InputError. The number of rows that came.
  int add(const std::string& path);
  // Whether it may come: throws as add() where it is no store of the study, and before there is one here.
  static void check(const std::string& path, const Study& study);

  Results results() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// "AMD EPYC 7763, 4 cores": what Results::machine says of this one.
std::string this_machine();

}  // namespace cuboct::study
