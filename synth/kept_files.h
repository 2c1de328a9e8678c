// SPDX-License-Identifier: MIT
// Files that took long to make, kept under the key of all that they were made of (input_key.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cuboct::synth {

class KeptFiles {
 public:
  // Of a directory with an entry, a directory of its own, for each key. Empty: nothing is kept. With more
  // than `most` bytes the entries go that were asked for the longest ago.
  explicit KeptFiles(std::string directory, uint64_t most = uint64_t{1} << 30);

  // Copies what is kept under `key` into `to`. False where there is nothing, or an entry that is not whole.
  bool take(const std::string& key, const std::string& to) const;

  // Keeps copies of these files of `from`, whole or not at all. False: they cannot be kept, and are made
  // again another time.
  bool keep(const std::string& key, const std::string& from, const std::vector<std::string>& files) const;

  const std::string& directory() const { return directory_; }

 private:
  void make_room(const std::string& newest) const;

  std::string directory_;
  uint64_t most_;
};

// In the user's cache directory: KIND below it.
KeptFiles kept_in_cache(const std::string& kind);

}  // namespace cuboct::synth
