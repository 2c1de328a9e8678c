// SPDX-License-Identifier: MIT
#include "python/simulation.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/run/advice.h"
#include "cli/run/estimate.h"
#include "cli/run/outputs.h"
#include "hw/engine/engine_kind.h"
#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"
#include "model/analysis/crack.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/base/spelling.h"
#include "model/run/golden_engine.h"
#include "model/run/rounds_run.h"
#include "model/scene/static_loading.h"
#include "model/trace/raster_plot.h"
#include "python/catch_interrupt.h"
#include "python/program_engine.h"
#include "python/program_integers.h"
#include "python/program_reals.h"

namespace cuboct::python {
namespace {

void check_size(const Loaded& loaded, const std::string& engine, const EngineOptions& options) {
  RunSize size = run_size(loaded.scene, loaded.scene.steps);
  size.engine = engine;
  size.steps = 0;
  size.threads = options.threads;
  check_fits(loaded.scene, size, estimate(loaded.scene, loaded.setup.plan, size), "");
}

// The name of what imposes or steers a type's motion: its own is "material/constraint".
std::string constraint_of(const ParticleType& type) {
  const size_t at = type.name.find('/');
  return at == std::string::npos ? "" : type.name.substr(at + 1);
}

void give_velocity(Rule& rule, const std::string& constraint, const Vec3& velocity) {
  std::vector<std::string> names;
  bool found = false;
  for (ParticleType& type : rule.types) {
    const std::string name = constraint_of(type);
    if (!name.empty()) names.push_back(name);
    if (name != constraint || name.empty()) continue;
    found = true;
    for (int a = 0; a < 3; ++a)
      if (is_free(type, a) && velocity[a] != 0)
        throw InputError(
            fmt::format("the velocity has a part along {}, which '{}' leaves free", "xyz"[a], constraint));
    type.velocity = velocity;
  }
  if (found) return;
  const std::string near = did_you_mean(constraint, names);
  throw InputError(fmt::format("no particle is held or moved by a constraint '{}'", constraint),
                   !near.empty()   ? near
                   : names.empty() ? "the scene has no constraints"
                                   : "one of " + list_of(names));
}

std::string text_of(const Vec3& value) {
  return fmt::format("[{:g}, {:g}, {:g}]", value[0], value[1], value[2]);
}

void check_finite(const Vec3& value, const char* what) {
  if (!value.allFinite()) throw InputError(fmt::format("{} is not finite", what));
}

}  // namespace

Simulation::Simulation(const Sources& sources, const std::string& engine, const EngineOptions& options,
                       std::optional<uint64_t> probe_every, bool anyway)
    : engine_name_(engine), options_(options), sources_(sources) {
  if (!engine.empty()) options.check({engine_row(engine).name}, {});
  Loaded loaded = load_plan(sources, false, engine, options.is_real(engine));
  if (engine.empty()) engine_name_ = engine_for(loaded.scene);
  options.check({engine_name_}, {});
  check_runs(loaded.scene, loaded.setup.plan.arch, engine_name_);
  options.check(loaded.setup.plan);
  options_.anyway = anyway;
  check_workers(options.threads, options.ranks, anyway, loaded.setup.plan);
  if (!anyway) check_size(loaded, engine_name_, options);
  real_ = options.is_real(engine_name_);
  text_ = loaded.setup.plan.program != nullptr;
  program_ = engine_row(engine_name_).here == Here::none || options.ranks > 1;
  scene_ = std::move(loaded.scene);
  setup_ = std::move(loaded.setup);
  probe_every_ = whole_steps(scene_, probe_every.value_or(scene_.probe_every));
  energy_every_ = probe_every ? probe_every_ : scene_.energy_every;
  if (real_)
    start_ = scene_.body;
  else
    setup_.initial = begin_of(scene_, setup_.plan, nullptr);
  try {
    make_engine();
  } catch (const StepError& error) {
    throw Stopped(error.reason, "");
  }
  const EngineKind kind = real_ ? real_kind(engine_name_, scene_, setup_.plan, false)
                                : fixed_kind(engine_name_, scene_, setup_.plan);
  meter_.emplace(scene_, kind.initial, MeterOptions{.energies = true, .threads = options.threads});
  if (probe_every_ > 0) read_probes(true);
}

void Simulation::make_engine() {
  engine_.reset();
  reading_.reset();
  present_.reset();
  const Plan& plan = setup_.plan;
  const Here here = engine_row(engine_name_).here;
  if (text_) {
    engine_ = with_places(scene_, plan.arch, [&] { return engine_of_text(); });
  } else if (program_ && real_) {
    engine_ = std::make_unique<ProgramReals>(sources_, engine_name_, options_, scene_, setup_);
  } else if (program_) {
    engine_ = std::make_unique<ProgramEngine>(sources_, engine_name_, options_, scene_, setup_);
  } else if (here == Here::reference) {
    RealOptions real = options_.real_options();
    real.threads = options_.threads > 0 ? options_.threads : reference_threads(start_.size());
    engine_ = scene_reference(scene_, start_, real, plan.rule.cell_edge, first_step_, own_);
  } else if (here == Here::golden) {
    engine_ = std::make_unique<GoldenEngine>(setting_of(scene_, plan, options_.threads), plan.arch.capacity,
                                             setup_.initial);
  } else {
    lattice_.engine.threads = options_.threads;
    lattice_.from = &setup_.initial;
    engine_ = emu::lattice_kind(scene_, plan, lattice_).make(nullptr, false);
  }
}

std::unique_ptr<Engine> Simulation::engine_of_text() {
  const Plan& plan = setup_.plan;
  if (program_)
    return integer_run(scene_, plan, setup_.initial, [&](const State& state) {
      return std::make_unique<ProgramIntegers>(sources_, engine_name_, options_, scene_, plan, state);
    });
  if (engine_row(engine_name_).here == Here::golden) return integer_run(scene_, plan, setup_.initial);
  emu::LatticeOptions lattice;
  lattice.threads = options_.threads;
  lattice.rule_code = emu::rule_code_of(options_.rule_code);
  return integer_run(scene_, plan, setup_.initial,
                     [&](const State& state) { return emu::integer_lattice(plan, state, lattice); });
}

// Engines may lose their state in a step that fails: what was done is done again, to the same bits.
void Simulation::stop(const StopReason& reason) {
  if (!program_) {
    make_engine();
    while (now() < reason.step) engine_->advance(1);
  }
  throw Stopped(reason, real_ ? "" : advice_on(reason, setup_.plan, scene_));
}

void Simulation::advance(uint64_t steps) {
  const uint64_t before = now();
  reading_.reset();
  present_.reset();
  try {
    engine_->advance(steps);
  } catch (const RunError& e) {
    stop({e.fault, program_ ? e.step : before, e.cell, e.particle, e.number, e.what()});
  } catch (const StepError& error) {
    StopReason reason = error.reason;
    if (!program_) reason.step = before;
    stop(reason);
  }
}

// Steps at once: a program costs its start, and what stands in between is asked for at probes alone.
uint64_t Simulation::piece(uint64_t steps) const {
  if (!program_) return 1;
  return probe_every_ > 0 ? std::min(steps, probe_every_ - now() % probe_every_) : steps;
}

void Simulation::step(uint64_t steps) {
  const std::lock_guard lock(mutex_);
  go_to(now() + steps, false);
}

void Simulation::run() {
  const std::lock_guard lock(mutex_);
  go_to(scene_.steps, true);
}

// Whether the last reading of the probes says that the scene's run is over.
bool Simulation::is_over() const {
  if (!scene_.until || now() <= scene_.until->after) return false;
  const std::optional<double> value = meter_->latest_of(scene_.until->curve);
  return value && scene_.until->holds(*value);
}

void Simulation::go_to(uint64_t end, bool until) {
  const CatchForHost catching;
  while (now() < end && !(until && is_over())) {
    if (interrupted()) throw Interrupted();
    const uint64_t asked = piece(end - now()), wanted = now() + asked;
    advance(asked);
    if (now() < wanted) continue;  // an interrupt
    if (probe_every_ > 0 && now() % probe_every_ == 0)
      read_probes(now() == scene_.steps || (energy_every_ > 0 && now() % energy_every_ == 0));
  }
  if (interrupted()) throw Interrupted();
}

const Reading& Simulation::reading() {
  if (!reading_) reading_ = engine_->read(meter_->asked({}, false, now()));
  return *reading_;
}

void Simulation::read_probes(bool energies) {
  const Meter::Parts parts{.energies = energies};
  meter_->add(energies || reading_ ? reading() : engine_->read(meter_->asked(parts, false, now())), parts);
}

const Body& Simulation::present() {
  if (present_) return *present_;
  RunState frame = engine_->frame(false);
  if (const State* state = std::get_if<State>(&frame)) {
    const Plan& plan = setup_.plan;
    present_ = to_real(*state, plan.rule, plan.lattice, plan.origin);
  } else {
    RealFrame& real = std::get<RealFrame>(frame);
    present_ = Body{std::move(real.x), std::move(real.v), {}, scene_.body.type, nullptr};
  }
  return *present_;
}

uint64_t Simulation::step_count() {
  const std::lock_guard lock(mutex_);
  return now();
}

Body Simulation::body() {
  const std::lock_guard lock(mutex_);
  return present();
}

uint64_t Simulation::hash() {
  const std::lock_guard lock(mutex_);
  return engine_->hash();
}

uint64_t Simulation::plan_hash() {
  const std::lock_guard lock(mutex_);
  return setup_.plan.hash;
}

EnergiesNow Simulation::energies() {
  const std::lock_guard lock(mutex_);
  EnergiesNow result{reading().energies, {}};
  const Thermometer thermometer(scene_);
  if (thermometer.wanted()) result.temperature = thermometer.temperature(result.of.free);
  return result;
}

std::vector<Curve> Simulation::curves() {
  const std::lock_guard lock(mutex_);
  return meter_->curves();
}

void Simulation::leave(const std::string& directory) {
  const std::lock_guard lock(mutex_);
  const Plan& plan = setup_.plan;
  TraceHead head{scene_, nullptr, nullptr, plan.origin, plan.arch.text};
  if (!real_ && !text_) head.rule = &plan.rule, head.lattice = &plan.lattice;
  Trace rest;
  rest.engine = engine_name_;
  rest.plan_hash = plan.hash;
  rest.nodes = plan.nodes();
  rest.steps_done = now();
  if (const Body* body = engine_->saved_body(); body && body->bonds) rest.bonds = body->bonds->kept;
  leave_state(directory, head, engine_->frame(false), rest);
}

// What was changed has another plan than the scene: its states are then shown in real numbers.
Shown Simulation::shown() {
  const std::lock_guard lock(mutex_);
  Shown shown{sources_, changed_ ? "reference" : engine_name_, real_ || changed_, {}, {}};
  RunState state = engine_->frame(false);
  if (changed_ && std::holds_alternative<State>(state)) {
    const Body& body = present();
    state = RealFrame{now(), body.x, body.v, {}, {}};
  }
  Trace& trace = shown.trace;
  trace.engine = engine_name_;
  trace.plan_hash =
      changed_ ? load_plan(sources_, false, "reference", true).setup.plan.hash : setup_.plan.hash;
  trace.nodes = setup_.plan.nodes();
  trace.steps_done = now();
  trace.curves = meter_->curves();
  // A trace of integers has hashes. That of step 0 is not known here, and no page shows it.
  if (!shown.real) {
    trace.hash_every = now() + 2;
    if (now() > 0) trace.state_hash.push_back(0);
    trace.state_hash.push_back(engine_->hash());
  }
  shown.states.push_back(std::move(state));
  return shown;
}

Fields Simulation::fields() {
  const std::lock_guard lock(mutex_);
  if (auto* program = dynamic_cast<ProgramReals*>(engine_.get())) return program->fields();
  auto* rounds = dynamic_cast<RoundsRun*>(engine_.get());
  if (rounds == nullptr) return {};
  return rounds->shown();
}

std::vector<std::string> Simulation::type_names() const {
  std::vector<std::string> names;
  for (const ParticleType& type : scene_.rule.types) names.push_back(type.name);
  return names;
}

std::vector<double> Simulation::type_masses() const {
  std::vector<double> masses;
  for (size_t k = 0; k < scene_.rule.types.size(); ++k)
    masses.push_back(scene_.rule.mass_of(static_cast<int>(k)));
  return masses;
}

void Simulation::set_velocity(const std::string& constraint, const Vec3& velocity) {
  check_finite(velocity, "the velocity");
  change(fmt::format("set_velocity('{}', {})", constraint, text_of(velocity)),
         [&](Rule& rule) { give_velocity(rule, constraint, velocity); });
}

void Simulation::set_gravity(const Vec3& gravity) {
  check_finite(gravity, "gravity");
  change(fmt::format("set_gravity({})", text_of(gravity)), [&](Rule& rule) {
    for (ParticleType& type : rule.types) type.gravity = gravity + type.pull;
  });
}

// All that can be refused is, before anything changes. What is wrong stands in the call, not in the scene.
void Simulation::change(const std::string& call, const std::function<void(Rule&)>& edit) {
  const std::lock_guard lock(mutex_);
  if (program_)
    throw InputError(
        fmt::format("the {} engine is a program that reads the scene: nothing of it can change on the way",
                    engine_name_),
        "golden and lattice take changes, and have the same bits");
  Scene changed = scene_;
  edit(changed.rule);
  const auto of_call = [&](auto check) {
    try {
      check();
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", call, bare_message(error)), parts_of(error).hint);
    }
  };
  if (changed.loading) of_call([&] { refuse_tearing(changed, *changed.loading); });
  strain();  // its initial positions are those of the plan so far
  if (real_) {
    start_ = *engine_->saved_body();
    own_ = engine_->memory().own;
  } else {
    const RunState frame = engine_->integers();
    const State& state = std::get<State>(frame);
    const Plan& plan = setup_.plan;
    changed.body = to_real(state, plan.rule, plan.lattice, plan.origin);
    of_call([&] { setup_ = going_on(changed, plan, state, scene_.body); });
  }
  first_step_ = now();
  changed_ = true;
  scene_.rule = std::move(changed.rule);
  make_engine();
}

StrainMeter& Simulation::strain() {
  if (strain_) return *strain_;
  if (real_ || text_) return strain_.emplace(strain_meter(scene_, scene_.packing().x));
  std::vector<Vec3> initial;
  initial.reserve(scene_.body.size());
  for (uint32_t id = 0; id < scene_.body.size(); ++id)
    initial.push_back(packed_place(scene_, setup_.plan, id));
  return strain_.emplace(strain_meter(scene_, initial));
}

std::string Simulation::picture(const std::string& field, double limit, int width) {
  const std::lock_guard lock(mutex_);
  const int axis = strain_axis(scene_);
  const Body& body = present();
  strain().set_box(scene_.box_at(now()));
  Frame frame{now(),     static_cast<double>(now()) * dt(), body.x, body.v,
              body.type, strain().axial(body.x, axis)};
  frame.broken = strain().broken(
      body.x, [&](uint32_t i, uint32_t j) { return bond_reach(scene_.rule, body.type[i], body.type[j]); });
  const double radius = frame_style(scene_).radius;
  const RasterGrid whole = raster_grid(frame, radius, static_cast<uint32_t>(width));
  const RasterGrid grid = part_of(whole, window_of(frame, whole, radius));
  const Rasters rasters{scene_.title, axis, 2 * radius, grid, {rasterise(frame, grid, radius)}};
  return plot_rasters(rasters, {field_of(field), {0}, limit, width});
}

}  // namespace cuboct::python
