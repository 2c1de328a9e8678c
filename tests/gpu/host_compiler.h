// SPDX-License-Identifier: MIT
// The host's compiler in place of CUDA's, for engines with loops for kernels.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "emu/gpu/rounds/rounds_engine.h"
#include "emu/gpu/rounds/rounds_text.h"
#include "model/base/output.h"

namespace cuboct::test {

// `change`: of the text that is compiled.
inline gpu::CompileRounds host_compiler(const std::string& name,
                                        const std::function<void(std::string&)>& change = {}) {
  return [=](std::string source, const std::string& architecture) {
    EXPECT_EQ(architecture, "host");
    if (change) change(source);
    const auto dir = std::filesystem::path(testing::TempDir()) / ("compiled_" + name);
    for (const auto& [file, text] : gpu::round_headers()) {
      std::filesystem::create_directories((dir / file).parent_path());
      write_text((dir / file).string(), text);
    }
    write_text((dir / "rounds.cpp").string(), source);
    const std::string command =
        fmt::format("cd {} && c++ -std=c++20 -O1 -shared -fPIC -I. -o rounds.so rounds.cpp", dir.string());
    if (std::system(command.c_str()) != 0) throw std::runtime_error("the host's compiler fails");
    return (dir / "rounds.so").string();
  };
}

inline std::string note(const Notes& notes, const std::string& name) {
  for (const auto& [key, text] : notes)
    if (key == name) return text;
  return {};
}

// The host takes any number of devices.
inline gpu::Options of_slabs(int slabs) {
  gpu::Options options;
  options.devices.clear();
  for (int s = 0; s < slabs; ++s) options.devices.push_back(s);
  return options;
}

}  // namespace cuboct::test
