// SPDX-License-Identifier: MIT
#include "emu/lattice/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <tuple>
#include <utility>

#include "emu/lattice/checkpoint.h"
#include "emu/lattice/journal.h"
#include "emu/lattice/timing.h"
#include "hw/setup.h"
#include "hw/state_bounds.h"
#include "model/analysis/state_meter.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/progress.h"
#include "model/base/resources.h"

namespace cuboct::emu {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

bool among(const std::vector<uint64_t>& ascending, uint64_t step) {
  return std::binary_search(ascending.begin(), ascending.end(), step);
}

// A particle of a checkpoint, which may be a stranger's.
Particle checked(const Particle& particle, const Plan& plan, const std::string& path) {
  const std::string wrong = out_of_bounds(particle, bounds_of(plan));
  if (wrong.empty()) return particle;
  throw InputError(fmt::format("{} is damaged: particle {}: {}", path, particle.id, wrong));
}

class Loop {
 public:
  Loop(const Scene& scene, const Plan& plan, const LatticeRun& request);
  LatticeResult run();

 private:
  void start();
  void resume();
  void resume_trace(const CheckpointHead& head);
  // Of ranks that share the scene all step, and the first keeps the trace and the files.
  bool leads() const { return !ranks_ || ranks_->rank() == 0; }
  // What any rank asks for, all do.
  std::pair<bool, bool> agreed(bool stop, bool save) const;
  void make_engine(CheckpointReader* from);
  void check_alike(const CheckpointReader& from) const;
  void step();
  void record();
  void measure(const State& state);
  void keep(State state);
  void give(State state);
  void journal(const std::function<void(Journal&)>& write);
  void save();
  bool write_state();
  bool save_is_due() const;
  void go_back_to(uint64_t step);
  void finish();
  uint64_t step_count() const { return trace_.steps_done; }

  const Plan& plan_;
  const std::function<Particle(uint32_t)> particle_;  // of the initial state, by id
  const LatticeRun& request_;
  const CheckpointPlan& save_plan_;
  Ranks* const ranks_;
  const bool displaced_;
  StateMeter meter_;
  std::unique_ptr<LatticeEngine> engine_;
  std::optional<TimingModel> timing_;
  std::optional<Journal> journal_;
  bool saved_ = false;       // there is a checkpoint of this run
  LatticeCounters earlier_;  // of the runs before this one, up to the checkpoint
  uint64_t saved_step_ = 0;
  Clock::time_point saved_time_;
  CellSlots slots_;
  std::vector<PhaseSpan> spans_;
  std::vector<uint64_t> sample_steps_;
  Int3 kept_momentum_{};  // of the last state that was kept
  LatticeResult result_;
  Trace& trace_;
};

Loop::Loop(const Scene& scene, const Plan& plan, const LatticeRun& request)
    : plan_(plan),
      particle_([&scene, &plan](uint32_t id) {
        return fixed_particle(scene.body, id, plan.rule, plan.lattice, plan.origin);
      }),
      request_(request),
      save_plan_(request.checkpoint),
      ranks_(request.engine.ranks),
      displaced_(plan.rule.pd),
      meter_(scene, plan.rule, plan.lattice, plan.origin, particle_, request.energies,
             request.engine.threads > 0 ? request.engine.threads : usable_cores(), request.watch),
      trace_(result_.trace) {
  trace_.engine = "lattice";
  trace_.plan_hash = plan.hash;
  trace_.nodes = plan.nodes();
  trace_.hash_every = request.hash_every;
}

void Loop::make_engine(CheckpointReader* from) {
  engine_.reset();
  const uint64_t step = from ? from->head().step : 0;
  if (!from && request_.spare && request_.spare->size() == 0) *request_.spare = request_.body_again();
  // One process alone takes each particle once: the body shrinks as the engine grows.
  const bool shrink = !from && request_.spare && (!ranks_ || ranks_->size() == 1);
  std::optional<InitialParticles> shrinking;
  if (shrink) shrinking.emplace(std::exchange(*request_.spare, {}), plan_);
  Int3 sum{};
  const auto next = [&](uint32_t k) {
    if (k == 0) {  // ranks take the particles twice
      sum = {};
      if (from) from->rewind();
    }
    if (from) return checked(from->next(), plan_, save_plan_.path);
    const Particle p = shrinking ? (*shrinking)(k) : particle_(k);
    for (int a = 0; a < 3; ++a) sum[a] += p.v[a];
    return p;
  };
  engine_ = std::make_unique<LatticeEngine>(plan_, step, plan_.particles, next, request_.engine);
  if (request_.spare) *request_.spare = {};
  result_.momentum_before = from ? from->head().momentum : sum;
}

void Loop::start() {
  if (!save_plan_.path.empty() && leads()) {
    if (std::filesystem::exists(save_plan_.path))
      throw InputError(fmt::format("{} holds a run that did not end", save_plan_.path),
                       "--resume goes on with it; to begin anew, remove it first");
    check_writable(save_plan_.path);
    journal_.emplace(save_plan_.path + ".journal", plan_.hash, displaced_);
  }
  make_engine(nullptr);
  record();
}

void Loop::check_alike(const CheckpointReader& from) const {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{} was made with {}", save_plan_.path, what),
                     "resume with the options of the run that wrote it");
  };
  const CheckpointHead& head = from.head();
  if (head.hash_every != request_.hash_every)
    refuse(fmt::format("a hash every {} steps, this run has one every {}", head.hash_every,
                       request_.hash_every));
  if (head.cycles != request_.cycles) refuse(head.cycles ? "cycles" : "no cycles");
  if (head.energies != request_.energies) refuse(head.energies ? "energies" : "no energies");
  if (head.step > request_.steps)
    refuse(fmt::format("more steps: it is at step {} of this run's {}", head.step, request_.steps));
  const auto until_now = [&](const std::vector<uint64_t>& steps) {
    return std::vector<uint64_t>(steps.begin(), std::upper_bound(steps.begin(), steps.end(), head.step));
  };
  if (journal_->frame_steps() != until_now(request_.frames)) refuse("frames at other steps");
  if (sample_steps_ != until_now(request_.probes) && !meter_.curves().empty())
    refuse("probes read at other steps");
}

void Loop::resume() {
  if (!std::filesystem::exists(save_plan_.path))
    throw InputError(fmt::format("there is no checkpoint {}", save_plan_.path),
                     "leave out --resume to begin at step 0");
  CheckpointReader from(save_plan_.path, plan_.hash, displaced_);
  const CheckpointHead& head = from.head();
  if (leads()) {
    resume_trace(head);
    check_alike(from);
  }
  trace_.steps_done = head.step;
  trace_.seconds = head.seconds;
  result_.largest_speed = head.largest_speed;
  result_.resumed_at = saved_step_ = head.step;
  earlier_ = head.counters;
  saved_ = true;
  make_engine(&from);
  if (timing_) timing_->resume(head.timing);
}

// From the journal.
void Loop::resume_trace(const CheckpointHead& head) {
  journal_.emplace(save_plan_.path + ".journal", plan_.hash, displaced_, head.journal, trace_);
  const std::vector<Curve> fresh = meter_.curves();
  if (!trace_.curves.empty()) {
    sample_steps_ = trace_.curves.front().step;
    if (trace_.curves.size() != fresh.size() || head.probes.latest.size() != meter_.probed())
      throw InputError(fmt::format("{} was made with other probes", save_plan_.path),
                       "resume with the scene that wrote it");
    for (size_t k = 0; k < fresh.size(); ++k)
      trace_.curves[k].name = fresh[k].name, trace_.curves[k].unit = fresh[k].unit;
    meter_.restore(head.probes, trace_.curves);
  }
  journal_->for_each_frame([&](State state) { give(std::move(state)); });
}

// A state is made only where a frame or a sample asks for one.
void Loop::record() {
  const uint64_t step = engine_->step_count();
  trace_.steps_done = step;
  if (step % request_.hash_every == 0) {
    trace_.state_hash.push_back(engine_->hash());
    journal([&](Journal& to) { to.hash(step, trace_.state_hash.back()); });
  }
  const bool measured = among(request_.probes, step), kept = among(request_.frames, step);
  if (!measured && !kept) return;
  State state = engine_->state();
  if (!leads()) return;
  if (measured) {
    measure(state);
    const std::vector<double> values = meter_.latest();
    if (!values.empty()) journal([&](Journal& to) { to.sample(step, values); });
  }
  if (kept) keep(std::move(state));
}

void Loop::measure(const State& state) {
  meter_.add(state);
  sample_steps_.push_back(state.step);
  result_.largest_speed = std::max(result_.largest_speed, largest_speed(plan_.rule, state));
}

void Loop::keep(State state) {
  result_.largest_speed = std::max(result_.largest_speed, largest_speed(plan_.rule, state));
  journal([&](Journal& to) { to.frame(state); });
  give(std::move(state));
}

void Loop::give(State state) {
  kept_momentum_ = momentum(state);
  if (request_.keep)
    request_.keep(state);
  else
    trace_.frames.push_back(std::move(state));
}

// A journal that cannot be written ends the checkpoints, not the run; the last checkpoint holds.
void Loop::journal(const std::function<void(Journal&)>& write) {
  if (!journal_) return;
  try {
    write(*journal_);
  } catch (const InputError& error) {
    fmt::print(stderr, "warning: {}; no checkpoint from step {} on\n", error.what(), step_count());
    journal_.reset();
  }
}

void Loop::step() {
  const auto begin = Clock::now();
  if (timing_) engine_->slots(slots_);
  engine_->step();
  if (timing_) timing_->step(slots_, engine_->leaving(), spans_);
  trace_.seconds += since(begin);
  if (!timing_) return;
  trace_.cycles.insert(trace_.cycles.end(), spans_.begin(), spans_.end());
  journal([&](Journal& to) { to.cycles(engine_->step_count() - 1, spans_); });
}

bool Loop::save_is_due() const {
  return journal_ && ((save_plan_.every_steps > 0 && step_count() - saved_step_ >= save_plan_.every_steps) ||
                      (save_plan_.every_seconds > 0 && since(saved_time_) >= save_plan_.every_seconds));
}

std::pair<bool, bool> Loop::agreed(bool stop, bool save) const {
  if (!ranks_) return {stop, save};
  std::array<uint8_t, 2> asked{stop, save};
  ranks_->any(asked);
  return {asked[0] != 0, asked[1] != 0};
}

void Loop::save() {
  bool failed = false;
  if (leads())
    failed = !write_state();
  else
    engine_->for_each_slot([](const Particle&) {});  // they are gathered where they are written
  result_.left_checkpoint = !agreed(failed, false).first;
  saved_ = saved_ || result_.left_checkpoint;
}

// Whether the checkpoint is there.
bool Loop::write_state() {
  CheckpointHead head;
  head.plan_hash = plan_.hash;
  head.step = engine_->step_count();
  head.particles = plan_.particles;
  head.hash_every = request_.hash_every;
  head.cycles = request_.cycles;
  head.energies = request_.energies;
  head.seconds = trace_.seconds;
  head.largest_speed = result_.largest_speed;
  head.momentum = result_.momentum_before;
  head.counters = earlier_;
  const LatticeCounters& now = engine_->counters();
  head.counters.list_builds += now.list_builds;
  head.counters.node_steps += now.node_steps;
  head.counters.quiet_node_steps += now.quiet_node_steps;
  head.probes = meter_.memory();
  if (timing_) head.timing = timing_->starts();
  journal([&](Journal& to) { head.journal = to.sync(); });
  saved_step_ = head.step;
  saved_time_ = Clock::now();
  if (!journal_) {
    engine_->for_each_slot([](const Particle&) {});  // the other ranks send theirs
    return false;
  }
  try {
    write_checkpoint(save_plan_.path, head, *engine_, displaced_);
    return true;
  } catch (const InputError& error) {
    fmt::print(stderr, "warning: {}; no checkpoint of step {}\n", error.what(), head.step);
    return false;
  }
}

// The state after `step` once more, where the engine has lost it.
void Loop::go_back_to(uint64_t step) {
  if (saved_) {
    CheckpointReader from(save_plan_.path, plan_.hash, displaced_);
    make_engine(&from);
  } else {
    make_engine(nullptr);
  }
  while (engine_->step_count() < step) engine_->step();
}

// The last state is part of every answer, also of a run that ended early: its hash, its frame, its energies.
void Loop::finish() {
  if (trace_.state_hash.empty()) return;  // not even the initial state could be held
  const uint64_t last = step_count();
  const bool has_frame = among(request_.frames, last);
  const bool frame = !request_.frames.empty() && !has_frame;
  const bool sample = request_.energies && !among(request_.probes, last);
  const bool hash = last % request_.hash_every != 0;
  const bool lost = trace_.stop.has_value();
  if (lost && (sample || hash || !has_frame)) go_back_to(last);
  if (hash) trace_.state_hash.push_back(engine_->hash());
  if (frame || sample) {
    State state = engine_->state();
    result_.largest_speed = std::max(result_.largest_speed, largest_speed(plan_.rule, state));
    if (sample && leads()) measure(state);
    if (frame && leads()) give(std::move(state));
  }
  const bool kept = lost && !sample && !hash && has_frame;  // the engine's state is still lost
  result_.momentum_after = kept ? kept_momentum_ : engine_->momentum();
  trace_.curves = meter_.curves();
  meter_.conclude();
  if (const Watch* watch = meter_.watch()) {
    trace_.findings = watch->findings();
    trace_.watched = watch->last_step();
  }
  if (timing_ && !lost) {
    engine_->slots(slots_);
    trace_.counters.emplace_back("cycles", static_cast<double>(timing_->cycles(slots_)));
  }
}

LatticeResult Loop::run() {
  if (request_.cycles && ranks_ && ranks_->size() > 1)
    throw InputError("--cycles: the timing model runs on one rank alone");
  if (request_.cycles) {
    timing_.emplace(plan_, request_.engine.threads);
    spans_.resize(trace_.nodes * kPhases);
  }
  LatticeCounters counters;
  int threads = 0;
  try {
    saved_time_ = Clock::now();
    if (save_plan_.resume)
      resume();
    else
      start();
    threads = engine_->threads();
    Progress progress("lattice", request_.steps, plan_.particles, step_count(), request_.progress);
    for (bool stop = agreed(interrupted(), false).first; step_count() < request_.steps && !stop;) {
      step();
      record();
      if (leads()) progress.at(step_count());
      bool due = false;
      std::tie(stop, due) = agreed(interrupted(), save_is_due());
      if (due && !stop && step_count() < request_.steps) save();
    }
    counters = engine_->counters();
    result_.interrupted = step_count() < request_.steps;
    if (result_.interrupted && !save_plan_.path.empty()) save();
  } catch (const RunError& error) {
    trace_.stop = StopReason{error.fault, error.step, error.cell, error.particle, error.number, error.what()};
    if (engine_) counters = engine_->counters();
  }
  finish();
  const auto count = [&](const char* name, uint64_t value) {
    trace_.counters.emplace_back(name, static_cast<double>(value));
  };
  count("list_builds", earlier_.list_builds + counters.list_builds);
  count("node_steps", earlier_.node_steps + counters.node_steps);
  count("quiet_node_steps", earlier_.quiet_node_steps + counters.quiet_node_steps);
  count("threads", static_cast<uint64_t>(threads));
  return std::move(result_);
}

}  // namespace

void read_interval(const std::string& text, CheckpointPlan& plan) {
  const auto refuse = [&]() -> double {
    throw InputError(fmt::format("'{}' says no interval between checkpoints", text),
                     "such as '1000 steps', '30 s', '5 min' or '2 h'");
  };
  size_t digits = 0;
  double number = 0;
  try {
    number = std::stod(text, &digits);
  } catch (const std::logic_error&) {
    refuse();
  }
  const size_t at = text.find_first_not_of(' ', digits);
  const std::string unit = at == std::string::npos ? "" : text.substr(at);
  const double seconds = unit == "s" ? 1 : unit == "min" ? 60 : unit == "h" ? 3600 : 0;
  if (!(number > 0) || number > 1e15 || (seconds == 0 && unit != "steps" && unit != "step")) refuse();
  if (seconds > 0)
    plan.every_seconds = number * seconds;
  else if (number == std::floor(number))
    plan.every_steps = static_cast<uint64_t>(number);
  else
    refuse();
}

LatticeResult run_lattice(const Scene& scene, const Plan& plan, const LatticeRun& request) {
  return Loop(scene, plan, request).run();
}

void remove_checkpoint(const std::string& path) {
  std::error_code none;
  if (path.empty()) return;
  std::filesystem::remove(path, none);
  std::filesystem::remove(path + ".journal", none);
  std::filesystem::remove(path + ".tmp", none);
}

}  // namespace cuboct::emu
