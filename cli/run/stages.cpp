// SPDX-License-Identifier: MIT
#include "cli/run/stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "cli/items.h"
#include "cli/run/outputs.h"
#include "model/base/input_file.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/run/start.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

std::string directory_of(const std::string& out, const std::vector<StageName>& names, size_t k) {
  return out + "/" + stage_title(names, k);
}

std::string directory_of(const StageRun& request, size_t k) {
  return directory_of(request.out, request.names, k);
}

std::optional<RunRecord> record_in(const std::string& directory) {
  if (!is_file(directory + "/run.toml")) return std::nullopt;
  return read_record(directory);
}

bool is_finished(const std::string& directory) {
  const auto record = record_in(directory);
  return record && record->state == "finished";
}

// The part that ended the stage of part k before it: there the scene's `until` held.
std::optional<size_t> ended_before(const std::string& out, const std::vector<StageName>& names, size_t k) {
  for (size_t part = k - names[k].part; part < k; ++part)
    if (const auto record = record_in(directory_of(out, names, part));
        record && record->state == "finished" && record->reached)
      return part;
  return std::nullopt;
}

std::optional<size_t> ended_before(const StageRun& request, size_t k) {
  return ended_before(request.out, request.names, k);
}

// What stages of an earlier run left must not pass for those of this one: `--resume` would skip them.
void outdate(const StageRun& request, size_t first, size_t end) {
  for (const bool write : {false, true})
    for (size_t k = first; k < end; ++k) {
      const std::string directory = directory_of(request, k);
      auto record = record_in(directory);
      if (!record) continue;
      if (!write && !is_over(*record) && record->state != "outdated" && !request.force)
        throw InputError(fmt::format("{} holds a run that did not end", directory),
                         "--resume goes on with it; --force begins anew in its place");
      if (!write) continue;
      record->state = "outdated";
      write_record(directory, *record);
    }
}

// One line of the table over all stages.
void tell(Items& items, const StageRun& request, size_t k) {
  const std::string directory = directory_of(request, k);
  const auto record = record_in(directory);
  const std::string title = "stage " + stage_title(request.names, k);
  if (const auto part = ended_before(request, k))
    items.add(title, "not needed", fmt::format("'until' held in {}", request.names[*part].name));
  else
    items.add(title, record ? record->state : "not begun", record ? directory : "");
}

std::string json_of(const StageRun& request, size_t first, size_t end) {
  std::string text = "{\"stages\": [";
  for (size_t k = first; k < end; ++k) {
    const std::string directory = directory_of(request, k), path = directory + "/summary.json";
    const auto record = record_in(directory);
    const bool there = record && is_over(*record) && fs::exists(path);
    text +=
        fmt::format("{}\n{{\"name\": {}, \"directory\": {}, \"state\": {}, \"summary\": {}}}",
                    k > first ? "," : "", json(request.names[k].name), json(stage_title(request.names, k)),
                    json(ended_before(request, k) ? "not needed"
                         : record                 ? record->state
                                                  : "not begun"),
                    there ? read_text(path) : "null");
  }
  return text + "]}\n";
}

}  // namespace

StageRange stages_to_take(const std::string& scene, const std::vector<StageName>& names,
                          const std::string& only) {
  if (only.empty()) return {0, names.size()};
  const auto wanted = [&](const StageName& one) { return one.name == only || one.stage == only; };
  const auto first = std::ranges::find_if(names, wanted);
  if (first == names.end()) read_scene(scene, {.begins = true, .stage = only});  // throws
  const auto end = std::find_if_not(first, names.end(), wanted);
  return {static_cast<size_t>(first - names.begin()), static_cast<size_t>(end - names.begin())};
}

std::string stage_title(const std::vector<StageName>& names, size_t k) {
  return fmt::format("{}-{}", k + 1, names[k].name);
}

std::string stage_start(const std::string& out, const std::vector<StageName>& names, size_t k) {
  return directory_of(out, names, ended_before(out, names, k - 1).value_or(k - 1));
}

int run_stages(const StageRun& request,
               const std::function<std::pair<int, bool>(const StageDirectory&)>& run) {
  const auto [first, end] = stages_to_take(request.scene, request.names, request.only);
  for (size_t k = first; k < end; ++k)
    read_scene(request.scene, {.begins = true, .stage = request.names[k].name});
  if (!request.resume) outdate(request, first, end);

  int code = 0;
  bool begun = false;
  size_t k = first;
  for (; k < end; ++k) {
    StageDirectory stage{request.names[k].name, directory_of(request, k), {}};
    if (k > first && ended_before(request, k)) continue;
    if (k == first && !request.from.empty())
      stage.from = request.from;
    else if (k > 0)
      stage.from = stage_start(request.out, request.names, k);
    if (k > first || (k > 0 && request.from.empty()))
      if (!is_finished(stage.from))
        throw InputError(
            fmt::format("stage '{}' begins where '{}' ended, and {} holds no run that is finished",
                        stage.name, request.names[k - 1].name, stage.from),
            "--from DIR begins elsewhere");
    if (request.resume && !begun && is_finished(stage.path)) continue;
    stage.resume = request.resume && !begun && fs::exists(stage.path + "/checkpoint");
    // outdate() has refused runs that are to stay; files that no run left stay too.
    stage.force = request.force || (!stage.resume && record_in(stage.path));
    begun = true;
    if (!request.json) fmt::print("stage {}\n", stage_title(request.names, k));
    const auto [stage_code, whole] = run(stage);
    code = std::max(code, stage_code);
    if (!whole) break;
    if (!request.json) fmt::print("\n");
  }
  if (!request.only.empty() && !request.json) return code;
  Items items;
  for (size_t n = first; n < end; ++n) tell(items, request, n);
  const std::string all = json_of(request, first, end);
  // DIR's own summary is that of all stages.
  if (request.only.empty()) write_text(request.out + "/summary.json", all);
  fmt::print("{}", request.json ? all : items.text());
  return code;
}

}  // namespace cuboct
