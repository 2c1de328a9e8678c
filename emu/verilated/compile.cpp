// SPDX-License-Identifier: MIT
#include "emu/verilated/compile.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/host_compiler.h"
#include "model/base/output.h"
#include "model/base/progress.h"
#include "model/base/text.h"

namespace cuboct::emu {
namespace {

namespace fs = std::filesystem;

// The constant bit-operation tree of Verilator 5.006 is wrong in rare cases.
constexpr const char* kVerilatorFlags = "-O3 -fno-const-bit-op-tree --assert -Wno-fatal";
// VL_USER_STOP: the sources say what happens where an assertion of the RTL fails (shim.h).
constexpr const char* kCompilerFlags =
    "-std=c++17 -fPIC -fno-gnu-unique -w -DVM_COVERAGE=0 -DVM_TRACE=0 -DVM_TIMING=0 -DVL_USER_STOP";

// Comments name the plan that a file was made from, and the package counts the lattice's nodes; what the
// hardware is stands in the other lines.
void add_code(Hash& hash, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("//") || line.find(" Nodes ") != std::string::npos) continue;
    for (const char c : line) hash.add(c);
    hash.add('\n');
  }
}

uint64_t key_of(const Build& build, const fs::path& dir, const std::string& tools) {
  std::map<std::string, std::string> files;  // in the order of names
  for (const auto& entry : fs::recursive_directory_iterator(dir / "rtl"))
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), dir).string()] = read_text(entry.path().string());
  Hash hash;
  for (const auto& [name, text] : files) add_code(hash, fmt::format("file {}\n{}", name, text));
  for (const auto& [name, text] : build.sources) add_code(hash, fmt::format("file {}\n{}", name, text));
  for (const auto& [name, value] : build.constants) add_code(hash, fmt::format("{}={}", name, value));
  add_code(hash, fmt::format("{}\n{} {}\n{} {}\n{}", build.top, kVerilatorFlags, build.verilator_flags,
                             kCompilerFlags, build.compiler_flags + build.libraries, tools));
  return hash.value();
}

// Two units, as most of the compiler's time would go into Verilator's headers: what runs in each cycle, with
// the sources; and what runs once, as the settling of a new model and the filling of its tables, where the
// compiler is not to spend time. One where it spends none on either.
struct Units {
  std::string each_cycle, once;
};

Units units_of(const Build& build, const fs::path& model) {
  std::set<std::string> files;
  std::error_code none;  // then the compiler misses the model's headers, and says so
  for (const auto& entry : fs::directory_iterator(model, none))
    if (entry.path().extension() == ".cpp") files.insert(entry.path().filename().string());
  Units units;
  const bool one = build.compiler_flags.find("-O0") != std::string::npos;
  for (const std::string& name : files)
    (name.ends_with("Slow.cpp") && !one ? units.once : units.each_cycle) +=
        fmt::format("#include \"{}\"\n", name);
  for (const auto& [name, text] : build.sources)
    if (name.ends_with(".cpp")) units.each_cycle += fmt::format("#include \"{}\"\n", name);
  return units;
}

constexpr const char* kIncludes = "-I\"$root/include\" -I\"$root/include/vltstd\"";
constexpr const char* kRoot = "root=$(verilator --getenv VERILATOR_ROOT) || exit; ";

// What all models of the same tools and flags have in common, as an object in `home`: made where there is
// none.
fs::path runtime(const Build& build, const std::string& tools, const fs::path& home, const fs::path& dir,
                 const fs::path& log) {
  const std::string flags = fmt::format("{} {} -O0", kCompilerFlags, build.compiler_flags);
  const fs::path object = home / fmt::format("verilated-{:016x}.o", key_of_texts({flags, tools}));
  if (fs::exists(object)) return object;
  write_text(dir / "runtime.cpp", "#include \"verilated.cpp\"\n#include \"verilated_threads.cpp\"\n");
  run_logged("the C++ compiler",
             fmt::format("{}{} {} {} -c runtime.cpp", kRoot, host_compiler(), flags, kIncludes), dir, log);
  fs::rename(dir / "runtime.o", object);
  return object;
}

}  // namespace

std::string compile(const Build& build, const std::string& directory) {
  constexpr const char* kWhy = "the emitted hardware is compiled with it";
  std::string tools = version_of("verilator", "verilator", kWhy);
  tools += host_compiler() + ": " + version_of(host_compiler(), "g++", kWhy);
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) throw InputError(fmt::format("cannot make the directory {}: {}", directory, error.message()));
  const fs::path home = fs::absolute(directory);
  const BuildDirectory scratch(home / build.top);
  const fs::path &dir = scratch.path(), rtl = dir / "emitted";
  build.emit(rtl.string());
  const std::string name = fmt::format("{}-{:016x}", build.top, key_of(build, rtl, tools));
  const fs::path result = home / (name + ".so"), log = home / (name + ".log");
  if (fs::exists(result)) return result.string();

  StatusLine status;
  status.say(fmt::format("compiles {} by Verilator, and keeps it ...", build.top));
  fs::remove(log, error);
  // One copy of the node's code serves all nodes of a lattice; inlined, the build takes minutes.
  write_text(
      dir / "keep.vlt",
      "`verilator_config\nno_inline -module \"cuboct_node_core\"\nno_inline -module \"cuboct_brick_core\"\n"
      "no_inline -module \"cuboct_rule_core\"\n");
  run_logged("verilator",
             fmt::format("verilator {} {} --top-module {} --prefix V{} -Mdir {} ../keep.vlt -f files.f",
                         kVerilatorFlags, build.verilator_flags, build.top, build.top,
                         shell_word((dir / "model").string())),
             rtl, log);
  for (const auto& [name_of_source, text] : build.sources) write_text(dir / name_of_source, text);
  std::string arguments;
  for (const auto& [constant, value] : build.constants) arguments += fmt::format(" -D{}={}", constant, value);
  const Units units = units_of(build, dir / "model");
  write_text(dir / "each_cycle.cpp", units.each_cycle);
  write_text(dir / "once.cpp", units.once);
  const fs::path shared = runtime(build, tools, home, dir, log);
  const std::string compiled = fmt::format("{} {}{} -I. -Imodel {} {}", host_compiler(), kCompilerFlags,
                                           arguments, kIncludes, build.compiler_flags);
  run_logged("the C++ compiler",
             fmt::format("{3}{0} -O0 -c once.cpp & once=$!; "
                         "{0} -c each_cycle.cpp; each=$?; wait $once && test $each = 0 && "
                         "{1} -shared -pthread -o library.so each_cycle.o once.o {4} {2}",
                         compiled, host_compiler(), build.libraries, kRoot, shell_word(shared.string())),
             dir, log);
  fs::rename(dir / "library.so", result);
  fs::remove(log, error);
  return result.string();
}

}  // namespace cuboct::emu
