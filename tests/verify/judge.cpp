// SPDX-License-Identifier: MIT
#include "tests/verify/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "emu/systemc/node.h"
#include "emu/verilated/verilated_node.h"
#include "hw/rtl/rtl_library.h"
#include "model/base/output.h"
#include "tests/verify/small_case.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAsked = R"(#include <cstdlib>
extern "C" int cuboct_mutant_asked() {
  const char* text = std::getenv("CUBOCT_MUTANT");
  return text == nullptr ? 0 : std::atoi(text);
}
)";

// A context's counts go with it, so each node writes its own; the names count within a process.
constexpr const char* kWrite = R"(#include <cstdlib>
#include <string>
#include <unistd.h>
#include "verilated_cov.cpp"
void cuboct_write_coverage(VerilatedContext& context) {
  static int number = 0;
  const char* dir = std::getenv("CUBOCT_COVERAGE");
  if (dir == nullptr) return;
  const std::string name = std::to_string(getpid()) + "-" + std::to_string(number++);
  context.coveragep()->write((std::string(dir) + "/" + name + ".dat").c_str());
}
)";

void replace_once(std::string& text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("not there: " + from);
  text.replace(at, from.size(), to);
}

// Files of `changed` over those of rtl/; what is new there goes before all in files.f, in the order of names.
void put_over(const fs::path& changed, const fs::path& dir) {
  std::map<std::string, fs::path> files;
  for (const auto& entry : fs::directory_iterator(changed))
    if (entry.path().extension() == ".sv") files[entry.path().filename().string()] = entry.path();
  std::string first;
  for (const auto& [name, path] : files) {
    const fs::path to = dir / "rtl" / name;
    if (!fs::exists(to)) {
      // A module of the library that this plan does not use is not missed.
      if (std::ranges::find(rtl_library(), name, &RtlSource::name) != rtl_library().end()) continue;
      first += "rtl/" + name + "\n";
    }
    fs::copy_file(path, to, fs::copy_options::overwrite_existing);
  }
  const std::string rest = read_text(dir / "files.f");
  std::ofstream(dir / "files.f", std::ios::binary) << first << rest;
}

Verdict kind_of(const std::string& difference) {
  return difference.starts_with("stopped") || difference.starts_with("did not stop") ? Verdict::fault
                                                                                     : Verdict::bits;
}

Verdict kind_of_stop(const std::string& text) {
  if (text.starts_with("stuck")) return Verdict::stuck;
  if (text.find("the assertion of the RTL") != std::string::npos) return Verdict::assertion;
  const size_t at = text.find(kPortsDiffer);
  if (at == std::string::npos) return Verdict::error;
  const std::string group = text.substr(at + std::string(kPortsDiffer).size());
  if (group == to_string(PortGroup::observe)) return Verdict::bits;
  if (group == to_string(PortGroup::fault)) return Verdict::fault;
  if (group == to_string(PortGroup::links) || group == to_string(PortGroup::acks)) return Verdict::links;
  return Verdict::cycles;
}

// The first of the counters that both kinds of nodes have which differs.
std::string other_work(const emu::RunResult& native, const emu::RunResult& rtl) {
  for (const auto& [name, value] : rtl.trace.counters)
    for (const auto& [other, expected] : native.trace.counters)
      if (name == other && value != expected) return fmt::format("{} {}, native {}", value, name, expected);
  return {};
}

bool equal(const emu::FaultCounts& a, const emu::FaultCounts& b) {
  return a.injected() == b.injected() && a.detected == b.detected && a.healed == b.healed;
}

// What golden holds after no step.
GoldenRun start_of(const GoldenRun& golden) {
  return {{golden.states.at(0)}, {golden.order.at(0)}, std::nullopt};
}

// Ends with the step that faults.
Case shortened(Case c) {
  const GoldenRun golden = run_golden(c.setup, c.steps);
  if (golden.fault) c.steps = golden.states.size();
  return c;
}

}  // namespace

Case case_of(const std::string& name) {
  if (name.starts_with("random_flat_")) return random_flat_case(std::stoull(name.substr(12)));
  if (name.starts_with("random_")) return random_case(std::stoull(name.substr(7)));
  if (name.starts_with("small_")) return shortened(small_case(name.substr(6)));
  if (name.starts_with("fault_")) return shortened(fault_case(static_cast<Fault>(std::stoi(name.substr(6)))));
  return make_case(name);
}

std::string build_node(const Plan& plan, const NodeBuild& choice, const std::string& cache) {
  emu::Build build = emu::node_build(plan);
  build.compiler_flags = choice.optimise;
  build.sources.emplace_back("asked.cpp", kAsked);
  if (choice.coverage) {
    build.verilator_flags += " --coverage-line";
    build.compiler_flags += " -UVM_COVERAGE -DVM_COVERAGE=1";
    build.sources.emplace_back("write.cpp", kWrite);
    for (auto& [name, text] : build.sources)
      if (name == "shim.h") {
        replace_once(text, "namespace {\n", "void cuboct_write_coverage(VerilatedContext&);\nnamespace {\n");
        replace_once(text, "    model->final();\n",
                     "    model->final();\n    cuboct_write_coverage(context);\n");
      }
  }
  if (!choice.changed.empty()) {
    build.verilator_flags += " -Wno-ENUMVALUE";  // of a state that is stuck
    build.emit = [emit = build.emit, &choice](const std::string& dir) {
      emit(dir);
      put_over(choice.changed, dir);
    };
  }
  return emu::compile(build, cache);
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "passed";
    case Verdict::bits:
      return "bits";
    case Verdict::fault:
      return "fault";
    case Verdict::cycles:
      return "cycles";
    case Verdict::links:
      return "links";
    case Verdict::assertion:
      return "assertion";
    case Verdict::stuck:
      return "stuck";
    default:
      return "error";
  }
}

std::vector<Judge::Run> usual_runs(const Plan& plan) {
  std::vector<Judge::Run> runs{{}, {.stall_rate = 0.3, .stall_seed = 7, .register_seed = 17}, {.steps = 0}};
  if (plan.link.check == LinkCheck::none) return runs;
  runs.push_back({.mixed = true});
  if (plan.link.check == LinkCheck::retry) {
    for (const double rate : {0.02, 0.2}) {
      runs.push_back({.stall_rate = 0.2, .register_seed = 5});
      runs.back().faults.rate = rate;
    }
    for (const double stalls : {0.5, 0.75}) runs.push_back({.stall_rate = stalls, .stall_seed = 2});
    // Acknowledgements that stay away so long that beats which came are sent again.
    runs.push_back({.stall_rate = 0.2});
    runs.back().faults = {.rate = 0.9, .target = {}, .seed = 3, .flips = 0, .drops = 0, .repeats = 0};
  } else {
    using emu::FaultKind;
    // Of node 0, over +x: an early beat and one of a later step; the wire the other way.
    for (const FaultKind kind : {FaultKind::flip, FaultKind::drop, FaultKind::repeat, FaultKind::ack})
      for (const auto& [node, face, beat] : {std::tuple{0u, 1, 3u}, std::tuple{1u, 0, 70u}}) {
        runs.push_back({.register_seed = 3});
        runs.back().faults.target = {node, face, beat, kind};
      }
    // Many at once: the lowest face of the first cycle is told.
    runs.push_back({});
    runs.back().faults.rate = 0.5;
  }
  return runs;
}

emu::RunOptions Judge::options_of(const Run& run) const {
  emu::RunOptions options = keep_all(run.steps.value_or(case_.steps), run.stall_rate, run.stall_seed);
  options.faults = run.faults;
  return options;
}

Judge::Judge(Case c, std::vector<Run> runs)
    : case_(std::move(c)), runs_(std::move(runs)), golden_(run_golden(case_.setup, case_.steps)) {
  const Plan& plan = case_.setup.plan;
  ports_.assign(runs_.size(), PortRecord(plan.nodes()));
  for (size_t k = 0; k < runs_.size(); ++k)
    native_.push_back(run_loop_bench(plan, case_.setup.initial, options_of(runs_[k]),
                                     recorded(emu::native_nodes(plan), ports_[k]), "native"));
}

Judgement Judge::judge(const std::shared_ptr<const emu::Library>& library) const {
  Judgement result;
  const Plan& plan = case_.setup.plan;
  const emu::NodeFactory native = emu::native_nodes(plan);
  for (size_t k = 0; k < runs_.size(); ++k) {
    const auto emitted = [&](uint32_t node, uint8_t has_link) -> std::unique_ptr<emu::NodeModel> {
      const Cell cell = plan.low_of(node);
      if (runs_[k].mixed && (cell[0] + cell[1] + cell[2]) % 2 == 0) return native(node, has_link);
      const uint32_t seed = runs_[k].register_seed;
      return std::make_unique<emu::VerilatedNode>(library, plan, node, has_link, seed == 0 ? 0 : seed + node);
    };
    emu::RunResult run;
    try {
      run = run_loop_bench(plan, case_.setup.initial, options_of(runs_[k]),
                           watched(emitted, ports_[k], result.cycles), "rtl");
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      result.text = e.what();
      result.verdict = kind_of_stop(result.text);
      return result;
    }
    // What golden cannot know: a run that stops on a link, or before it begins.
    const bool by_link = native_[k].trace.stop && is_of_link(native_[k].trace.stop->fault);
    if (!by_link) {
      const Compared bits = compare(plan, runs_[k].steps ? start_of(golden_) : golden_, run);
      result.steps += bits.steps, result.particles += bits.particles;
      if (!bits.difference.empty()) {
        result.text = bits.difference;
        result.verdict = kind_of(bits.difference);
        return result;
      }
    }
    const Compared cycles = compare_cycles(native_[k], run);
    result.spans += cycles.spans;
    result.text = cycles.difference;
    if (result.text.empty() && !run.trace.stop && !runs_[k].mixed) result.text = other_work(native_[k], run);
    if (!result.text.empty()) {
      result.verdict = Verdict::cycles;
      return result;
    }
    if (!equal(native_[k].faults, run.faults)) {
      result.text = "other counts of faults on the wires";
      result.verdict = Verdict::links;
      return result;
    }
  }
  return result;
}

}  // namespace cuboct::test
