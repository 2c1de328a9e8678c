// SPDX-License-Identifier: MIT
#include "emu/verilated/library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "emu/verilated/sources.h"
#include "hw/rtl/rtl_emit.h"
#include "hw/rtl/rtl_prefix.h"
#include "model/base/output.h"
#include "model/base/resources.h"

namespace cuboct::emu {
namespace {

namespace fs = std::filesystem;

// Of shim_sources(): one *.cpp and the headers.
std::vector<std::pair<std::string, std::string>> with_headers(const std::string& shim) {
  std::vector<std::pair<std::string, std::string>> sources;
  for (const auto& [name, text] : shim_sources())
    if (name == shim || name.ends_with(".h")) sources.emplace_back(name, text);
  return sources;
}

template <typename F>
void find_symbol(void* handle, const char* name, F& function) {
  function = reinterpret_cast<F>(dlsym(handle, name));
}

// The project's files, all below rtl/, which is what the library's name stands for, and without their prefix:
// what is the same but for that is compiled once.
void copy_board(const fs::path& project, const std::vector<std::string>& files, const fs::path& dir) {
  fs::create_directories(dir / "rtl");
  std::ofstream list(dir / "files.f");
  const std::string prefix = prefix_of(files);
  for (const std::string& path : files) {
    const std::string name = without_prefix(fs::path(path).filename().string(), prefix),
                      from = (project / path).string();
    std::ifstream source(from, std::ios::binary);
    std::ostringstream text;
    text << source.rdbuf();
    if (!source || !fs::is_regular_file(from)) throw InputError(fmt::format("{}: cannot be read", from));
    write_text((dir / "rtl" / name).string(), without_prefix(text.str(), prefix));
    list << "rtl/" << name << "\n";
  }
}

bool is_bus(const fs::path& project) { return fs::exists(project / "bus" / "files.f"); }

}  // namespace

std::string default_build_directory() {
  if (std::string directory = cache_directory(); !directory.empty()) return directory;
  throw InputError("neither XDG_CACHE_HOME nor HOME is set: no place to keep compiled nodes",
                   "give one with --build-dir");
}

Build node_build(const Plan& plan, const std::string& optimise) {
  return {.top = "cuboct_node",
          .verilator_flags = "--cc",
          .compiler_flags = optimise + " -fno-semantic-interposition",
          .constants = {{"FACES", 2 * plan.rule.axes},
                        {"LINK_BITS", plan.link.wire_bits},
                        {"ACK_BITS", plan.link.ack_bits},
                        {"PARTICLE_BITS", plan.words.particle_bits},
                        {"BRICK", plan.bricks.one_cell() ? 0 : 1},
                        {"EVENTS", 1 + 3 * plan.arch.streamers},
                        {"STAGES", plan.program ? 1 : 0}},
          .sources = with_headers("shim_node.cpp"),
          .emit = [&plan](const std::string& dir) { emit_node(plan, dir); }};
}

std::string compile_node(const Plan& plan, const std::string& build_directory, const std::string& optimise) {
  return compile(node_build(plan, optimise), build_directory);
}

// All ports of more than one bit become sc_bv.
std::string compile_lattice(const Plan& plan, const State& initial, const std::string& build_directory,
                            const std::string& optimise) {
  return compile({.top = "cuboct_lattice",
                  .verilator_flags = "--sc --pins-bv 2 -GProbe=1",
                  .compiler_flags = optimise,
                  .libraries = "-lsystemc",
                  .constants = {{"NODES", static_cast<int>(plan.nodes())},
                                {"PARTICLE_BITS", plan.words.particle_bits},
                                {"ID_BITS", plan.words.id_bits},
                                {"CELL_BITS", plan.bricks.cell_bits()}},
                  .sources = with_headers("shim_lattice.cpp"),
                  .emit = [&](const std::string& dir) { emit_rtl(plan, initial, dir); }},
                 build_directory);
}

std::vector<std::string> board_files(const std::string& project) {
  const fs::path names = fs::path(project) / (is_bus(project) ? "bus" : "board") / "files.f";
  std::ifstream list(names);
  if (!list)
    throw InputError(fmt::format("{} holds no board: there is no {}", project, names.string()),
                     "make one with 'cuboct emit SCENE --board icebreaker --out DIR'");
  std::vector<std::string> files;
  for (std::string path; std::getline(list, path);)
    if (!path.empty()) files.push_back(path);
  return files;
}

std::string compile_board(const std::string& project, const std::string& build_directory) {
  const fs::path from = project;
  const std::vector<std::string> files = board_files(project);
  if (is_bus(project)) {
    const bool axi = fs::exists(from / "bus" / (prefix_of(files) + "cuboct_axi4lite.sv"));
    return compile({.top = axi ? "cuboct_axi4lite" : "cuboct_wishbone",
                    .verilator_flags = "--cc",
                    .compiler_flags = "-O1 -fno-semantic-interposition",
                    .constants = {{"BUS_AXI", axi ? 1 : 0}},
                    .sources = with_headers("shim_bus.cpp"),
                    .emit = [&](const std::string& dir) { copy_board(from, files, dir); }},
                   build_directory);
  }
  return compile({.top = "cuboct_board_top",
                  .verilator_flags = "--cc",
                  .compiler_flags = "-O1 -fno-semantic-interposition",
                  .constants = {},
                  .sources = with_headers("shim_board.cpp"),
                  .emit = [&](const std::string& dir) { copy_board(from, files, dir); }},
                 build_directory);
}

Library::Library(const std::string& path) : handle_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) throw InputError(fmt::format("cannot load {}: {}", path, dlerror()));
  int (*abi)() = nullptr;
  find_symbol(handle_, "cuboct_abi", abi);
  find_symbol(handle_, "cuboct_create", create);
  find_symbol(handle_, "cuboct_destroy", destroy);
  find_symbol(handle_, "cuboct_clock", clock);
  find_symbol(handle_, "cuboct_place", place);
  find_symbol(handle_, "cuboct_clock_lattice", clock_lattice);
  find_symbol(handle_, "cuboct_clock_board", clock_board);
  find_symbol(handle_, "cuboct_clock_bus", clock_bus);
  if (abi == nullptr || abi() != kCuboctAbi || create == nullptr || destroy == nullptr ||
      (clock == nullptr && clock_lattice == nullptr && clock_board == nullptr && clock_bus == nullptr)) {
    dlclose(handle_);
    throw InputError(fmt::format("{} is not a library of this version", path),
                     "remove it: it will be built anew");
  }
}

Library::~Library() { dlclose(handle_); }

}  // namespace cuboct::emu
