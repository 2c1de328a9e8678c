// SPDX-License-Identifier: MIT
#include "model/run/state_engine.h"

#include <algorithm>

namespace cuboct {

const State& StateEngine::here() {
  if (state_ && state_->step == step_count()) return *state_;
  state_ = make_state();
  made_ = state_->step;
  momentum_ = cuboct::momentum(setting_.fixed, *state_);
  largest_speed_ = std::max(largest_speed_, cuboct::largest_speed(setting_.fixed, *state_));
  return *state_;
}

Momentum StateEngine::momentum() {
  if (made_ != step_count()) here();
  return {momentum_, {}};
}

RunState StateEngine::frame(bool) {
  here();
  State state = std::move(*state_);
  state_.reset();
  return state;
}

Reading StateEngine::read(const Asked& asked) {
  const State& state = here();
  std::vector<Int3> kicks;
  if (takes_kicks(asked)) kicks = make_kicks();
  return leads() ? reader_.read(state, asked, std::move(kicks)) : Reading{};
}

}  // namespace cuboct
