// SPDX-License-Identifier: MIT
#include "tests/verify/judge.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "emu/systemc/node.h"
#include "emu/verilated/verilated_node.h"
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

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

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
      if (fs::exists(fs::path(CUBOCT_SOURCE_DIR) / "rtl/lib" / name)) continue;
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

}  // namespace

Case case_of(const std::string& name) {
  if (name.starts_with("random_flat_")) return random_flat_case(std::stoull(name.substr(12)));
  if (name.starts_with("random_")) return random_case(std::stoull(name.substr(7)));
  if (name.starts_with("small_")) return small_case(name.substr(6));
  if (name.starts_with("fault_")) return fault_case(static_cast<Fault>(std::stoi(name.substr(6))));
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
    case Verdict::assertion:
      return "assertion";
    case Verdict::stuck:
      return "stuck";
    default:
      return "error";
  }
}

std::vector<Judge::Run> usual_runs() { return {{}, {.stall_rate = 0.3, .stall_seed = 7, .register_seed = 17}}; }

Judge::Judge(Case c, std::vector<Run> runs)
    : case_(std::move(c)), runs_(std::move(runs)), golden_(run_golden(case_.setup, case_.steps)) {
  for (const Run& run : runs_)
    native_.push_back(run_plain(case_.setup.plan, case_.setup.initial,
                                keep_all(case_.steps, run.stall_rate, run.stall_seed),
                                emu::native_nodes(case_.setup.plan), "native"));
}

Judgement Judge::judge(const std::shared_ptr<const emu::Library>& library) const {
  Judgement result;
  const Plan& plan = case_.setup.plan;
  for (size_t k = 0; k < runs_.size(); ++k) {
    const auto factory = [&](uint32_t node, uint8_t has_link) {
      const uint32_t seed = runs_[k].register_seed;
      return std::make_unique<emu::VerilatedNode>(library, has_link, seed == 0 ? 0 : seed + node);
    };
    emu::RunResult run;
    try {
      run = run_plain(plan, case_.setup.initial,
                      keep_all(case_.steps, runs_[k].stall_rate, runs_[k].stall_seed), factory, "rtl");
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      result.text = e.what();
      result.verdict = result.text.starts_with("stuck") ? Verdict::stuck
                       : result.text.find("the assertion of the RTL") != std::string::npos
                           ? Verdict::assertion
                           : Verdict::error;
      return result;
    }
    const Compared bits = compare(plan, golden_, run);
    result.steps += bits.steps, result.particles += bits.particles;
    if (!bits.difference.empty()) {
      result.text = bits.difference;
      result.verdict = kind_of(bits.difference);
      return result;
    }
    const Compared cycles = compare_cycles(native_[k], run);
    result.spans += cycles.spans;
    if (!cycles.difference.empty()) {
      result.text = cycles.difference;
      result.verdict = Verdict::cycles;
      return result;
    }
  }
  return result;
}

}  // namespace cuboct::test
