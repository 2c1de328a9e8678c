// SPDX-License-Identifier: MIT
#include "gpu_ref/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>

#include "model/analysis/energy_curves.h"
#include "model/analysis/watch.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"
#include "model/real/reference.h"

namespace cuboct::gpu {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

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
  Loop(const Scene& scene, const Plan& plan, const GpuRun& request);
  GpuResult run();

 private:
  bool fixed() const { return request_.arithmetic == Arithmetic::fixed; }
  std::vector<Vec3> initial_positions() const;
  void make_engine();
  void go();
  void advance(uint64_t steps);
  void record();
  void sample(const Reading& reading);
  // The state, for a look at it and for a frame.
  void take(bool look, bool keep);
  void look_at(const State& state);
  void look_at(const Body& body);
  void keep(Body body);
  void probe_for_curves() { engine_->probe(ids_); }
  void finish();
  void count();

  const Scene& scene_;
  const Plan& plan_;
  const GpuRun& request_;
  const std::vector<uint64_t> looks_;
  const std::vector<uint32_t> ids_;  // probed particles
  ProbeMeter probes_;
  EnergyCurves energy_;
  std::optional<Watch> watch_;
  std::unique_ptr<Engine> engine_;
  Int3 momentum_{};           // fixed, of the initial state
  uint64_t piece_ = 1;        // steps between two looks at the clock, where somebody looks
  double largest_speed_ = 0;  // m/s
  GpuResult result_;
  Trace& trace_;
};

Loop::Loop(const Scene& scene, const Plan& plan, const GpuRun& request)
    : scene_(scene),
      plan_(plan),
      request_(request),
      looks_(request.watch ? looks_of(request.probes, scene.body.size()) : std::vector<uint64_t>()),
      ids_(probed_ids(scene.probes)),
      probes_(placed(scene.probes, ids_), scene.periodic, initial_positions()),
      energy_(request.energies, scene),
      trace_(result_.trace) {
  trace_.engine = "gpu";
  trace_.plan_hash = plan.hash;
  trace_.nodes = plan.nodes();
  trace_.hash_every = fixed() ? request.hash_every : 1;
  trace_.notes.emplace_back("precision", to_string(request.arithmetic));
  if (!request.energies) return;
  if (request.watch) watch_.emplace(scene, fixed() ? plan.rule.error.worst_force : 0);
}

// Of the probed particles, in the engine's arithmetic.
std::vector<Vec3> Loop::initial_positions() const {
  std::vector<Vec3> x;
  for (const uint32_t id : ids_)
    x.push_back(fixed()
                    ? position_of(plan_.rule, plan_.lattice, plan_.origin,
                                  fixed_particle(scene_.body, id, plan_.rule, plan_.lattice, plan_.origin))
                    : scene_.body.x[id]);
  return x;
}

void Loop::make_engine() {
  if (fixed()) {
    const State initial = to_fixed(scene_.body, plan_.rule, plan_.lattice, plan_.origin);
    momentum_ = momentum(initial);
    engine_ = make_fixed_engine(scene_, plan_, initial, request_.engine);
  } else {
    engine_ = make_real_engine(scene_, scene_.body, request_.arithmetic, request_.engine);
  }
  probe_for_curves();
}

void Loop::advance(uint64_t steps) {
  const uint64_t before = engine_->step_count();
  const auto begin = Clock::now();
  const auto done = [&] {
    trace_.seconds += since(begin);
    trace_.steps_done = engine_->step_count();
    if (request_.hooks.did) request_.hooks.did(trace_.steps_done - before);
  };
  try {
    engine_->advance(steps, fixed() && request_.hash_every == 1 ? &trace_.state_hash : nullptr);
  } catch (const RunError&) {
    done();
    throw;
  } catch (const LostPosition&) {
    done();
    throw;
  }
  done();
}

void Loop::look_at(const State& state) {
  const std::vector<Int3> kicks = summed_kicks(plan_.rule, plan_.lattice, state);
  ClosestPair closest;
  const Energies e =
      energies(scene_.rule, plan_.rule, plan_.lattice, plan_.origin, state, kicks, 0, &closest);
  watch_->see(plan_.rule, plan_.lattice, plan_.origin, state, kicks, e, closest);
}

void Loop::look_at(const Body& body) {
  RealOptions options;
  options.precision = request_.arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64;
  options.threads = reference_threads(body.size());
  const Reference here(scene_.rule, body, scene_.periodic, options);
  watch_->see(engine_->step_count(), body, here.forces(), engine_->read(true).energies);
}

void Loop::keep(Body body) {
  RealFrame frame{engine_->step_count(), std::move(body.x), std::move(body.v), {}};
  if (request_.forces) {
    std::vector<uint32_t> all(frame.x.size());
    std::iota(all.begin(), all.end(), 0);
    engine_->probe(all);
    frame.force = engine_->read(false).force;
    probe_for_curves();
  }
  trace_.bodies.push_back(std::move(frame));
}

void Loop::take(bool look, bool keep_it) {
  look &= watch_.has_value();
  if (!look && !keep_it) return;
  if (fixed()) {
    State state = engine_->state();
    if (look) look_at(state);
    if (keep_it) trace_.frames.push_back(std::move(state));
  } else {
    Body body = engine_->body();
    body.type = scene_.body.type;
    if (look) look_at(body);
    if (keep_it) keep(std::move(body));
  }
}

void Loop::sample(const Reading& reading) {
  largest_speed_ = std::max(largest_speed_, reading.largest_speed);
  if (!scene_.probes.empty()) probes_.add({engine_->step_count(), reading.x, reading.force});
  energy_.add(engine_->step_count(), reading.energies,
              [&] { return Mat3(Mat3::Identity() * (-reading.virial / (3 * energy_.volume()))); });
}

void Loop::record() {
  const uint64_t step = trace_.steps_done;
  if (fixed() && step % request_.hash_every == 0 && (request_.hash_every > 1 || step == 0))
    trace_.state_hash.push_back(engine_->hash());
  if (among(request_.probes, step)) sample(engine_->read(request_.energies));
  take(among(looks_, step), among(request_.frames, step));
}

void Loop::go() {
  record();
  Progress progress("gpu", request_.steps, plan_.particles, 0, request_.progress);
  const bool in_pieces = request_.progress || stderr_is_terminal() || request_.hooks.did;
  while (trace_.steps_done < request_.steps && !interrupted()) {
    const uint64_t step = trace_.steps_done;
    uint64_t to = sooner(request_.frames, step, sooner(request_.probes, step, request_.steps));
    if (fixed() && request_.hash_every > 1)
      to = std::min(to, (step / request_.hash_every + 1) * request_.hash_every);
    const auto begin = Clock::now();  // a piece is long beside what a batch costs to start
    advance(in_pieces ? std::min(to - step, piece_) : to - step);
    record();
    if (since(begin) < 0.1) piece_ *= 2;
    progress.at(trace_.steps_done);
  }
  result_.interrupted = trace_.steps_done < request_.steps;
}

// The last state is part of every answer, also of a run that ended early: its hash, its frame, its energies.
void Loop::finish() {
  const uint64_t last = trace_.steps_done;
  if (fixed() && last % request_.hash_every != 0) trace_.state_hash.push_back(engine_->hash());
  if (request_.energies && !among(request_.probes, last)) sample(engine_->read(true));
  take(request_.watch && !among(looks_, last), !request_.frames.empty() && !among(request_.frames, last));
  trace_.curves = probes_.curves();
  trace_.curves.insert(trace_.curves.end(), energy_.curves().begin(), energy_.curves().end());
  if (watch_) {
    watch_->conclude();
    trace_.findings = watch_->findings();
    trace_.watched = watch_->last_step();
  }
  if (request_.totals) {
    if (!request_.energies) largest_speed_ = std::max(largest_speed_, engine_->read(true).largest_speed);
    double change = 0;
    if (fixed()) {
      const bool kept = !trace_.frames.empty() && trace_.frames.back().step == last;
      const Int3 after = momentum(kept ? trace_.frames.back() : engine_->state());
      for (int a = 0; a < 3; ++a)
        change = std::max(change, static_cast<double>(std::abs(after[a] - momentum_[a])));
    } else {
      const auto sum = [](const std::vector<Vec3>& v) {
        return std::accumulate(v.begin(), v.end(), Vec3(Vec3::Zero()));
      };
      const bool kept = !trace_.bodies.empty() && trace_.bodies.back().step == last;
      const Vec3 after = sum(kept ? trace_.bodies.back().v : engine_->body().v);
      change = scene_.rule.mass * (after - sum(scene_.body.v)).norm();
    }
    trace_.counters.emplace_back("momentum_change", change);
    trace_.counters.emplace_back("largest_speed", largest_speed_ * scene_.rule.dt / plan_.rule.cell_edge);
  }
  count();
  if (request_.hooks.finish) request_.hooks.finish(trace_);
}

void Loop::count() {
  const Counters& counters = engine_->counters();
  const auto add = [&](const char* name, double value) { trace_.counters.emplace_back(name, value); };
  add("list_builds", static_cast<double>(counters.list_builds));
  if (fixed()) add("golden_steps", static_cast<double>(counters.golden_steps));
  add("longest_list", static_cast<double>(counters.longest_list));
  add("listed_pairs", counters.listed_pairs);
  add("halo_particles", static_cast<double>(counters.halo_particles));
  add("device_bytes", static_cast<double>(counters.device_bytes));
}

GpuResult Loop::run() {
  try {
    make_engine();
    if (request_.hooks.ready) request_.hooks.ready();
    go();
  } catch (const RunError& error) {
    trace_.stop = StopReason{error.fault, error.step, error.cell, error.particle, error.number, error.what()};
  } catch (const LostPosition& error) {
    trace_.stop = StopReason{Fault::none, error.step, 0, error.particle, 0, error.what()};
  }
  if (engine_) finish();
  return std::move(result_);
}

}  // namespace

GpuResult run_gpu(const Scene& scene, const Plan& plan, const GpuRun& request) {
  return Loop(scene, plan, request).run();
}

}  // namespace cuboct::gpu
