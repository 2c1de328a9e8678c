// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/crosscheck_real.h"
#include "cli/run/estimate.h"
#include "cli/run/outputs.h"
#include "cli/run/run_engines.h"
#include "cli/run/stages.h"
#include "cli/run/summary.h"
#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"
#include "hw/program/options.h"
#include "model/analysis/meter.h"
#include "model/base/directory_lock.h"
#include "model/base/interrupt.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/spelling.h"
#include "model/base/text.h"
#include "model/run/start.h"
#include "model/trace/compare.h"
#include "model/trace/trace_file.h"

namespace cuboct {
namespace {

struct CrosscheckOptions {
  Input input;
  std::vector<std::string> engines;  // empty: those that the scene has
  EngineOptions choice;
  std::string out;
  uint64_t steps = 0;
  bool steps_given = false;
  Answer answer;
};

// Whether numbers are to be compared instead of bits.
bool of_real_numbers(const CrosscheckOptions& options) {
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

void check_engines(const CrosscheckOptions& options) {
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
}

// The comparison of one run: it tells people as it goes, and keeps the same for scripts.
class EngineComparison {
 public:
  EngineComparison(const CrosscheckOptions& options, const Loaded& loaded, const std::vector<Trace>& traces)
      : options_(options), loaded_(loaded), traces_(traces) {}

  // The exit code.
  int compare_all();
  const Items& items() const { return items_; }

 private:
  const std::string& name(size_t i) const { return options_.engines[i]; }
  int end(const char* verdict, int code);
  bool same_plan();
  void tell_mismatch(size_t a, size_t b, const Mismatch& mismatch);
  void tell_engines();
  void tell_faults(size_t i);

  const CrosscheckOptions& options_;
  const Loaded& loaded_;
  const std::vector<Trace>& traces_;
  Items items_;
};

int EngineComparison::end(const char* verdict, int code) {
  items_.add("verdict", verdict);
  tell_engines();
  return code;
}

bool EngineComparison::same_plan() {
  const uint64_t hash = loaded_.setup.plan.hash;
  for (size_t a = 0; a < traces_.size(); ++a) {
    if (traces_[a].plan_hash == hash) continue;
    const std::string text =
        fmt::format("plan hash: cuboct {:016x}, {} {:016x}", hash, name(a), traces_[a].plan_hash);
    options_.answer.say("mismatch: {}\n", text);
    items_.add("mismatch", text);
    return false;
  }
  return true;
}

void EngineComparison::tell_mismatch(size_t a, size_t b, const Mismatch& mismatch) {
  const Answer& answer = options_.answer;
  const std::string text = mismatch.text(name(a), name(b), loaded_.setup.plan.lattice);
  answer.say("mismatch: {}\n", text);
  items_.add("mismatch", text);
  if (mismatch.kind == Mismatch::Kind::state) {
    const Scratch second;
    const std::string first =
        explain({options_.input, options_.choice, loaded_, second.path("")}, name(a), name(b), mismatch.step);
    answer.say("first difference: {}\n", first);
    items_.add("first difference", first);
  }
  if (mismatch.kind == Mismatch::Kind::length || mismatch.kind == Mismatch::Kind::stop)
    for (const size_t i : {a, b})
      answer.say("{}: {}\n", name(i), traces_[i].stop ? line_text(traces_[i].stop->text) : "not stopped");
}

// What became of the faults that were injected.
void EngineComparison::tell_faults(size_t i) {
  const auto counted = [&](const std::string& fault) -> std::optional<double> {
    for (const auto& [counter, value] : traces_[i].counters)
      if (counter == "faults_" + fault) return value;
    return std::nullopt;
  };
  if (!counted("injected")) return;
  options_.answer.say(
      "{}: {:.0f} faults injected ({:.0f} flipped, {:.0f} dropped, {:.0f} repeated, {:.0f} in "
      "acknowledgements), {:.0f} detected, {:.0f} healed\n",
      name(i), *counted("injected"), *counted("flipped"), *counted("dropped"), *counted("repeated"),
      *counted("in_acks"), *counted("detected"), *counted("healed"));
}

void EngineComparison::tell_engines() {
  std::vector<Items> engines(traces_.size());
  for (size_t i = 0; i < traces_.size(); ++i) {
    engines[i].add("name", name(i));
    engines[i].add("steps", traces_[i].steps());
    engines[i].add("seconds", traces_[i].seconds);
    if (traces_[i].stop) engines[i].add("stopped", traces_[i].stop->text);
    for (const auto& [counter, value] : traces_[i].counters) engines[i].add(counter, value);
  }
  items_.add_list("engines", "engine", engines);
}

int EngineComparison::compare_all() {
  const Answer& answer = options_.answer;
  if (!same_plan()) return end("mismatch", 1);
  uint64_t phase_times = 0;
  bool link_failed = false;
  for (size_t a = 0; a < traces_.size(); ++a)
    for (size_t b = a + 1; b < traces_.size(); ++b) {
      const auto mismatch = compare(traces_[a], traces_[b]);
      if (!mismatch) {
        if (!traces_[a].cycles.empty() && !traces_[b].cycles.empty()) phase_times = traces_[a].cycles.size();
        continue;
      }
      // All that a run held before one of its links failed is equal, and the run says so.
      if ((by_link(traces_[a]) || by_link(traces_[b])) && mismatch->kind != Mismatch::Kind::state) {
        link_failed = true;
        continue;
      }
      tell_mismatch(a, b, *mismatch);
      return end("mismatch", 1);
    }
  if (link_failed) {
    for (size_t i = 0; i < traces_.size(); ++i) {
      tell_faults(i);
      if (by_link(traces_[i]))
        answer.say("{} stopped after {} matched steps: {}\n", name(i), traces_[i].steps(),
                   line_text(traces_[i].stop->text));
    }
    return end("a link failed", 1);
  }
  const Trace& first = traces_[0];
  const uint64_t updates = updates_compared(first, loaded_.setup.plan.particles);
  answer.say("matched {} updates over {} steps in {} engines\n", updates, first.steps(), traces_.size());
  items_.add("updates", updates);
  items_.add("steps", first.steps());
  if (first.reached) {
    answer.say("all ended {}\n", reached_text(first));
    items_.add("ended", reached_text(first));
  }
  if (phase_times > 0) {
    answer.say("matched {} phase times\n", phase_times);
    items_.add("phase times", phase_times);
  }
  for (size_t i = 0; i < traces_.size(); ++i) tell_faults(i);
  if (!first.stop) return end("matched", 0);
  answer.say("all stopped: {}\n", line_text(first.stop->text));
  items_.add("stopped", first.stop->text);
  return end("all stopped", 1);
}

// Of each engine by itself, as the engines run one after the other.
void check_sizes(const CrosscheckOptions& options, const Loaded& loaded, uint64_t steps) {
  if (options.choice.anyway) return;
  RunSize size = run_size(loaded.scene, steps);
  size.probe_every = 0;
  size.threads = options.choice.threads;
  size.ranks = options.choice.ranks;
  for (const std::string& engine : options.engines) {
    size.engine = engine;
    size.hash_every = engine_row(engine).hash_every;
    check_fits(loaded.scene, size, estimate(loaded.scene, loaded.setup.plan, size), "");
  }
}

struct Crossed {
  int code = 0;
  bool reached = false;
  Items items;
};

// `leave`: a directory for the last state; empty: none is asked for.
Crossed cross_once(CrosscheckOptions options, const std::string& leave) {
  Loaded loaded{load_scene(options.input.scene, {options.input.stage, options.input.from, false}), {}};
  const Arch arch = read_arch(options.input.arch);
  if (options.engines.empty()) options.engines = engines_to_cross(loaded.scene, arch);
  check_engines(options);
  loaded.setup.plan = shared_plan_of(loaded.scene, arch, options.engines);
  const bool text = loaded.setup.plan.program != nullptr;
  check_held(loaded.scene, loaded.setup.plan, options.choice.anyway);
  const Scratch scratch;
  std::optional<DirectoryLock> lock;
  std::string directory = scratch.path("");
  if (!options.out.empty()) {
    lock.emplace(options.out, "cuboct crosscheck");
    for (const std::string& engine : options.engines) check_writable(options.out + "/" + engine + ".h5");
    directory = options.out;
  }
  RunRequest request;
  request.steps = options.steps_given ? options.steps : loaded.scene.steps;
  check_sizes(options, loaded, request.steps);
  if (loaded.scene.until) request.until = true, request.probes = probe_steps_of(loaded.scene, request.steps);
  if (!leave.empty()) request.frames = {request.steps};
  std::optional<RunState> last;  // of a rule of text, whose fields no State of a trace has
  if (text) request.keep = [&](const RunState& frame) { last = frame; };
  std::vector<Trace> traces =
      run_all({options.input, options.choice, loaded, directory}, options.engines, request);
  for (size_t i = 0; i < traces.size(); ++i)
    if (!options.out.empty() && engine_row(options.engines[i]).here != Here::none)
      write_trace(options.out + "/" + options.engines[i] + ".h5", traces[i]);
  if (interrupted()) throw Failed("interrupted");
  EngineComparison comparison(options, loaded, traces);
  const int code = comparison.compare_all();
  Crossed crossed{code, traces[0].reached.has_value(), comparison.items()};
  if (code == 0 && !leave.empty()) {
    if (!text) last = std::move(traces[0].frames.back());
    traces[0].frames.clear();
    leave_state(leave, head_of(loaded, text, false), *last, traces[0]);
  }
  return crossed;
}

// One stage after the other, each from the state in which all engines ended the one before it.
int cross_stages(const CrosscheckOptions& options, const std::vector<StageName>& names,
                 const StageRange& range) {
  if (options.steps_given) throw InputError("--steps goes with --stage NAME: each stage has its own steps");
  for (size_t k = range.first; k < range.end; ++k)
    read_scene(options.input.scene, {.begins = true, .stage = names[k].name});
  const Scratch scratch;
  std::string from = options.input.from, ended;  // ended: a stage whose `until` held in an earlier part
  std::vector<std::string> told;
  int code = 0;
  for (size_t k = range.first; k < range.end && code == 0; ++k) {
    if (names[k].stage == ended) continue;
    const std::string title = stage_title(names, k);
    CrosscheckOptions one = options;
    one.input.stage = names[k].name;
    one.input.from = from;
    if (!options.out.empty()) one.out = options.out + "/" + title;
    options.answer.say("stage {}\n", title);
    from = scratch.path(title);
    const Crossed crossed = cross_once(one, from);
    code = crossed.code;
    if (crossed.reached) ended = names[k].stage;
    told.push_back(json_object({{"name", json(names[k].name)}, {"result", crossed.items.json()}}));
  }
  options.answer.close(json_object({{"stages", json_array(told)}}));
  return code;
}

int cross_real(CrosscheckOptions options) {
  std::optional<DirectoryLock> lock;
  if (!options.out.empty()) {
    lock.emplace(options.out, "cuboct crosscheck");
    check_writable(options.out + "/gpu.h5");
  }
  options.choice.precision = options.choice.precision.empty() ? "float" : options.choice.precision;
  options.choice.check({"gpu"}, options.input);
  return crosscheck_real(options.input, options.choice,
                         options.steps_given ? std::optional(options.steps) : std::nullopt, options.out,
                         options.answer);
}

int crosscheck(const CrosscheckOptions& options) {
  catch_interrupts();
  if (of_real_numbers(options)) return cross_real(options);
  if (!options.engines.empty()) check_engines(options);
  const std::vector<StageName> names = stages_of(options.input.scene);
  const StageRange range = stages_to_take(options.input.scene, names, options.input.stage);
  if (range.end - range.first > 1) return cross_stages(options, names, range);
  CrosscheckOptions one = options;
  if (names.size() == 1) one.input.stage = names[0].name;
  const Crossed crossed = cross_once(one, "");
  if (options.answer.json) options.answer.close(crossed.items);
  return crossed.code;
}

}  // namespace

void add_crosscheck(Command& app, int& exit_code) {
  auto [command, options] = add_command<CrosscheckOptions>(app, "crosscheck", exit_code, crosscheck);
  options->input.add_to(command);
  options->input.add_start_to(command);
  options->input.add_stalls_to(command);
  options->choice.add_machines(command);
  command
      .option("--engines", options->engines,
              "which ones; default: golden,lattice,systemc,rtl; golden,lattice of a rule of text, or in a "
              "box that no "
              "cube divides",
              "A,B,...")
      .delimiter(',')
      .proposed(engines_that([](auto&) { return true; }));
  command
      .option("--precision", options->choice.precision,
              "float (default) or double: the numbers of gpu against reference, within bounds")
      .one_of({"float", "double"});
  command.option("--steps", options->steps, "steps; default: the scene's", "N")
      .check(whole_number)
      .given(options->steps_given);
  command.option("--out", options->out,
                 "directory that keeps each engine's trace; of a scene of stages, a directory each", "DIR");
  options->answer.add_to(command);
}

}  // namespace cuboct
