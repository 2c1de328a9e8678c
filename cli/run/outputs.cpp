// SPDX-License-Identifier: MIT
#include "cli/run/outputs.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <filesystem>
#include <sstream>
#include <variant>

#include "hw/engine/engine_kind.h"
#include "model/analysis/crack.h"
#include "model/analysis/measure.h"
#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/input_file.h"
#include "model/base/output.h"
#include "model/config/config.h"
#include "model/rules/rounds_rule.h"
#include "model/trace/guarded_trace.h"
#include "model/trace/trace_file.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

std::string relative_to(const std::string& directory, const std::string& path) {
  return path.empty() ? path : fs::relative(fs::absolute(path), fs::absolute(directory)).generic_string();
}

}  // namespace

int strain_axis(const Scene& scene) {
  int axis = 0;
  for (const Probe& probe : scene.probes)
    if (probe.kind == Probe::Kind::stress_strain) return probe.axis.cwiseAbs().maxCoeff(&axis), axis;
  const std::vector<Vec3>& places = scene.packing().x;
  if (places.empty()) return 0;
  Vec3 lower = places[0], upper = lower;
  for (const Vec3& x : places) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  (upper - lower).maxCoeff(&axis);
  return axis;
}

StrainMeter strain_meter(const Scene& scene, const std::vector<Vec3>& initial) {
  return {initial, scene.packing_box(), first_shell(scene)};
}

FrameMaker::FrameMaker(const Loaded& loaded, bool whole)
    : loaded_(loaded), axis_(strain_axis(loaded.scene)), whole_(whole) {}

const StrainMeter& FrameMaker::meter(bool fixed, const Frame& frame) const {
  StrainMeter& meter = this->meter(fixed);
  meter.set_box(frame.box ? *frame.box : loaded_.scene.periodic);
  return meter;
}

StrainMeter& FrameMaker::meter(bool fixed) const {
  std::optional<StrainMeter>& meter = fixed ? fixed_ : real_;
  if (meter) return *meter;
  const Scene& scene = loaded_.scene;
  const Plan& plan = loaded_.setup.plan;
  if (!fixed) return meter.emplace(strain_meter(scene, scene.packing().x));
  std::vector<Vec3> initial;  // without a State: see load_plan
  initial.reserve(scene.body.size());
  for (uint32_t id = 0; id < scene.body.size(); ++id) initial.push_back(packed_place(scene, plan, id));
  return meter.emplace(strain_meter(scene, initial));
}

void FrameMaker::measure(Frame& frame, bool fixed) const {
  const auto reach = [&](uint32_t i, uint32_t j) {
    return bond_reach(loaded_.scene.rule, frame.type[i], frame.type[j]);
  };
  const StrainMeter& meter = this->meter(fixed, frame);
  if (!whole_) {
    frame.strain = meter.axial(frame.x, axis_);
    frame.broken = meter.broken(frame.x, reach);
    return;
  }
  for (const Deformation& one : meter.deformations(frame.x, axis_, reach)) {
    frame.strain.push_back(one.axial);
    frame.tensor.push_back(one.strain);
    frame.broken.push_back(one.broken);
  }
}

Frame frame_of(const Loaded& loaded, const State& state) {
  const Plan& plan = loaded.setup.plan;
  Body body = to_real(state, plan.rule, plan.lattice, plan.origin);
  return {state.step, static_cast<double>(state.step) * plan.rule.dt, std::move(body.x), std::move(body.v),
          std::move(body.type)};
}

Frame frame_of(const Loaded& loaded, const RealFrame& real) {
  const Scene& scene = loaded.scene;
  Frame frame{real.step, static_cast<double>(real.step) * scene.rule.dt, real.x, real.v, scene.body.type};
  frame.own = real.shown;
  if (scene.deform) frame.box = scene.box_at(real.step);
  return frame;
}

Frame FrameMaker::make(const State& state) const {
  Frame frame = frame_of(loaded_, state);
  measure(frame, true);
  return frame;
}

Frame FrameMaker::make(const RealFrame& real) const {
  Frame frame = frame_of(loaded_, real);
  measure(frame, false);
  return frame;
}

FrameStyle frame_style(const Scene& scene) {
  FrameStyle style;
  style.periodic = scene.periodic;
  style.radius = (scene.pitch > 0 ? scene.pitch : scene.rule.cutoff()) / 2;
  style.reduced = scene.boltzmann == 1;
  const RoundsRule* rounds = scene.rule.rounds.get();
  for (size_t k = 0; k < scene.rule.types.size(); ++k)
    style.types.push_back(frame_type(scene.rule.types[k].name, scene.rule.mass_of(static_cast<int>(k)),
                                     rounds ? rounds->element() : ""));
  if (rounds)
    for (const RuleField& field : rounds->declaration().shown) {
      FrameField own{field.name, field.unit};
      if (field.numbers == 3) own.components = kVectorNames;
      if (field.numbers == 6) own.components = kTensorNames;
      style.own.push_back(std::move(own));
    }
  return style;
}

TraceHead head_of(const Loaded& loaded, bool real, bool si) {
  const Plan& plan = loaded.setup.plan;
  TraceHead head{loaded.scene, nullptr, nullptr, plan.origin, plan.arch.text, si};
  if (!real) head.rule = &plan.rule, head.lattice = &plan.lattice;
  return head;
}

void leave_state(const std::string& directory, const TraceHead& head, const RunState& last,
                 const Trace& rest) {
  make_directory(directory);
  const std::string path = directory + "/trace.h5";
  TraceWriter writer(path, temporary_beside(path), false, &head);
  std::visit([&](const auto& state) { writer.add(state); }, last);
  writer.finish(rest);
}

void write_record(const std::string& directory, const RunRecord& record) {
  toml::table table{{"scene", relative_to(directory, record.scene)},
                    {"arch", relative_to(directory, record.arch)},
                    {"engine", record.engine},
                    {"state", record.state}};
  if (!record.stage.empty()) table.insert("stage", record.stage);
  if (record.reached) table.insert("reached", true);
  if (!record.from.empty()) table.insert("from", relative_to(directory, record.from));
  std::ostringstream text;
  text << table << '\n';
  write_text(directory + "/run.toml", text.str());
}

RunRecord read_record(const std::string& directory) {
  const std::string path = directory + "/run.toml";
  if (!is_file(path))
    throw InputError(fmt::format("{} holds no run: no file run.toml", directory),
                     "'cuboct run SCENE --out DIR' makes one");
  try {
    const toml::table table = toml::parse_file(path);
    const auto from = [&](const char* key) {
      const std::string value = table[key].value_or(std::string());
      return value.empty() ? value : (fs::path(directory) / value).lexically_normal().string();
    };
    // A directory of before there were states holds a run that came to its end.
    RunRecord record{from("scene"),
                     from("arch"),
                     table["engine"].value_or(std::string()),
                     table["state"].value_or(std::string("finished")),
                     table["stage"].value_or(std::string()),
                     from("from"),
                     table["reached"].value_or(false)};
    // A stranger's record may name what never ends, as a device.
    for (const auto& [key, file] : {std::pair{"scene", record.scene}, {"arch", record.arch}})
      if ((key[0] == 's' || !file.empty()) && !is_file(file))
        throw InputError(fmt::format("{}: '{}' names no file: '{}'", path, key, file),
                         "paths count from the directory of run.toml");
    return record;
  } catch (const toml::parse_error& error) {
    const auto at = error.source().begin;
    const int line = static_cast<int>(at.line), column = static_cast<int>(at.column);
    throw InputError(path, line, column, std::string(error.description()), {},
                     excerpt(line_of(read_config_text(path), line), line, column));
  }
}

Trace read_run(const std::string& directory, const RunRecord& record) {
  const std::string file = directory + "/trace.h5";
  if (!is_file(file))
    throw InputError(
        fmt::format("{} holds no trace.h5: its run is '{}'", directory, record.state),
        "a trace is there when the run has ended; --resume goes on with one that kept a checkpoint");
  return guarded_trace(file);
}

Loaded scene_of_run(const std::string& directory, const RunRecord& record, const Trace& trace) {
  Input input{record.scene, record.arch};
  input.stage = record.stage;
  input.from = record.from;
  Loaded loaded = load_plan(input, record.engine, trace.state_hash.empty());
  if (trace.plan_hash != loaded.setup.plan.hash)
    throw InputError(fmt::format("{}/trace.h5 was made by plan {:016x}, but {} now gives plan {:016x}",
                                 directory, trace.plan_hash, record.scene, loaded.setup.plan.hash),
                     "run the scene again");
  return loaded;
}

bool is_over(const RunRecord& record) { return record.state == "finished" || record.state == "stopped"; }

}  // namespace cuboct
