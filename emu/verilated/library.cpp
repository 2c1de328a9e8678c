// SPDX-License-Identifier: MIT
#include "emu/verilated/library.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "emu/verilated/sources.h"
#include "hw/rtl_emit.h"
#include "model/hash.h"

namespace cuboct::emu {
namespace {

namespace fs = std::filesystem;

// For the shell: 'it'\''s'.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

bool succeeds(const std::string& command) {
  const int status = std::system(command.c_str());
  return status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void require_tool(const std::string& tool, const std::string& package) {
  if (!succeeds("command -v " + quoted(tool) + " > /dev/null 2>&1"))
    throw InputError(fmt::format("{} is missing: the rtl engine compiles the emitted hardware with it", tool),
                     "on Debian: apt install " + package);
}

std::string read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_file(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw InputError(fmt::format("cannot write {}", path.string()));
}

std::string compiler() {
  const char* cxx = std::getenv("CXX");
  return cxx != nullptr && *cxx != 0 ? cxx : "c++";
}

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

struct Build {
  std::string top;       // module
  std::string shim;      // file of shim_sources()
  std::string optimise;  // -O3 for the node that runs scenes, less for a lattice in tests
  std::vector<std::pair<std::string, int>> constants;  // of the shim
  std::function<void(const std::string& dir)> emit;
};

constexpr const char* kVerilatorFlags = "--cc -O3 -fno-const-bit-op-tree --assert -Wno-fatal";
constexpr const char* kCompilerFlags =
    "-std=c++17 -fPIC -shared -fno-gnu-unique -w -DVM_COVERAGE=0 -DVM_SC=0 -DVM_TRACE=0 -DVM_TIMING=0";

uint64_t key_of(const Build& build, const fs::path& dir) {
  std::map<std::string, std::string> files;  // in the order of names
  for (const auto& entry : fs::recursive_directory_iterator(dir / "rtl"))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), dir).string()] = read_file(entry.path());
  Hash hash;
  for (const auto& [name, text] : files) add_code(hash, "file " + name + "\n" + text);
  for (const auto& [name, text] : shim_sources()) add_code(hash, text);
  for (const auto& [name, value] : build.constants) add_code(hash, fmt::format("{}={}", name, value));
  add_code(hash, build.top + kVerilatorFlags + kCompilerFlags + build.optimise + compiler());
  return hash.value();
}

void run_logged(const std::string& what, const std::string& command, const fs::path& dir,
                const fs::path& log) {
  const std::string line =
      fmt::format("cd {} && ({}) >> {} 2>&1", quoted(dir.string()), command, quoted(log.string()));
  if (!succeeds(line)) throw InputError(fmt::format("{} failed: see {}", what, log.string()));
}

std::string compile(const Build& build, const std::string& build_directory) {
  std::error_code error;
  fs::create_directories(build_directory, error);
  if (error)
    throw InputError(fmt::format("cannot make the directory {}: {}", build_directory, error.message()));
  std::string pattern = (fs::path(build_directory) / (build.top + "-XXXXXX")).string();
  if (mkdtemp(pattern.data()) == nullptr)
    throw InputError(fmt::format("cannot write in {}", build_directory));
  const fs::path dir = fs::absolute(pattern);
  const fs::path rtl = dir / "emitted";
  build.emit(rtl.string());
  const uint64_t key = key_of(build, rtl);
  const fs::path result =
      fs::absolute(fs::path(build_directory) / fmt::format("{}-{:016x}.so", build.top, key));
  if (fs::exists(result)) {
    fs::remove_all(dir);
    return result.string();
  }
  require_tool("verilator", "verilator");
  require_tool(compiler(), "g++");
  const fs::path log = dir / "log.txt";
  // One copy of the node's code serves all nodes of a lattice; inlined, the build takes minutes.
  write_file(dir / "keep.vlt", "`verilator_config\nno_inline -module \"cuboct_node_core\"\n");
  run_logged("verilator",
             fmt::format("verilator {} --top-module {} --prefix V{} -Mdir {} ../keep.vlt -f files.f",
                         kVerilatorFlags, build.top, build.top, quoted((dir / "model").string())),
             rtl, log);
  for (const auto& [name, text] : shim_sources()) write_file(dir / name, text);
  std::string constants;
  for (const auto& [name, value] : build.constants) constants += fmt::format(" -D{}={}", name, value);
  run_logged(
      "the C++ compiler",
      fmt::format("root=$(verilator --getenv VERILATOR_ROOT) && {} {} {}{} -I. -Imodel -I\"$root/include\" "
                  "-I\"$root/include/vltstd\" {} model/*.cpp \"$root/include/verilated.cpp\" "
                  "\"$root/include/verilated_threads.cpp\" -o library.so -pthread",
                  compiler(), kCompilerFlags, build.optimise, constants, build.shim),
      dir, log);
  fs::rename(dir / "library.so", result);
  fs::remove_all(dir);
  return result.string();
}

template <typename F>
void find_symbol(void* handle, const char* name, F& function) {
  function = reinterpret_cast<F>(dlsym(handle, name));
}

}  // namespace

std::string default_build_directory() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != 0)
    return (fs::path(cache) / "cuboct").string();
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != 0)
    return (fs::path(home) / ".cache" / "cuboct").string();
  throw InputError("neither XDG_CACHE_HOME nor HOME is set: no place to keep compiled nodes",
                   "give one with --build-dir");
}

std::string compile_node(const Plan& plan, const std::string& build_directory) {
  return compile({"cuboct_node",
                  "shim_node.cpp",
                  "-O3",
                  {{"LINK_BITS", plan.words.link_bits}, {"PARTICLE_BITS", plan.words.particle_bits}},
                  [&](const std::string& dir) { emit_node(plan, dir); }},
                 build_directory);
}

std::string compile_lattice(const Plan& plan, const State& initial, const std::string& build_directory) {
  return compile({"cuboct_lattice",
                  "shim_lattice.cpp",
                  "-O1",
                  {{"NODES", static_cast<int>(plan.lattice.size())},
                   {"PARTICLE_BITS", plan.words.particle_bits},
                   {"ID_BITS", plan.words.id_bits}},
                  [&](const std::string& dir) { emit_rtl(plan, initial, dir, 1); }},
                 build_directory);
}

Library::Library(const std::string& path) : handle_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) throw InputError(fmt::format("cannot load {}: {}", path, dlerror()));
  int (*abi)() = nullptr;
  find_symbol(handle_, "cuboct_abi", abi);
  find_symbol(handle_, "cuboct_create", create);
  find_symbol(handle_, "cuboct_destroy", destroy);
  find_symbol(handle_, "cuboct_clock", clock);
  find_symbol(handle_, "cuboct_clock_lattice", clock_lattice);
  if (abi == nullptr || abi() != kCuboctAbi || create == nullptr || destroy == nullptr ||
      (clock == nullptr && clock_lattice == nullptr)) {
    dlclose(handle_);
    throw InputError(fmt::format("{} is not a library of this version", path),
                     "remove it: it will be built anew");
  }
}

Library::~Library() { dlclose(handle_); }

}  // namespace cuboct::emu
