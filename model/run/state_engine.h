// SPDX-License-Identifier: MIT
// An engine of the fixed rule that gives its state to the host: everything else follows from that.
#pragma once

#include <optional>

#include "model/analysis/state_reader.h"
#include "model/run/engine.h"

namespace cuboct {

// What a fixed engine's states mean. References: they outlive the engine.
struct FixedSetting {
  const Rule& rule;
  const FixedRule& fixed;
  const Lattice& lattice;
  const Vec3& origin;
  int threads = 0;  // that read a state; 0: one per core
};

class StateEngine : public Engine {
 public:
  explicit StateEngine(const FixedSetting& setting)
      : setting_(setting),
        reader_(setting.rule, setting.fixed, setting.lattice, setting.origin, setting.threads) {}

  uint64_t hash() override { return hash_of(setting_.lattice, here()); }
  RunState frame(bool) override;
  Reading read(const Asked& asked) override;
  Momentum momentum() override;
  double largest_speed() override { return largest_speed_; }

 protected:
  virtual State
  make_state() = 0;  // sorted by id; of processes that share a scene whole on the one that leads
  // summed_kicks of the state, of an engine that sums them faster than it; else empty. Whole where the state
  // is.
  virtual std::vector<Int3> make_kicks() { return {}; }

 private:
  const State& here();

  FixedSetting setting_;
  StateReader reader_;
  std::optional<State> state_;  // of the step at which it was asked for
  // Of the last state that was made, which frame() may have given away.
  std::optional<uint64_t> made_;
  Int3 momentum_{};
  double largest_speed_ = 0;
};

}  // namespace cuboct
