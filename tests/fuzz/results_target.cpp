// SPDX-License-Identifier: MIT
// Results of a study, as SQLite and as lines of JSON.
#include <string>

#include "study/sweep/kept_lines.h"
#include "study/sweep/store.h"
#include "study/sweep/study.h"
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {

void take_results(Bytes input) {
  static const study::Study study = study::read_study(in_tree("tests/samples/study.toml"));
  if (input.empty()) return;
  if (input[0] == '{') {
    refusing([&] {
      const study::KeptLines kept(file_of(input, "kept.jsonl"), 1, "another study", [](const auto&) {});
    });
    return;
  }
  const std::string path = file_of(input, "results.db");
  refusing([&] { study::Store::check(path, study); });
  refusing([&] {
    const study::Store store(path, study);
    store.results();
  });
}

}  // namespace cuboct::fuzz
