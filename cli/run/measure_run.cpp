// SPDX-License-Identifier: MIT
#include "cli/run/measure_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "model/base/error.h"
#include "model/base/json.h"
#include "model/base/units.h"
#include "model/contract/state.h"

namespace cuboct {
namespace {

constexpr Quantity kVolume{{{0, 3, 0, 0}}, "a volume", "1 mm^3"};

}  // namespace

Measured measure_snapshots(
    const Scene& scene, const std::vector<uint64_t>& steps, const std::function<Snapshot(size_t k)>& snapshot,
    const MeasureAsked& asked,
    const std::function<void(size_t k, const Snapshot&, const MeasuredParticles&)>& see) {
  const std::unique_ptr<Measure> measure = make_measure(asked.name, scene, asked.choice);
  if (steps.empty())
    throw InputError("the run kept no frames",
                     "'cuboct run' keeps the first and the last, and without --no-states in the trace");
  if (see && measure->particles() == nullptr)
    throw InputError(fmt::format("{} has nothing of each particle", asked.name),
                     "msd, coordination, cna and stress have");
  const std::vector<size_t> chosen =
      chosen_frames(steps, asked.frames.empty() ? usual_frames(asked.name) : asked.frames);
  for (const size_t k : chosen) {
    const Snapshot now = snapshot(k);
    measure->add(now);
    if (see) see(k, now, *measure->particles());
  }
  Measured out = measure->result();
  const uint64_t first = steps[chosen.front()], last = steps[chosen.back()];
  out.notes.emplace(out.notes.begin(), "frames",
                    chosen.size() == 1
                        ? fmt::format("1 of {}, step {}", steps.size(), last)
                        : fmt::format("{} of {}, steps {} to {}", chosen.size(), steps.size(), first, last));
  return out;
}

double velocities_late(const Trace& trace, double dt) {
  const auto of = std::ranges::find(trace.notes, "integrator", &std::pair<std::string, std::string>::first);
  return of != trace.notes.end() && of->second == "velocity Verlet" ? 0 : dt / 2;
}

// The reference engine alone lets positions leave the box, in motion and in static loading.
bool stands_in_box(const Trace& trace) { return trace.engine != "reference"; }

Measured measure_trace(const Loaded& loaded, const Trace& trace, const MeasureAsked& asked,
                       const SeeParticles& see) {
  const Scene& scene = loaded.scene;
  const bool real = trace.frames.empty();
  std::vector<uint64_t> steps;
  for (const State& state : trace.frames) steps.push_back(state.step);
  for (const RealFrame& frame : trace.bodies) steps.push_back(frame.step);
  const double late = velocities_late(trace, scene.rule.dt);
  const bool wrapped = stands_in_box(trace);
  const auto snapshot = [&](size_t k) {
    Snapshot now{steps[k], {}, wrapped, late};
    if (real) {
      const RealFrame& frame = trace.bodies[k];
      now.body.x = frame.x, now.body.v = frame.v, now.body.u = frame.u, now.body.type = scene.body.type;
    } else {
      const Plan& plan = loaded.setup.plan;
      now.body = to_real(trace.frames[k], plan.rule, plan.lattice, plan.origin);
      now.body.exact = nullptr;
    }
    return now;
  };
  if (!see) return measure_snapshots(scene, steps, snapshot, asked);
  return measure_snapshots(
      scene, steps, snapshot, asked, [&](size_t k, const Snapshot& now, const MeasuredParticles& particles) {
        see(real ? KeptFrame(&trace.bodies[k]) : KeptFrame(&trace.frames[k]), now, particles);
      });
}

namespace {

std::string number_of(const MeasuredColumn& column, size_t row) {
  const double value = column.values[row];
  return column.whole ? fmt::format("{}", static_cast<uint64_t>(value)) : fmt::format("{}", value);
}

}  // namespace

std::string csv_of(const Measured& measured, bool units) {
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  const char* comma = "";
  for (const MeasuredColumn& column : measured.columns) {
    fmt::format_to(to, "{}{}", comma, column.name);
    if (units && column.unit != "1") fmt::format_to(to, " ({})", column.unit);
    comma = ",";
  }
  for (size_t row = 0; row < measured.columns[0].values.size(); ++row) {
    comma = "\n";
    for (const MeasuredColumn& column : measured.columns) {
      fmt::format_to(to, "{}{}", comma, number_of(column, row));
      comma = ",";
    }
  }
  out.push_back('\n');
  return fmt::to_string(out);
}

std::string json_of(const std::string& name, const Measured& measured, bool units) {
  std::string notes = "{", columns = "{";
  for (const auto& [of, text] : measured.notes)
    notes += fmt::format("{}{}:{}", notes.size() > 1 ? "," : "", json(of), json(text));
  for (const MeasuredColumn& column : measured.columns)
    columns += fmt::format("{}{}:{}", columns.size() > 1 ? "," : "", json(column.name),
                           json_object({{"unit", json(units ? column.unit : std::string("1"))},
                                        {"values", json(column.values)}}));
  return json_object({{"measure", json(name)}, {"notes", notes + "}"}, {"columns", columns + "}"}});
}

double size_of(const std::string& option, const std::string& text, bool volume, bool reduced) {
  const Quantity& quantity = volume ? kVolume : quantity::length;
  const std::string example = reduced ? "1.5" : quantity.example;
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{}: '{}' {}", option, text, why), fmt::format("{} '{}'", option, example));
  };
  double value = 0;
  if (reduced) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      refuse("is not a number: the scene has reduced units");
  } else {
    try {
      const ParsedQuantity q = parse_quantity(text);
      if (q.list || q.dimension != quantity.dimension) refuse(fmt::format("is not {}", quantity.name));
      value = q.values[0];
    } catch (const UnitError& error) {
      refuse(fmt::format("is not {}: {}", quantity.name, error.message));
    }
  }
  if (!(value > 0 && value < 1e300)) refuse("is not above 0");
  return value;
}

}  // namespace cuboct
