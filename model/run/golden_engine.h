// SPDX-License-Identifier: MIT
// The golden model behind the interface of engines.
#pragma once
#include "model/contract/golden.h"
#include "model/run/state_engine.h"

namespace cuboct {

class GoldenEngine : public StateEngine {
 public:
  // `initial`: particles of one cell take its slots in this order. Throws as Golden does.
  GoldenEngine(const FixedSetting& setting, int capacity, const State& initial)
      : StateEngine(setting), golden_(setting.fixed, setting.lattice, capacity, initial) {}

  uint64_t step_count() const override { return golden_.step_count(); }
  void advance(uint64_t steps, std::vector<uint64_t>*) override {
    for (; steps > 0; --steps) golden_.step();
  }
  Counters counters() override { return {}; }
  void for_each_slot(const std::function<void(const Particle&)>& see) override {
    for (const auto& cell : golden_.cells())
      for (const Particle& particle : cell) see(particle);
  }

 protected:
  State make_state() override { return golden_.state(); }

 private:
  Golden golden_;
};

}  // namespace cuboct
