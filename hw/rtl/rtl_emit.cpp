// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_emit.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <vector>

#include "hw/rtl/rtl_bench.h"
#include "hw/rtl/rtl_board.h"
#include "hw/rtl/rtl_bus.h"
#include "hw/rtl/rtl_design.h"
#include "hw/rtl/rtl_library.h"
#include "hw/rtl/rtl_prefix.h"
#include "hw/rtl/rtl_project.h"
#include "hw/rtl/rule_datapath.h"
#include "model/base/directory_lock.h"
#include "model/base/output.h"
#include "model/program/integer_program.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

using Files = RtlFiles;

// Every emission begins with this, so that a second one may overwrite it.
constexpr const char* kMarker = ".cuboct-emit";

// The design, with what a rule of text adds.
RtlDesign design_of(const Plan& plan) {
  if (const std::string why = machine_refusal(plan); !why.empty())
    throw InputError("RTL: " + why).about({"rule.file", "rule", "box"});
  RtlDesign design = decide(plan);
  if (plan.program) design.rule = rule_parameters(plan);
  return design;
}

void add_node(Files& files, const RtlDesign& design, const Plan& plan) {
  // What checks links goes only where links are checked; of the two kinds of node one is there.
  // cuboct_sums goes with bricks too: yosys looks into cuboct_datapath with its default parameters first, and
  // wants what one cell needs.
  const std::set<std::string_view> checks{"cuboct_link_crc.sv", "cuboct_link_guard.sv", "cuboct_link_send.sv",
                                          "cuboct_link_take.sv"};
  const std::set<std::string_view> single{
      "cuboct_node_core.sv", "cuboct_candidate.sv",   "cuboct_halos.sv",     "cuboct_inbox.sv",
      "cuboct_migrate.sv",   "cuboct_pair_finder.sv", "cuboct_pair_walk.sv", "cuboct_relay.sv",
      "cuboct_slots.sv",     "cuboct_streamer.sv",    "cuboct_tick.sv",      "cuboct_word_halos.sv",
      "cuboct_word_inbox.sv"};
  const std::set<std::string_view> arrival{"cuboct_arrival_relay.sv", "cuboct_box.sv", "cuboct_cull.sv"};
  // What runs the pair law, and a rule of text does not need.
  const std::set<std::string_view> law{"cuboct_node_core.sv",  "cuboct_datapath.sv",   "cuboct_pipe.sv",
                                       "cuboct_update.sv",     "cuboct_candidate.sv",  "cuboct_halos.sv",
                                       "cuboct_pair_walk.sv",  "cuboct_word_halos.sv", "cuboct_word_inbox.sv",
                                       "cuboct_pair_table.sv", "cuboct_axis_mults.sv", "cuboct_link_rx.sv"};
  const auto used = [&](std::string_view name) {
    if (design.text && law.contains(name)) return false;
    if (checks.contains(name)) return design.checked;
    if (arrival.contains(name)) return design.arrival;
    return design.bricks() ? !single.contains(name) : !name.starts_with("cuboct_brick_");
  };
  for (const RtlSource& source : rtl_library())
    if (used(source.name)) files["rtl/" + std::string(source.name)] = source.text;
  files["rtl/cuboct_pkg.sv"] = print_package(design);
  files["rtl/cuboct_node.sv"] = print_node(design);
  if (design.text) {
    for (const auto* library : {&rtl_pipeline_library(), &rtl_rounds_library()})
      for (const RtlSource& source : *library) files["rtl/" + std::string(source.name)] = source.text;
    for (const pipeline::Module& module : rule_modules(plan))
      files["rtl/" + module.name + ".sv"] = head(design) + module.text;
    return;
  }
  for (const RtlTable& table : design.tables)
    files["rtl/" + table.module + ".sv"] = print_table(design, table);
  if (!design.scale.empty()) files["rtl/cuboct_scale_rom.sv"] = print_scale(design);
  files["rtl/cuboct_type_rom.sv"] = print_types(design);
}

// A page without its links to others, which a project does not hold; those within the page stay.
std::string alone(std::string_view page) {
  static const std::regex link(R"(\[([^\]]*)\]\(([^)#][^)]*)\))");
  return std::regex_replace(std::string(page), link, "$1");
}

void add_pages(Files& files, const RtlDesign& design, bool host) {
  for (const RtlSource& page : rtl_pages())
    if (page.name == "node.md" || (page.name == "links.md" && design.checked) ||
        (page.name == "board.md" && host) || (page.name == "pipeline.md" && design.text))
      files["docs/reference/" + std::string(page.name)] = alone(page.text);
}

// The package first: the others refer to it.
std::vector<std::string> modules_of(const Files& files) {
  std::vector<std::string> list{"rtl/cuboct_pkg.sv"};
  for (const auto& [path, text] : files)
    if (path.ends_with(".sv") && path.starts_with("rtl/") && path != list[0]) list.push_back(path);
  return list;
}

void add_list(Files& files) { files["files.f"] = fmt::format("{}\n", fmt::join(modules_of(files), "\n")); }

// Whether a path of the marker file, which anyone may have edited, names something below the project.
bool stays_inside(const std::string& path) {
  const fs::path normal = fs::path(path).lexically_normal();
  return normal.is_relative() && *normal.begin() != "..";
}

void write(const std::string& dir, const Files& files) {
  check_emit_directory(dir);
  const DirectoryLock lock(dir, "cuboct emit");
  std::error_code error;
  // What an earlier emission wrote and this one does not would be read by a later build.
  std::ifstream earlier(fs::path(dir) / kMarker);
  for (std::string path; std::getline(earlier, path);)
    if (!path.empty() && !files.contains(path) && stays_inside(path)) fs::remove(fs::path(dir) / path, error);
  std::string list;
  for (const auto& [path, text] : files) list += path + "\n";
  write_text((fs::path(dir) / kMarker).string(), list);
  for (const auto& [path, text] : files) {
    fs::create_directories((fs::path(dir) / path).parent_path());
    write_text((fs::path(dir) / path).string(), text);
  }
}

}  // namespace

void check_emit_directory(const std::string& dir) {
  std::error_code error;
  if (!fs::exists(dir, error)) {
    fs::path nearest = fs::absolute(dir).parent_path();
    while (!fs::exists(nearest, error) && nearest.has_relative_path()) nearest = nearest.parent_path();
    if (!fs::is_directory(nearest, error))
      throw InputError(fmt::format("{}: cannot be made, as {} is no directory", dir, nearest.string()));
    if (access(nearest.c_str(), W_OK | X_OK) != 0)
      throw InputError(fmt::format("{}: cannot be made, as {} cannot be written to", dir, nearest.string()));
    return;
  }
  if (!fs::is_directory(dir, error)) throw InputError(fmt::format("{}: is no directory", dir));
  const auto nothing = [](const fs::directory_entry& entry) { return entry.path().filename() == ".lock"; };
  const fs::directory_iterator entries(dir, error);
  if (!std::all_of(entries, fs::directory_iterator(), nothing) && !fs::exists(fs::path(dir) / kMarker, error))
    throw InputError(fmt::format("{}: is not empty and holds no earlier emission", dir),
                     "give an empty or a new directory");
}

void emit_node(const Plan& plan, const std::string& dir) {
  const RtlDesign design = design_of(plan);
  legalise(design, false);
  Files files;
  add_node(files, design, plan);
  add_list(files);
  write(dir, files);
}

namespace {

RtlDesign legal_design(const Plan& plan, const Emission& emission) {
  const BoardChoice& board = emission.board;
  if (!emission.prefix.empty()) check_prefix(emission.prefix);
  if (plan.arch.boards.several())
    plan.arch.places.fail({"boards"},
                          "a project is for one device, and [boards] cuts the machine into several",
                          "leave out [boards]; 'cuboct run --engine rtl' clocks the whole machine with it");
  RtlDesign design = design_of(plan);
  legalise(design, true);
  if (design.text && (!board.name.empty() || !board.bus.empty()) && reads_step(plan.program->program))
    throw InputError(
        fmt::format("{}: the rule '{}' reads the step, which nodes count from their reset, and a host loads "
                    "the state of any step",
                    board.bus.empty() ? "--board " + board.name : "--bus " + board.bus,
                    plan.program->program.name),
        "emit the lattice without it: its ports take and show the rule's particles")
        .about({"rule.file", "rule"});
  if (!board.name.empty()) legalise_board(plan, board);
  if (!board.bus.empty()) legalise_bus(plan, board);
  if (!board.name.empty() || !board.bus.empty())
    if (sets_velocities(plan, board)) design.moved = moved_types(plan.rule);
  return design;
}

}  // namespace

void check_emission(const Plan& plan, const Emission& emission) { legal_design(plan, emission); }

void emit_rtl(const Plan& plan, const State& initial, const std::string& dir, const Emission& emission) {
  const BoardChoice& board = emission.board;
  const RtlDesign design = legal_design(plan, emission);
  Files files;
  add_node(files, design, plan);
  for (const RtlSource& source : rtl_lattice_library())
    files["rtl/" + std::string(source.name)] = source.text;
  files["rtl/cuboct_lattice.sv"] = print_lattice(design);
  add_list(files);
  add_pages(files, design, !board.name.empty() || !board.bus.empty());
  if (!emission.arch.empty()) files["arch.toml"] = emission.arch;
  files["project.json"] = print_project(plan, initial, modules_of(files), emission.counted);
  for (auto& [path, text] : print_bench(plan, design, initial, emission.vector_steps))
    files[path] = std::move(text);
  if (!board.name.empty()) {
    for (auto& [path, text] : print_board(plan, design, board)) files[path] = std::move(text);
    files["board/files.f"] = list_with(files["files.f"], "board", files);
    files["README.md"] += print_board_readme(plan, board);
  }
  if (!board.bus.empty()) {
    for (auto& [path, text] : print_bus(plan, design, board)) files[path] = std::move(text);
    files["bus/files.f"] = list_with(files["files.f"], "bus", files);
    files["README.md"] += print_bus_readme(plan, board);
  }
  write(dir, with_prefix(files, emission.prefix));
}

}  // namespace cuboct
