// SPDX-License-Identifier: MIT
#include "synth/stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "model/base/clock.h"

namespace cuboct::synth {
namespace {

std::set<std::string> files_in(const std::string& directory) {
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(directory))
    if (file.is_regular_file()) names.insert(file.path().filename().string());
  return names;
}

}  // namespace

Stages::Stages(std::string directory, KeptFiles kept, std::vector<std::string> names, Say tells)
    : directory_(std::move(directory)),
      kept_(std::move(kept)),
      names_(std::move(names)),
      tells_(std::move(tells)) {}

std::string Stages::expected() const {
  const auto time = times_.find(name_);
  return time == times_.end() ? "" : time->second.text;
}

void Stages::make(const std::string& name, const InputKey& key, const std::function<void()>& work) {
  name_ = name;
  pending_ = {};
  told_ = kept_.take(key.text(), directory_);
  if (told_) {
    known_.push_back(name);
    return;
  }
  if (!announced_) announce(name);
  const std::set<std::string> before = files_in(directory_);
  time(work);
  std::set<std::string> files = files_in(directory_);
  std::erase_if(files, [&](const std::string& file) { return before.contains(file); });
  pending_ = {key.text(), {files.begin(), files.end()}};
}

void Stages::make_again(const std::string& name, const std::function<void()>& work) {
  name_ = name;
  time(work);
  told_ = !announced_;
}

void Stages::time(const std::function<void()>& work) {
  const Clock::time_point begin = Clock::now();
  work();
  seconds_ = seconds_since(begin);
}

void Stages::announce(const std::string& first) {
  announced_ = true;
  std::string line;
  for (auto name = std::ranges::find(names_, first); name != names_.end(); ++name) {
    line += fmt::format("{}{}", line.empty() ? "" : ", ", *name);
    if (const auto time = times_.find(*name); time != times_.end()) {
      line += fmt::format(" ({})", time->second.text);
      time->second.told = true;
    }
  }
  if (!known_.empty()) line += fmt::format("; known from before: {}", fmt::join(known_, ", "));
  tells_(line);
}

void Stages::found(const std::string& what) {
  // What was found has been read from its files: a tool on a full disk may end well and leave a part of them.
  if (!pending_.key.empty()) made_ = kept_.keep(pending_.key, directory_, pending_.files) || made_;
  pending_ = {};
  if (told_) return;
  told_ = true;
  std::string line = fmt::format("{}: {:.{}f} s, {}", name_, seconds_, seconds_ < 10 ? 1 : 0, what);
  for (auto name = std::ranges::find(names_, name_) + 1; name < names_.end(); ++name)
    if (const auto time = times_.find(*name); time != times_.end() && !std::exchange(time->second.told, true))
      line += fmt::format("; {}: {}", *name, time->second.text);
  tells_(line);
}

}  // namespace cuboct::synth
