// SPDX-License-Identifier: MIT
#include "cli/stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "cli/items.h"
#include "cli/outputs.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/run/start.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

std::string directory_of(const StageRun& request, size_t k) {
  return fmt::format("{}/{}-{}", request.out, k + 1, request.names[k]);
}

std::optional<RunRecord> record_in(const std::string& directory) {
  if (!fs::exists(directory + "/run.toml")) return std::nullopt;
  return read_record(directory);
}

bool is_finished(const std::string& directory) {
  const auto record = record_in(directory);
  return record && record->state == "finished";
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
  items.add(fmt::format("stage {}-{}", k + 1, request.names[k]), record ? record->state : "not begun",
            record ? directory : "");
}

std::string json_of(const StageRun& request, size_t first, size_t end) {
  std::string text = "{\"stages\": [";
  for (size_t k = first; k < end; ++k) {
    const std::string directory = directory_of(request, k), path = directory + "/summary.json";
    const auto record = record_in(directory);
    const bool there = record && is_over(*record) && fs::exists(path);
    text += fmt::format("{}\n{{\"name\": {}, \"directory\": {}, \"state\": {}, \"summary\": {}}}",
                        k > first ? "," : "", json(request.names[k]),
                        json(fs::path(directory).filename().string()),
                        json(record ? record->state : "not begun"), there ? read_text(path) : "null");
  }
  return text + "]}\n";
}

}  // namespace

int run_stages(const StageRun& request,
               const std::function<std::pair<int, bool>(const StageDirectory&)>& run) {
  size_t first = 0, end = request.names.size();
  if (!request.only.empty()) {
    const auto found = std::ranges::find(request.names, request.only);
    if (found == request.names.end())
      read_scene(request.scene, {.begins = true, .stage = request.only});  // throws
    first = static_cast<size_t>(found - request.names.begin());
    end = first + 1;
  }
  for (size_t k = first; k < end; ++k) read_scene(request.scene, {.begins = true, .stage = request.names[k]});
  if (!request.resume) outdate(request, first, end);

  int code = 0;
  bool begun = false;
  size_t k = first;
  for (; k < end; ++k) {
    StageDirectory stage{request.names[k], directory_of(request, k), {}};
    if (k == first && !request.from.empty())
      stage.from = request.from;
    else if (k > 0)
      stage.from = directory_of(request, k - 1);
    if (k > first || (k > 0 && request.from.empty()))
      if (!is_finished(stage.from))
        throw InputError(
            fmt::format("stage '{}' begins where '{}' ended, and {} holds no run that is finished",
                        stage.name, request.names[k - 1], stage.from),
            "--from DIR begins elsewhere");
    if (request.resume && !begun && is_finished(stage.path)) continue;
    stage.resume = request.resume && !begun && fs::exists(stage.path + "/checkpoint");
    // outdate() has refused runs that are to stay; files that no run left stay too.
    stage.force = request.force || (!stage.resume && record_in(stage.path));
    begun = true;
    if (!request.json) fmt::print("stage {}-{}\n", k + 1, stage.name);
    const auto [stage_code, whole] = run(stage);
    code = std::max(code, stage_code);
    if (!whole) break;
    if (!request.json) fmt::print("\n");
  }
  if (!request.only.empty()) return code;
  Items items;
  for (size_t n = first; n < end; ++n) tell(items, request, n);
  const std::string all = json_of(request, first, end);
  write_text(request.out + "/summary.json", all);
  fmt::print("{}", request.json ? all : items.text());
  return code;
}

}  // namespace cuboct
