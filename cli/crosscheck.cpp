// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <optional>

#include "cli/command.h"
#include "cli/crosscheck_real.h"
#include "cli/run_engines.h"
#include "cli/summary.h"
#include "hw/engines.h"
#include "model/analysis/meter.h"
#include "model/base/directory_lock.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/progress.h"
#include "model/base/spelling.h"
#include "model/base/text.h"
#include "model/trace/compare.h"

namespace cuboct {
namespace {

struct Options {
  Input input;
  std::vector<std::string> engines{"golden", "lattice", "systemc", "rtl"};
  EngineOptions choice;
  std::string out;
  uint64_t steps = 0;
  bool steps_given = false;
};

// Whether numbers are to be compared instead of bits.
bool of_real_numbers(const Options& options) {
  const auto count = [&](bool bits) {
    return std::ranges::count_if(options.engines, [bits](auto& engine) {
      const EngineRow* row = find_engine(engine);
      return row && row->real && row->bits == bits;
    });
  };
  const bool real = options.engines.size() == 2 && count(true) == 1 && count(false) == 1;
  if (!real && !options.choice.precision.empty())
    throw InputError("--precision goes with --engines reference,gpu",
                     "other engines compute in the fixed rule");
  return real;
}

bool by_link(const Trace& trace) { return trace.stop && is_of_link(trace.stop->fault); }

// What became of the faults that were injected.
void tell_faults(const std::string& engine, const Trace& trace) {
  const auto counted = [&](const std::string& name) -> std::optional<double> {
    for (const auto& [counter, value] : trace.counters)
      if (counter == "faults_" + name) return value;
    return std::nullopt;
  };
  if (!counted("injected")) return;
  fmt::print(
      "{}: {:.0f} faults injected ({:.0f} flipped, {:.0f} dropped, {:.0f} repeated, {:.0f} in "
      "acknowledgements), {:.0f} detected, {:.0f} healed\n",
      engine, *counted("injected"), *counted("flipped"), *counted("dropped"), *counted("repeated"),
      *counted("in_acks"), *counted("detected"), *counted("healed"));
}

int crosscheck(Options options) {
  std::optional<DirectoryLock> lock;
  if (of_real_numbers(options)) {
    if (!options.out.empty()) {
      lock.emplace(options.out, "cuboct crosscheck");
      check_writable(options.out + "/gpu.h5");
    }
    options.choice.precision = options.choice.precision.empty() ? "float" : options.choice.precision;
    options.choice.check({"gpu"}, options.input);
    return crosscheck_real(options.input, options.choice,
                           options.steps_given ? std::optional(options.steps) : std::nullopt, options.out);
  }
  for (const std::string& engine : options.engines) {
    if (const EngineRow* row = find_engine(engine); row && !row->bits)
      throw InputError(fmt::format("engine '{}' computes in doubles and has no bits to compare", engine),
                       "one of " + list_of(engines_that([](auto& other) { return other.bits; })));
    engine_row(engine, true);
  }
  std::vector<std::string> sorted = options.engines;
  std::sort(sorted.begin(), sorted.end());
  if (std::unique(sorted.begin(), sorted.end()) != sorted.end() || sorted.size() < 2)
    throw InputError("a crosscheck needs two or more different engines",
                     "--engines golden,lattice,systemc,rtl");
  options.choice.check(options.engines, options.input);
  const Loaded loaded = load_plan(options.input);
  catch_interrupts();
  const Setup& setup = loaded.setup;
  const Plan& plan = setup.plan;
  const Scratch scratch;
  std::string directory = scratch.path("");
  if (!options.out.empty()) {
    lock.emplace(options.out, "cuboct crosscheck");
    for (const std::string& engine : options.engines) check_writable(options.out + "/" + engine + ".h5");
    directory = options.out;
  }

  const uint64_t steps = options.steps_given ? options.steps : loaded.scene.steps;
  RunRequest request;
  request.steps = steps;
  if (loaded.scene.until) request.until = true, request.probes = probe_steps_of(loaded.scene, steps);
  const std::vector<Trace> traces =
      run_all({options.input, options.choice, loaded, directory}, options.engines, request);
  for (size_t i = 0; i < traces.size(); ++i)
    if (!options.out.empty() && engine_row(options.engines[i]).here != Here::none)
      write_trace(options.out + "/" + options.engines[i] + ".h5", traces[i]);
  if (interrupted()) {
    fmt::print(stderr, "interrupted\n");
    return 1;
  }

  for (size_t a = 0; a < traces.size(); ++a) {
    if (traces[a].plan_hash != plan.hash) {
      fmt::print("mismatch: plan hash: cuboct {:016x}, {} {:016x}\n", plan.hash, options.engines[a],
                 traces[a].plan_hash);
      return 1;
    }
  }
  uint64_t phase_times = 0;
  bool link_failed = false;
  for (size_t a = 0; a < traces.size(); ++a) {
    for (size_t b = a + 1; b < traces.size(); ++b) {
      const auto mismatch = compare(traces[a], traces[b]);
      if (!mismatch) {
        if (!traces[a].cycles.empty() && !traces[b].cycles.empty()) phase_times = traces[a].cycles.size();
        continue;
      }
      // All that a run held before one of its links failed is equal, and the run says so.
      if ((by_link(traces[a]) || by_link(traces[b])) && mismatch->kind != Mismatch::Kind::state) {
        link_failed = true;
        continue;
      }
      fmt::print("mismatch: {}\n", mismatch->text(options.engines[a], options.engines[b], plan.lattice));
      if (mismatch->kind == Mismatch::Kind::state) {
        const Scratch second;
        fmt::print("first difference: {}\n", explain({options.input, options.choice, loaded, second.path("")},
                                                     options.engines[a], options.engines[b], mismatch->step));
      }
      if (mismatch->kind == Mismatch::Kind::length || mismatch->kind == Mismatch::Kind::stop)
        for (const size_t i : {a, b})
          fmt::print("{}: {}\n", options.engines[i],
                     traces[i].stop ? line_text(traces[i].stop->text) : "not stopped");
      return 1;
    }
  }
  if (link_failed) {
    for (size_t i = 0; i < traces.size(); ++i) {
      tell_faults(options.engines[i], traces[i]);
      if (by_link(traces[i]))
        fmt::print("{} stopped after {} matched steps: {}\n", options.engines[i], traces[i].steps(),
                   line_text(traces[i].stop->text));
    }
    return 1;
  }
  fmt::print("matched {} updates over {} steps in {} engines\n", updates_compared(traces[0], plan.particles),
             traces[0].steps(), traces.size());
  if (traces[0].reached) fmt::print("all ended {}\n", reached_text(traces[0]));
  if (phase_times > 0) fmt::print("matched {} phase times\n", phase_times);
  for (size_t i = 0; i < traces.size(); ++i) tell_faults(options.engines[i], traces[i]);
  if (traces[0].stop) {
    fmt::print("all stopped: {}\n", line_text(traces[0].stop->text));
    return 1;
  }
  return 0;
}

}  // namespace

void add_crosscheck(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("crosscheck", "run a scene in several engines and compare every bit");
  options->input.add_to(*command);
  options->input.add_start_to(*command);
  options->input.add_stalls_to(*command);
  options->choice.add_machines(*command);
  command->add_option("--engines", options->engines, "which ones; default: golden,lattice,systemc,rtl")
      ->delimiter(',')
      ->type_name("A,B,...");
  command
      ->add_option("--precision", options->choice.precision,
                   "float (default) or double: the numbers of gpu against reference, within bounds")
      ->check(CLI::IsMember({"float", "double"}));
  auto* steps = command->add_option("--steps", options->steps, "steps; default: the scene's")
                    ->check(whole_number())
                    ->type_name("N");
  command->add_option("--out", options->out, "directory that keeps each engine's trace")->type_name("DIR");
  command->callback([options, steps, &exit_code] {
    options->steps_given = steps->count() > 0;
    exit_code = crosscheck(*options);
  });
}

}  // namespace cuboct
