// SPDX-License-Identifier: MIT
// Computes what a study asks for and its store lacks.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "study/sweep/store.h"
#include "study/sweep/study.h"
#include "study/sweep/truth.h"

namespace cuboct::study {

struct RunnerOptions {
  int jobs = 0;          // points computed at once; 0: one per core, on a GPU gpu_runs_at_once()
  bool speed = true;     // measure speeds as well, one after the other when all errors are there
  bool progress = true;  // a line on stderr, where that is a terminal
};

// Every call answers from the store where it can, and puts what it computes there before it returns: a
// process that was killed, run again, ends with the same errors. All throw Interrupted (interrupted.h) once
// model/base/interrupt.h was asked to stop. Study and store must outlive the runner.
class Runner {
 public:
  Runner(const Study& study, Store& store, const RunnerOptions& options);

  // The study's points. Those of the gpu engine are left out where it cannot run.
  void run();
  // In one line what `run` left out, and why; empty: nothing.
  const std::string& left_out() const { return left_out_; }
  // Points that went on at once on a GPU; 0: none did.
  int gpu_jobs() const { return gpu_jobs_; }

  // The study's truth, computed where it is not there yet.
  const Truth& truth();
  // Errors of any settings, not of the study's points alone; several at once on the runner's jobs. In their
  // order, without speeds. InputError where the gpu engine is asked for and cannot run.
  std::vector<Outcome> errors_of(const std::vector<Settings>& points);

 private:
  // Whether the gpu engine can run here; looked up once.
  bool has_gpu();
  void make_truths(const std::vector<Settings>& points);
  const Truth& truth_of(const Settings& settings);
  void measure_speeds(const std::vector<Settings>& points);

  const Study& study_;
  Store& store_;
  RunnerOptions options_;
  int most_gpu_jobs_ = 1, gpu_jobs_ = 0;
  std::map<std::string, Truth> truths_;  // by physics_key
  std::set<std::string> no_truth_;       // physics_keys without one: no run in doubles has an end
  std::optional<std::string> gpu_;       // its name, once looked up; empty: there is none
  std::string no_gpu_, left_out_;
};

}  // namespace cuboct::study
