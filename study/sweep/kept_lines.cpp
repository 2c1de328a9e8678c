// SPDX-License-Identifier: MIT
#include "study/sweep/kept_lines.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/output.h"

namespace cuboct::study {

KeptLines::KeptLines(std::string path, uint64_t hash, const std::string& what,
                     const std::function<void(const nlohmann::json&)>& take)
    : path_(std::move(path)), head_(fmt::format("{{\"format\":1,\"study\":\"{:016x}\"}}", hash)) {
  if (!std::filesystem::exists(path_)) return;
  const std::string text = read_text(path_);
  const auto lines = lines_of(text);
  if (lines.front() != head_)
    throw InputError(fmt::format("{} holds {}", path_, what), "take another --out DIR, or remove this one");
  const auto refuse = [this] {
    throw InputError(fmt::format("{}: line {} is none of its results", path_, lines_.size() + 2),
                     "it is damaged: take another --out DIR, or remove the file and begin again");
  };
  try {
    for (size_t k = 1; k + 1 < lines.size(); ++k) {
      take(nlohmann::json::parse(lines[k]));
      lines_.emplace_back(lines[k]);
    }
  } catch (const nlohmann::json::exception&) {
    refuse();
  } catch (const UnfitLine&) {
    refuse();
  }
}

void KeptLines::add(std::string object) {
  std::erase(object, '\n');
  lines_.push_back(std::move(object));
  saved_ = false;
}

void KeptLines::save() {
  if (std::exchange(saved_, true)) return;
  write_text(path_, [&](TextFile& file) {
    file.write(head_ + "\n");
    for (const std::string& line : lines_) file.write(line + "\n");
  });
}

}  // namespace cuboct::study
