// SPDX-License-Identifier: MIT
#include "synth/project.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hw/rtl/rtl_prefix.h"
#include "hw/rtl/rtl_project.h"
#include "model/base/error.h"
#include "synth/json_file.h"

namespace cuboct::synth {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kHint = "cuboct emit SCENE --out DIR makes a project";

// An entry of project.json, or an InputError that names it.
template <class T>
T entry(const Json& json, const std::string& file, const std::string& name) {
  const Json::json_pointer at("/" + name);
  try {
    return json.at(at).get<T>();
  } catch (const Json::exception&) {
    throw InputError(fmt::format("{}: no '{}' as cuboct emit writes it", file, name), kHint);
  }
}

std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

}  // namespace

Project read_project(const std::string& directory) {
  const fs::path dir(directory);
  if (!fs::is_directory(dir)) throw InputError(fmt::format("{}: no such directory", directory), kHint);
  const std::string file = (dir / "project.json").string();
  std::ifstream in(file);
  if (!in)
    throw InputError(fmt::format("{}: is no project of cuboct emit: it has no project.json", directory),
                     kHint);
  Json json;
  try {
    json = read_json(file);
  } catch (const std::runtime_error& error) {
    throw InputError(error.what(), kHint);
  }
  // Projects of before there were versions are like the first.
  const auto version =
      json.is_object() && json.contains("version") ? entry<uint64_t>(json, file, "version") : kProjectVersion;
  if (version != kProjectVersion)
    throw InputError(fmt::format("{}: a project of version {}: this cuboct reads version {}", file, version,
                                 kProjectVersion),
                     "emit it again, or take the cuboct that wrote it");
  Project project;
  project.directory = directory;
  project.plan = entry<std::string>(json, file, "plan");
  project.nodes = entry<uint64_t>(json, file, "nodes");
  project.particles = entry<uint64_t>(json, file, "particles");
  project.capacity = entry<int>(json, file, "arch/capacity");
  // Neither is in every project: rules of text have none that is expected, a run may end in its first step.
  if (json.contains("/cycles_per_step/expected"_json_pointer))
    project.cycles.expected = entry<uint64_t>(json, file, "cycles_per_step/expected");
  if (json.contains("/cycles_per_step/counted"_json_pointer)) {
    project.cycles.mean = entry<double>(json, file, "cycles_per_step/counted/mean");
    project.cycles.most = entry<uint64_t>(json, file, "cycles_per_step/counted/most");
    project.cycles.steps = entry<uint64_t>(json, file, "cycles_per_step/counted/steps");
  }
  project.files = entry<std::vector<std::string>>(json, file, "files");
  for (const std::string& f : project.files)
    if (!fs::is_regular_file(dir / f))
      throw InputError(fmt::format("{}: names {}, which is not there", file, f), "emit the project again");
  project.prefix = prefix_of(project.files);
  return project;
}

Board read_board(const Project& project) {
  const fs::path dir = fs::path(project.directory) / "board";
  if (!fs::is_regular_file(dir / "files.f"))
    throw InputError(fmt::format("{}: has no board/", project.directory),
                     "cuboct emit SCENE --out DIR --board BOARD writes one");
  Board board;
  board.top = project.prefix + "cuboct_board_top";
  board.files = lines_of(dir / "files.f");
  for (const std::string& f : board.files)
    if (!fs::is_regular_file(fs::path(project.directory) / f))
      throw InputError(fmt::format("{}/files.f: names {}, which is not there", dir.string(), f),
                       "emit the project again");
  for (const char* pins : {"board/pins.pcf", "board/pins.lpf"})
    if (fs::is_regular_file(fs::path(project.directory) / pins)) board.pins = pins;
  if (board.pins.empty())
    throw InputError(fmt::format("{}/board: has neither pins.pcf nor pins.lpf", project.directory));
  return board;
}

}  // namespace cuboct::synth
