// SPDX-License-Identifier: MIT
// Inputs that a fuzzer found: each ended cuboct otherwise than by a refusal, once.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

namespace {

namespace fs = std::filesystem;

std::vector<uint8_t> bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Fuzz : public testing::TestWithParam<Target> {};

TEST_P(Fuzz, TakesWhatWasFound) {
  size_t inputs = 0;
  for (const std::string kind : {"finds", "seeds"}) {
    const fs::path folder = fs::path(CUBOCT_SOURCE_DIR "/tests/fuzz") / kind / GetParam().name;
    if (!fs::is_directory(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      SCOPED_TRACE(entry.path().string());
      const std::vector<uint8_t> input = bytes_of(entry.path());
      EXPECT_NO_THROW(GetParam().take(input));
      ++inputs;
    }
  }
  EXPECT_NO_THROW(GetParam().take({}));
  RecordProperty("inputs", static_cast<int>(inputs));
}

std::string name_of(const testing::TestParamInfo<Target>& info) { return std::string(info.param.name); }

INSTANTIATE_TEST_SUITE_P(Model, Fuzz, testing::ValuesIn(model_targets().begin(), model_targets().end()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Machine, Fuzz, testing::ValuesIn(machine_targets().begin(), machine_targets().end()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Study, Fuzz, testing::ValuesIn(study_targets().begin(), study_targets().end()),
                         name_of);

}  // namespace
}  // namespace cuboct::fuzz
