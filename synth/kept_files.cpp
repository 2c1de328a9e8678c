// SPDX-License-Identifier: MIT
#include "synth/kept_files.h"

#include <unistd.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <system_error>

#include "model/base/output.h"
#include "model/base/resources.h"
#include "synth/json_file.h"

namespace cuboct::synth {
namespace {

namespace fs = std::filesystem;

// Sizes of the files of an entry, by their names: written last.
constexpr const char* kList = "kept.json";

uint64_t bytes_below(const fs::path& directory) {
  uint64_t bytes = 0;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(directory, none))
    if (const auto size = file.file_size(none); !none) bytes += size;
  return bytes;
}

}  // namespace

KeptFiles::KeptFiles(std::string directory, uint64_t most) : directory_(std::move(directory)), most_(most) {}

bool KeptFiles::take(const std::string& key, const std::string& to) const {
  if (directory_.empty()) return false;
  const fs::path entry = fs::path(directory_) / key;
  std::error_code none;
  if (!fs::is_regular_file(entry / kList, none)) return false;
  std::vector<fs::path> taken;
  try {
    const nlohmann::json list = read_json((entry / kList).string());
    for (const auto& [name, size] : list.items())
      if (fs::file_size(entry / name) != size.get<uint64_t>()) return false;
    for (const auto& [name, size] : list.items()) {
      taken.push_back(fs::path(to) / name);
      fs::copy_file(entry / name, taken.back(), fs::copy_options::overwrite_existing);
    }
    fs::last_write_time(entry / kList, fs::file_time_type::clock::now(), none);
    return true;
  } catch (const std::exception&) {
    // Damaged, or another process made room in the meantime.
    for (const fs::path& file : taken) fs::remove(file, none);
    return false;
  }
}

bool KeptFiles::keep(const std::string& key, const std::string& from,
                     const std::vector<std::string>& files) const {
  if (directory_.empty()) return false;
  const fs::path entry = fs::path(directory_) / key;
  const fs::path temporary = temporary_beside(entry.string());
  std::error_code none;
  try {
    make_directory(temporary.string());
    nlohmann::ordered_json list;
    for (const std::string& name : files) {
      fs::copy_file(fs::path(from) / name, temporary / name);
      list[name] = fs::file_size(temporary / name);
    }
    write_text((temporary / kList).string(), list.dump(2) + "\n");
    fs::remove_all(entry);  // one that was not whole
    fs::rename(temporary, entry);
    make_room(key);
    return true;
  } catch (const std::exception&) {
    fs::remove_all(temporary, none);
    return false;
  }
}

void KeptFiles::make_room(const std::string& newest) const {
  struct Entry {
    fs::path path;
    fs::file_time_type used;
    uint64_t bytes;
  };
  std::vector<Entry> entries;
  std::error_code none;
  uint64_t all = 0;
  for (const auto& found : fs::directory_iterator(directory_)) {
    const auto used = fs::last_write_time(found.path() / kList, none);
    if (none) continue;  // of another process, which is about to keep it
    entries.push_back({found.path(), used, bytes_below(found.path())});
    all += entries.back().bytes;
  }
  std::ranges::sort(entries, {}, &Entry::used);
  for (const Entry& entry : entries) {
    if (all <= most_) return;
    if (entry.path.filename() == newest) continue;
    fs::remove_all(entry.path, none);
    all -= entry.bytes;
  }
}

KeptFiles kept_in_cache(const std::string& kind) {
  const std::string cache = cache_directory();
  return KeptFiles(cache.empty() ? "" : cache + "/" + kind);
}

}  // namespace cuboct::synth
