// SPDX-License-Identifier: MIT
#include "model/run/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <tuple>

#include "model/analysis/meter.h"
#include "model/base/clock.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/rules/rounds_rule.h"
#include "model/run/journal.h"
#include "model/run/static_engine.h"

namespace cuboct {
namespace {

// Adds the time of a scope to each of them.
class Timed {
 public:
  explicit Timed(std::initializer_list<double*> sums) : sums_(sums) {}
  ~Timed() {
    for (double* sum : sums_) *sum += seconds_since(begin_);
  }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  Clock::time_point begin_ = Clock::now();
  std::vector<double*> sums_;
};

bool among(const std::vector<uint64_t>& ascending, uint64_t step) {
  return std::binary_search(ascending.begin(), ascending.end(), step);
}

// The first of `ascending` behind `step`, if it is below `next`.
uint64_t sooner(const std::vector<uint64_t>& ascending, uint64_t step, uint64_t next) {
  const auto at = std::upper_bound(ascending.begin(), ascending.end(), step);
  return at == ascending.end() ? next : std::min(*at, next);
}

class Loop {
 public:
  Loop(const Scene& scene, const EngineKind& kind, const RunRequest& request);
  Recorded run();

 private:
  void start();
  void resume();
  void resume_trace(const CheckpointHead& head);
  void check_alike(const CheckpointHead& head) const;
  void make_engine(CheckpointReader* from, bool cycles);
  void go();
  void show();
  uint64_t next_stop() const;
  void advance(uint64_t steps);
  void record();
  void measure(const Meter::Parts& parts, bool look);
  const std::vector<uint64_t>& energy_steps() const {
    return request_.energy_steps.empty() ? request_.probes : request_.energy_steps;
  }
  RunState frame();
  void keep();
  void journal(const std::function<void(Journal&)>& write);
  void save();
  bool write_state();
  void give_state();
  bool save_is_due() const;
  void go_back_to(uint64_t step);
  void guarded(const std::function<void()>& part);
  void finish();
  void total();
  void look_for_end();
  bool reached();
  bool ends_early() const { return request_.until && scene_.until; }
  bool hashed() const { return kind_.fixed && request_.hash_every > 0; }
  bool hashes_come() const { return kind_.hashes_come && hashed() && request_.hash_every == 1; }
  bool leads() const { return engine_->leads(); }

  const Scene& scene_;
  const EngineKind& kind_;
  const RunRequest& request_;
  const CheckpointPlan& save_plan_;
  Meter meter_;
  const std::vector<Curve> curves_;  // without readings
  const std::vector<uint64_t> looks_;
  std::unique_ptr<Engine> engine_;
  std::optional<Journal> journal_;
  bool saved_ = false;  // there is a checkpoint of this run
  uint64_t saved_step_ = 0;
  Clock::time_point saved_time_;
  RunLog log_;
  uint64_t piece_;  // steps between two looks at the clock, of an engine that works in batches
  std::optional<uint64_t> looked_;
  Momentum before_;
  double besides_ = 0;  // s, of `trace_.seconds`: what is read and kept of the steps
  bool over_ = false;   // as the scene's `until` has it
  bool lost_ = false;   // the engine's state went with the step that failed
  Recorded result_;
  Trace& trace_;
};

Loop::Loop(const Scene& scene, const EngineKind& kind, const RunRequest& request)
    : scene_(scene),
      kind_(kind),
      request_(request),
      save_plan_(request.checkpoint),
      meter_(scene, kind.initial,
             {.energies = request.energies,
              .watch = request.watch,
              .table_error = kind.table_error,
              .threads = kind.threads}),
      curves_(meter_.curves()),
      looks_(kind.looks ? kind.looks(energy_steps()) : energy_steps()),
      log_({kind.name, request.steps, kind.relaxes ? 0 : kind.particles, energy_steps(), request.log}, scene,
           curves_),
      piece_(kind.in_pieces || request.checkpoint.every_seconds > 0 || request.log == LogRows::seconds ||
                     stderr_is_terminal()
                 ? 1
                 : std::max<uint64_t>(request.steps, 1)),
      trace_(result_.trace) {
  trace_.engine = kind.name;
  trace_.plan_hash = kind.plan_hash;
  trace_.nodes = kind.nodes;
  trace_.rounds = kind.rounds;
  trace_.hash_every = hashed() ? request.hash_every : 1;
}

void Loop::make_engine(CheckpointReader* from, bool cycles) {
  engine_.reset();
  engine_ = kind_.make(from, cycles);
}

void Loop::start() {
  const auto begin = Clock::now();
  make_engine(nullptr, request_.cycles);
  if (kind_.relaxes) trace_.seconds += seconds_since(begin);  // to rest, which is the run's work
  if (!save_plan_.path.empty() && leads()) {
    if (std::filesystem::exists(save_plan_.path))
      throw InputError(fmt::format("{} holds a run that did not end", save_plan_.path),
                       "--resume goes on with it; to begin anew, remove it first");
    check_writable(save_plan_.path);
    journal_.emplace(save_plan_.path + ".journal", kind_.plan_hash, kind_.displaced);
  }
  if (request_.totals || !save_plan_.path.empty()) before_ = engine_->momentum();
  record();
}

void Loop::check_alike(const CheckpointHead& head) const {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{} was made with {}", save_plan_.path, what),
                     "resume with the options of the run that wrote it");
  };
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
  const std::vector<Curve> curves = meter_.curves();
  if (curves.empty()) return;
  // Probes come first, energies last.
  if (curves.back().step != until_now(request_.energies ? energy_steps() : request_.probes))
    refuse(request_.energies ? "energies read at other steps" : "probes read at other steps");
  if (curves.front().step != until_now(scene_.probes.empty() ? energy_steps() : request_.probes))
    refuse("probes read at other steps");
}

void Loop::resume() {
  if (!std::filesystem::exists(save_plan_.path))
    throw InputError(fmt::format("there is no checkpoint {}", save_plan_.path),
                     "leave out --resume to begin at step 0");
  CheckpointReader from(save_plan_.path, kind_.plan_hash, kind_.displaced);
  const CheckpointHead& head = from.head();
  make_engine(&from, request_.cycles);
  if (leads()) {
    resume_trace(head);
    check_alike(head);
    if (request_.read)
      for_each_reading(trace_.curves,
                       [&](uint64_t step, Values values) { request_.read(curves_, step, values); });
    // What was kept before is taken anew from here on: a refusal above leaves all as it was.
    journal_->for_each_frame([&](RunState state) { give(request_, std::move(state), trace_); });
  }
  trace_.steps_done = head.step;
  trace_.seconds = head.seconds;
  before_.fixed = head.momentum;
  for (size_t a = 0; a < 3; ++a) before_.real[a] = std::bit_cast<double>(head.momentum[a]);
  result_.largest_speed = head.largest_speed;
  result_.resumed_at = saved_step_ = head.step;
  saved_ = true;
}

// From the journal.
void Loop::resume_trace(const CheckpointHead& head) {
  journal_.emplace(save_plan_.path + ".journal", kind_.plan_hash, kind_.displaced, head.journal, trace_);
  const std::vector<Curve> fresh = meter_.curves();
  if (!trace_.curves.empty()) {
    if (trace_.curves.size() != fresh.size() || head.probes.latest.size() != meter_.probed())
      throw InputError(fmt::format("{} was made with other probes", save_plan_.path),
                       "resume with the scene that wrote it");
    for (size_t k = 0; k < fresh.size(); ++k)
      trace_.curves[k].name = fresh[k].name, trace_.curves[k].unit = fresh[k].unit;
    meter_.restore(head.probes, trace_.curves);
  }
}

// A state is made only where a frame or a sample asks for one.
void Loop::record() {
  const Timed timed({&trace_.seconds, &besides_});
  const uint64_t step = engine_->step_count();
  trace_.steps_done = step;
  // Of batches, the hash after each step has come with them.
  if (hashed() && step % request_.hash_every == 0 && !(hashes_come() && step > 0)) {
    trace_.state_hash.push_back(engine_->hash());
    journal([&](Journal& to) { to.hash(step, trace_.state_hash.back()); });
  }
  if (among(request_.probes, step)) {
    const bool energies = request_.energies && among(energy_steps(), step);
    measure({.probes = true, .energies = energies}, among(looks_, step));
    look_for_end();
    if (leads() && (journal_ || request_.read))
      if (const std::vector<double> values = meter_.values_at(step); !values.empty()) {
        journal([&](Journal& to) { to.sample(step, values); });
        if (request_.read) request_.read(curves_, step, values);
      }
  }
  if (among(request_.frames, step)) keep();
}

// Whether the probes say that the run is over.
void Loop::look_for_end() {
  if (!ends_early() || !leads()) return;
  const Until& until = *scene_.until;
  const std::optional<double> value = meter_.latest_of(until.curve);
  if (engine_->step_count() > until.after && value && until.holds(*value))
    trace_.reached = Reached{until.curve, until.side_name(), engine_->step_count(), *value, until.limit};
}

// The same for all processes that share a scene: one of them reads the probes.
bool Loop::reached() {
  if (!ends_early()) return false;
  const bool told = engine_->agreed(trace_.reached.has_value(), false).first;
  return leads() ? trace_.reached.has_value() : told;
}

// `look`: the watch sees the state too, whatever goes into the curves.
void Loop::measure(const Meter::Parts& parts, bool look) {
  const Meter::Parts read{.probes = parts.probes, .energies = parts.energies || look};
  const Reading reading = engine_->read(meter_.asked(read, look, engine_->step_count()));
  if (look) looked_ = engine_->step_count();
  if (leads()) meter_.add(reading, parts);
}

RunState Loop::frame() { return request_.integers ? engine_->integers() : engine_->frame(request_.forces); }

void Loop::keep() {
  RunState kept = frame();
  if (!leads()) return;
  journal([&](Journal& to) { to.frame(kept); });
  give(request_, std::move(kept), trace_);
}

// A journal that cannot be written ends the checkpoints, not the run; the last checkpoint holds.
void Loop::journal(const std::function<void(Journal&)>& write) {
  if (!journal_) return;
  try {
    write(*journal_);
  } catch (const InputError& error) {
    fmt::print(stderr, "warning: {}; no checkpoint from step {} on\n", parts_of(error).message,
               trace_.steps_done);
    journal_.reset();
  }
}

void Loop::advance(uint64_t steps) {
  const uint64_t before = engine_->step_count();
  const size_t hashes = trace_.state_hash.size();
  const auto begin = Clock::now();
  const auto done = [&] {
    trace_.steps_done = engine_->step_count();
    if (hashes_come())
      for (size_t k = hashes; k < trace_.state_hash.size(); ++k)
        journal([&](Journal& to) { to.hash(before + 1 + k - hashes, trace_.state_hash[k]); });
    if (!request_.cycles) return;
    const std::vector<PhaseSpan> spans = engine_->phase_times();
    trace_.cycles.insert(trace_.cycles.end(), spans.begin(), spans.end());
    if (!spans.empty()) journal([&](Journal& to) { to.cycles(before, spans); });
  };
  try {
    engine_->advance(steps, hashes_come() ? &trace_.state_hash : nullptr);
  } catch (...) {
    trace_.seconds += seconds_since(begin);
    lost_ = !kind_.keeps_state;
    if (!lost_) done();
    throw;
  }
  trace_.seconds += seconds_since(begin);
  done();
}

// The step up to which nobody asks for a state.
uint64_t Loop::next_stop() const {
  const uint64_t step = trace_.steps_done;
  uint64_t to = sooner(request_.frames, step, sooner(request_.probes, step, log_.next_row(step)));
  if (hashed() && !hashes_come()) to = std::min(to, (step / request_.hash_every + 1) * request_.hash_every);
  if (save_plan_.every_steps > 0) to = std::min(to, saved_step_ + save_plan_.every_steps);
  return std::max(to, step + 1);
}

void Loop::go() {
  log_.begin(trace_.steps_done);
  show();
  bool stop = engine_->agreed(interrupted(), false).first;
  over_ = reached();
  while (trace_.steps_done < request_.steps && !stop && !over_) {
    const auto begin = Clock::now();  // a piece is long beside what a batch costs to start
    const uint64_t before = trace_.steps_done;
    advance(kind_.batches ? std::min(next_stop() - before, piece_) : 1);
    // Ctrl-C during a save ends a batch before its first step: this one has been recorded.
    if (engine_->step_count() > before) record();
    if (seconds_since(begin) < 0.1 && piece_ < request_.steps) piece_ *= 2;
    show();
    bool due = false;
    std::tie(stop, due) = engine_->agreed(interrupted(), save_is_due());
    over_ = reached();
    if (due && !stop && !over_ && trace_.steps_done < request_.steps) save();
  }
}

void Loop::show() {
  if (leads())
    log_.at(trace_.steps_done, among(request_.probes, trace_.steps_done),
            [this] { return meter_.values_at(trace_.steps_done); });
}

bool Loop::save_is_due() const {
  return journal_ &&
         ((save_plan_.every_steps > 0 && trace_.steps_done - saved_step_ >= save_plan_.every_steps) ||
          (save_plan_.every_seconds > 0 && seconds_since(saved_time_) >= save_plan_.every_seconds));
}

void Loop::save() {
  bool failed = false;
  if (leads())
    failed = !write_state();
  else
    give_state();
  result_.left_checkpoint = !engine_->agreed(failed, false).first;
  saved_ = saved_ || result_.left_checkpoint;
}

// To the process that writes it: what write_state() asks the engine for, in its order.
void Loop::give_state() {
  engine_->largest_speed();
  engine_->memory();
  engine_->for_each_slot([](const Particle&) {});
}

// Whether the checkpoint is there.
bool Loop::write_state() {
  CheckpointHead head;
  head.plan_hash = kind_.plan_hash;
  head.step = trace_.steps_done;
  head.particles = static_cast<uint32_t>(kind_.particles);
  head.hash_every = request_.hash_every;
  head.cycles = request_.cycles;
  head.energies = request_.energies;
  head.seconds = trace_.seconds;
  head.largest_speed = std::max(result_.largest_speed, engine_->largest_speed());
  head.momentum = before_.fixed;
  if (!kind_.fixed)
    for (size_t a = 0; a < 3; ++a) head.momentum[a] = std::bit_cast<int64_t>(before_.real[a]);
  head.engine = engine_->memory();
  head.probes = meter_.memory();
  journal([&](Journal& to) { head.journal = to.sync(); });
  saved_step_ = head.step;
  saved_time_ = Clock::now();
  if (!journal_) {
    engine_->for_each_slot([](const Particle&) {});  // the other processes send theirs
    return false;
  }
  try {
    write_checkpoint(save_plan_.path, head, *engine_, kind_.displaced);
    return true;
  } catch (const InputError& error) {
    fmt::print(stderr, "warning: {}; no checkpoint of step {}\n", parts_of(error).message, head.step);
    return false;
  }
}

// The state after `step` once more, where the engine has lost it.
void Loop::go_back_to(uint64_t step) {
  if (saved_) {
    CheckpointReader from(save_plan_.path, kind_.plan_hash, kind_.displaced);
    make_engine(&from, false);
  } else {
    make_engine(nullptr, false);
  }
  engine_->advance(step - engine_->step_count());
}

// A step that cannot be done ends the trace, and so does a state that cannot be read. Of several reasons the
// first is told.
void Loop::guarded(const std::function<void()>& part) {
  const auto stop = [&](const StopReason& reason) {
    if (!trace_.stop) trace_.stop = reason;
  };
  try {
    part();
  } catch (const RunError& error) {
    stop({error.fault, error.step, error.cell, error.particle, error.number, error.what()});
  } catch (const StepError& error) {
    stop(error.reason);
  } catch (const RoundsError& error) {
    const uint64_t step = engine_ ? engine_->step_count() : 0;
    stop({Fault::none, step, 0, 0, 0, fmt::format("step {}: {}", step, error.what())});
  }
}

// The last state is part of every answer, also of a run that ended early: its hash, its frame, its energies,
// but for what cannot be read of it.
void Loop::finish() {
  const uint64_t last = trace_.steps_done;
  const bool kept = request_.last && !request_.frames.empty() && !among(request_.frames, last);
  const bool probes = request_.last && request_.energies && !among(request_.probes, last);
  const bool sample = request_.last && request_.energies && !among(energy_steps(), last);
  const bool look = request_.last && meter_.watch() && looked_ != last;
  const bool hash = request_.last && hashed() && last % request_.hash_every != 0;
  const bool bonds = request_.last && !request_.frames.empty() &&
                     (has_reference_bonds(scene_.rule) || has_memory(scene_.rule));
  const bool counts = scene_.rule.rounds != nullptr && (request_.last || !lost_);
  if (lost_ && (sample || look || hash || kept || bonds || counts || request_.totals)) go_back_to(last);
  {
    const Timed timed({&trace_.seconds, &besides_});
    if (hash) trace_.state_hash.push_back(engine_->hash());
    guarded([&] {
      if (sample || look) measure({.probes = probes, .energies = sample}, look || sample);
    });
    guarded([&] {
      if (!kept) return;
      RunState last_frame = frame();
      if (leads()) give(request_, std::move(last_frame), trace_);
    });
  }
  guarded([&] {
    if (!counts) return;
    for (const auto& counter : engine_->counters_of_state()) trace_.counters.push_back(counter);
  });
  if (bonds) trace_.bonds = engine_->saved_body()->bonds->kept;
  if (leads()) log_.end(last, sample || among(request_.probes, last), [&] { return meter_.values_at(last); });
  trace_.curves = meter_.curves();
  meter_.conclude();
  if (const Watch* watch = meter_.watch()) {
    trace_.findings = watch->findings();
    if (const auto far = kind_.floats ? find_far_origin(scene_) : std::nullopt)
      trace_.findings.insert(trace_.findings.begin(), *far);
    trace_.watched = watch->last_step();
  }
  if (request_.totals) total();
  if (const auto seconds = engine_->seconds()) trace_.seconds = *seconds + besides_;
  trace_.notes = engine_->notes();
}

void Loop::total() {
  const Momentum after = engine_->momentum();
  if (kind_.fixed)
    for (int a = 0; a < 3; ++a)
      result_.momentum_change =
          std::max(result_.momentum_change, std::abs(static_cast<double>(after.fixed[a] - before_.fixed[a])));
  else
    result_.momentum_change = (after.real - before_.real).norm();
  result_.largest_speed = std::max(result_.largest_speed, engine_->largest_speed());
}

Recorded Loop::run() {
  if (!kind_.saves && (save_plan_.resume || !save_plan_.path.empty()))
    throw InputError(fmt::format("the {} engine leaves no checkpoints", kind_.name),
                     kind_.name == "reference" ? "with --integrator euler it does" : "");
  guarded([&] {
    saved_time_ = Clock::now();
    if (save_plan_.resume)
      resume();
    else
      start();
    go();
    result_.interrupted = trace_.steps_done < request_.steps && !over_;
    if (result_.interrupted && !save_plan_.path.empty()) save();
  });
  if (!engine_) return std::move(result_);  // not even the initial state could be held
  trace_.counters = engine_->counters();    // of the run: another engine may make the last state again
  finish();
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

void remove_checkpoint(const std::string& path) {
  std::error_code none;
  if (path.empty()) return;
  std::filesystem::remove(path, none);
  std::filesystem::remove(path + ".journal", none);
  std::filesystem::remove(path + ".tmp", none);
}

std::vector<uint64_t> asked_steps(const RunRequest& request) {
  std::vector<uint64_t> steps = request.frames;
  steps.insert(steps.end(), request.probes.begin(), request.probes.end());
  if (request.totals || request.energies) steps.insert(steps.end(), {0, request.steps});
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  return steps;
}

bool asks_for_last(const RunRequest& request) {
  return request.totals || request.energies || !request.frames.empty();
}

void give(const RunRequest& request, RunState state, Trace& trace) {
  if (request.keep)
    request.keep(state);
  else if (State* fixed = std::get_if<State>(&state))
    trace.frames.push_back(std::move(*fixed));
  else
    trace.bodies.push_back(std::move(std::get<RealFrame>(state)));
}

Recorded record(const Scene& scene, const EngineKind& kind, const RunRequest& request) {
  if (!kind.relaxes) refuse_static(scene, fmt::format("the {} engine", kind.name));
  if (!kind.deforms) refuse_deform(scene, fmt::format("the {} engine", kind.name));
  return Loop(scene, kind, request).run();
}

namespace {
constexpr const char* kChange = "momentum_change";
constexpr const char* kSpeed = "largest_speed";
}  // namespace

void put_totals(Recorded& run) {
  run.trace.counters.emplace_back(kChange, run.momentum_change);
  run.trace.counters.emplace_back(kSpeed, run.largest_speed);
}

void take_totals(Recorded& run) {
  Counters& counters = run.trace.counters;
  const auto take = [&](const char* name, double& to) {
    const auto at =
        std::find_if(counters.begin(), counters.end(), [&](const auto& c) { return c.first == name; });
    if (at == counters.end()) return;
    to = at->second;
    counters.erase(at);
  };
  take(kChange, run.momentum_change);
  take(kSpeed, run.largest_speed);
}

}  // namespace cuboct
