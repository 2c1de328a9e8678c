// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/host_code.h"

#include <fmt/format.h>

#include <filesystem>

#include "emu/gpu/rounds/rounds_text.h"
#include "model/base/host_compiler.h"
#include "model/base/output.h"

namespace cuboct::gpu {

std::string host_file(const std::string& source, const std::string& directory) {
  namespace fs = std::filesystem;
  constexpr const char* kFlags = "-std=c++20 -O1 -shared -fPIC -I.";
  const std::string compiler = host_compiler();
  std::vector<std::string> parts{source, kFlags,
                                 version_of(compiler, "g++", "a rule's code is compiled with it")};
  for (const auto& [name, text] : round_headers()) parts.insert(parts.end(), {name, text});
  const fs::path path = fs::path(directory) / fmt::format("rule-host-{:016x}.so", key_of_texts(parts));
  if (fs::exists(path)) return path.string();
  make_directory(directory);
  const BuildDirectory scratch(fs::path(directory) / "rule-host");
  for (const auto& [name, text] : round_headers()) {
    fs::create_directories((scratch.path() / name).parent_path());
    write_text((scratch.path() / name).string(), text);
  }
  write_text((scratch.path() / "rounds.cpp").string(), source);
  run_logged("the C++ compiler", fmt::format("{} {} -o rounds.so rounds.cpp", compiler, kFlags),
             scratch.path(), scratch.path() / "log");
  fs::rename(scratch.path() / "rounds.so", path);
  return path.string();
}

}  // namespace cuboct::gpu
