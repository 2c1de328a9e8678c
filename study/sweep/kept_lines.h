// SPDX-License-Identifier: MIT
// Results of a long computation in a file that survives the process, an object of JSON a line. The first line
// says what they are of.
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace cuboct::study {

// Thrown for a line that is none of a study's results.
struct UnfitLine {};

class KeptLines {
 public:
  // Calls `take` with each line of the file, where there is one; its nlohmann::json::exception and UnfitLine
  // are told as an InputError that names the line. `hash`: of all that the results hang on. Throws InputError
  // where the file has another one; `what` says what it then holds: "the fit of another scene".
  KeptLines(std::string path, uint64_t hash, const std::string& what,
            const std::function<void(const nlohmann::json&)>& take);

  // `object` is JSON, with line breaks between its members at most.
  void add(std::string object);
  // Writes what was added: all of the file, or none.
  void save();

  size_t size() const { return lines_.size(); }

 private:
  std::string path_, head_;
  std::vector<std::string> lines_;
  bool saved_ = true;
};

}  // namespace cuboct::study
