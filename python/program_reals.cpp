// SPDX-License-Identifier: MIT
#include "python/program_reals.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/rules/rounds_rule.h"
#include "model/run/reference_kind.h"
#include "model/run/rounds_run.h"
#include "python/program_run.h"

namespace cuboct::python {
namespace {

namespace fs = std::filesystem;

// A checkpoint is two files, the second one the trace so far.
constexpr const char* kParts[] = {"", ".journal"};

void copy_checkpoint(const std::string& from, const std::string& to) {
  for (const char* part : kParts) fs::copy_file(from + part, to + part, fs::copy_options::overwrite_existing);
}
void move_checkpoint(const std::string& from, const std::string& to) {
  for (const char* part : kParts) fs::rename(from + part, to + part);
}

}  // namespace

ProgramReals::ProgramReals(const Sources& sources, const std::string& engine, const EngineOptions& options,
                           const Scene& scene, const Setup& setup)
    : sources_(sources),
      engine_(engine),
      options_(options),
      scene_(scene),
      setup_(setup),
      input_(write_sources(sources, scratch_)),
      body_(scene.body) {}

Engine& ProgramReals::here() {
  if (here_) return *here_;
  RealOptions real = options_.real_options();
  if (scene_.rule.rounds != nullptr) real.precision = Precision::float64;  // it has no other
  real.threads = reference_threads(body_.size());
  real.on_demand = true;
  here_ = scene_reference(scene_, body_, real, setup_.plan.rule.cell_edge, step_, {});
  return *here_;
}

void ProgramReals::take(const Trace& trace) {
  if (trace.bodies.empty() || trace.bodies.back().step <= step_) return;
  left_ = trace.bodies.back();
  step_ = left_->step;
  body_ = Body{left_->x, left_->v, left_->u, scene_.body.type, nullptr};
  if (trace.bonds) body_.bonds = std::make_shared<BondState>(BondState{scene_.packing().x, *trace.bonds});
  here_.reset();
}

void ProgramReals::advance(uint64_t steps, std::vector<uint64_t>*) {
  if (stop_) throw StepError(*stop_);
  if (steps == 0) return;
  const uint64_t target = step_ + steps;
  const std::string kept = scratch_.path("checkpoint"), next = scratch_.path("next");
  options_.resume = fs::exists(kept);
  options_.pause_after = steps;
  for (const char* part : kParts) fs::remove(next + part);
  if (options_.resume)
    copy_checkpoint(kept, next);  // should the program be ended, what it began with is there
  const Loaded now = load_plan(sources_, false, engine_, true);
  RunRequest request;
  // Beyond all pauses: the program reads the scene's probes at the last step too, and no run that goes on
  // would have those readings.
  request.steps = std::max(scene_.steps, target) + 1;
  request.frames = {0};  // and the last one, of each piece
  request.hash_every = 0;
  request.log = LogRows::quiet;
  request.checkpoint.path = next;
  const std::optional<Recorded> run =
      run_program(engine_, input_, now, options_, std::move(request), scratch_.path("run.h5"));
  if (!run) return;
  const Trace& trace = run->trace;
  if (!trace.stop) {
    if (!run->left_checkpoint || (trace.steps() < target && !interrupted()))
      throw std::runtime_error(
          fmt::format("the {} engine ended after step {} of {}", engine_, trace.steps(), target));
    move_checkpoint(next, kept);
  }
  take(trace);
  if (trace.stop) throw StepError(*(stop_ = trace.stop));
}

RunState ProgramReals::frame(bool forces) {
  if (left_ && !forces) return *left_;
  return here().frame(forces);
}

Fields ProgramReals::fields() {
  if (scene_.rule.rounds == nullptr) return {};
  if (!left_) return dynamic_cast<RoundsRun&>(here()).shown();
  Fields fields;
  const std::vector<RuleField>& names = scene_.rule.rounds->declaration().shown;
  for (size_t k = 0; k < left_->shown.size(); ++k) fields.emplace_back(names[k].name, left_->shown[k]);
  return fields;
}

}  // namespace cuboct::python
