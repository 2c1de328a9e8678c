// SPDX-License-Identifier: MIT
#include "cli/run_reference.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>

#include "cli/summary.h"
#include "model/analysis/measure.h"
#include "model/analysis/real_meter.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"

namespace cuboct {
void RealChoice::add_to(CLI::App& command) {
  command
      .add_option(
          "--precision", precision,
          "the numbers of reference, double (default) or float, and of gpu, fixed (default), float or double")
      ->check(CLI::IsMember({"fixed", "float", "double"}));
  command
      .add_option("--integrator", integrator,
                  "euler (semi-implicit, as the fixed rule) or verlet, of reference")
      ->check(CLI::IsMember({"euler", "verlet"}))
      ->capture_default_str();
}

void RealChoice::check_used(const std::string& engine) const {
  if (!precision.empty() && engine != "reference" && engine != "gpu")
    throw InputError(
        fmt::format("--precision is an option of the reference and the gpu engine, not of {}", engine));
  if (precision == "fixed" && engine == "reference")
    throw InputError("--precision fixed: the reference engine computes in doubles or floats",
                     "lattice, golden and gpu compute in the fixed rule's integers");
  if (integrator != "euler" && engine != "reference")
    throw InputError(fmt::format("--integrator is an option of the reference engine, not of {}", engine));
}

bool RealChoice::is_real(const std::string& engine) const {
  return engine == "reference" || (engine == "gpu" && !precision.empty() && precision != "fixed");
}

RealOptions RealChoice::options() const {
  return {
      .integrator = integrator == "verlet" ? Integrator::velocity_verlet : Integrator::semi_implicit_euler,
      .precision = precision == "float" ? Precision::float32 : Precision::float64};
}

ReferenceRun run_reference(const Loaded& loaded, RealOptions options, uint64_t steps,
                           const std::vector<uint64_t>& frame_steps, const std::vector<uint64_t>& probe_steps,
                           bool watch, Recorder* recorder) {
  using Clock = std::chrono::steady_clock;
  const Scene& scene = loaded.scene;
  if (options.threads == 0) options.threads = reference_threads(scene.body.size());
  Reference reference(scene.rule, scene.body, scene.periodic, options);
  ReferenceRun run;
  run.trace.engine = "reference";
  run.trace.plan_hash = loaded.setup.plan.hash;
  run.trace.nodes = loaded.setup.plan.nodes();
  RealMeter meter(scene, options.integrator, true, true);
  Watch detectors(scene, 0);

  const auto record = [&](uint64_t step, bool last) {
    const bool probed = last || std::binary_search(probe_steps.begin(), probe_steps.end(), step);
    const bool kept = last || std::binary_search(frame_steps.begin(), frame_steps.end(), step);
    if (!probed && !kept) return;
    if (probed) meter.add(reference, watch ? &detectors : nullptr);
    if (kept && recorder) recorder->keep(RealFrame{step, reference.body().x, reference.body().v, {}});
  };

  Progress progress("reference", steps, scene.body.size());
  const Vec3 before = reference.momentum();
  uint64_t step = 0;
  record(0, steps == 0);
  while (step < steps) {
    const auto begin = Clock::now();
    reference.step();
    run.trace.seconds += std::chrono::duration<double>(Clock::now() - begin).count();
    ++step;
    const bool last = step == steps || interrupted();
    record(step, last);
    if (last) break;
    progress.at(step);
  }
  run.trace.steps_done = step;
  run.trace.curves = meter.curves();

  Items& items = run.summary;
  items.add("engine", "reference");
  items.add("precision", options.precision == Precision::float32 ? "float" : "double");
  items.add("integrator",
            options.integrator == Integrator::velocity_verlet ? "velocity Verlet" : "semi-implicit Euler");
  items.add("threads", static_cast<uint64_t>(options.threads));
  items.add("scene", scene.path);
  items.add("particles", static_cast<uint64_t>(scene.body.size()));
  items.add("steps", step);
  items.add("simulated time", static_cast<double>(step) * scene.rule.dt, "s");
  items.add("host time", run.trace.seconds, "s");
  if (run.trace.seconds > 0)
    items.add("speed", static_cast<double>(step * scene.body.size()) / run.trace.seconds, "particle-steps/s");
  items.add("momentum change", (reference.momentum() - before).norm(), "kg m/s",
            keeps_momentum(scene.rule) ? "" : "held or driven from outside");
  add_curves(items, scene, run.trace.curves);
  items.add("largest speed", reference.largest_speed() * scene.rule.dt / loaded.setup.plan.rule.cell_edge,
            "cell/step");
  detectors.conclude();
  std::vector<Finding> findings = detectors.findings();
  if (const auto far = options.precision == Precision::float32 ? find_far_origin(scene) : std::nullopt)
    findings.insert(findings.begin(), *far);
  if (watch) add_warnings(items, {}, findings);
  run.failed = watch && !findings.empty();
  if (watch) {
    run.trace.findings = std::move(findings);
    run.trace.watched = detectors.last_step();
  }
  return run;
}

}  // namespace cuboct
