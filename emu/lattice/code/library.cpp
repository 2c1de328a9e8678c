// SPDX-License-Identifier: MIT
#include "emu/lattice/code/library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "emu/lattice/code/sources.h"
#include "emu/lattice/kernel_rule.h"
#include "model/base/error.h"
#include "model/base/host_compiler.h"
#include "model/base/output.h"
#include "model/base/text.h"

namespace cuboct::emu {
namespace {

namespace fs = std::filesystem;

// No operation rounds but those that are written as fused: a contraction changes no bit.
constexpr const char* kFlags =
    "-std=c++17 -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC -shared -w -I.";

std::string flags_of(const std::string& simd) {
#if defined(__x86_64__)
  const bool fma = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool wide = fma && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (wide && (simd.empty() || simd == "avx512"))
    return " -mavx2 -mfma -mavx512f -mavx512dq -mavx512vl -mavx512bw";
  if (fma && (simd.empty() || simd == "avx2")) return " -mavx2 -mfma";
  if (fma && simd == "128-bit") return " -mfma";
#endif
  static_cast<void>(simd);
  return {};
}

uint64_t key_of(const std::string& text, const std::string& tools) {
  std::vector<std::string> parts{text, tools};
  for (const auto& [name, source] : code_sources()) parts.insert(parts.end(), {name, source});
  return key_of_texts(parts);
}

std::string compile(const std::string& text, const std::string& simd, const std::string& directory) {
  const std::string compiler = host_compiler(), flags = kFlags + flags_of(simd);
  const std::string tools = fmt::format("{}\n{}\n{}", compiler, flags,
                                        version_of(compiler, "g++", "a rule's code is compiled with it"));
  make_directory(directory);
  const fs::path home = fs::absolute(directory);
  const std::string name = fmt::format("rule-{:016x}", key_of(text, tools));
  const fs::path result = home / (name + ".so"), log = home / (name + ".log");
  if (fs::exists(result)) return result.string();
  const BuildDirectory scratch(home / name);
  for (const auto& [file, source] : code_sources()) {
    fs::create_directories((scratch.path() / file).parent_path());
    write_text((scratch.path() / file).string(), source);
  }
  write_text((scratch.path() / "rule.cpp").string(), text);
  std::error_code none;
  fs::remove(log, none);
  run_logged("the C++ compiler", fmt::format("{} {} -o rule.so rule.cpp", compiler, flags), scratch.path(),
             log);
  fs::rename(scratch.path() / "rule.so", result);
  fs::remove(log, none);
  return result.string();
}

std::vector<std::vector<double>> reals(const std::vector<graph::Constants>& constants) {
  std::vector<std::vector<double>> values;
  for (const graph::Constants& one : constants) values.emplace_back(one.values.begin(), one.values.end());
  return values;
}

std::vector<const double*> pointers(const std::vector<std::vector<double>>& values) {
  std::vector<const double*> to;
  for (const auto& one : values) to.push_back(one.data());
  return to;
}

}  // namespace

CodeLibrary::CodeLibrary(const graph::FixedProgram& program, bool once, const std::string& simd,
                         const std::string& directory)
    : code_(code_of(program, once)),
      types_(program.types),
      type_constants_(reals(program.type_constants)),
      pair_constants_(reals(program.pair_constants)),
      type_pointers_(pointers(type_constants_)),
      pair_pointers_(pointers(pair_constants_)) {
  for (const graph::Round& round : program.rounds)
    for (const FixedTable& table : round.pair.tables) vector_tables_.push_back(vector_table(table));
  size_t at = 0;
  for (const graph::Round& round : program.rounds)
    for (const FixedTable& table : round.pair.tables) {
      const VectorTable& v = vector_tables_[at++];
      tables_.push_back({v.words.data(), v.c2.data(), v.index_shift, (int64_t{1} << v.index_bits) - 1,
                         v.index_bits, v.index_base, static_cast<int64_t>(v.t_mask), v.t_unit,
                         rounding_factor(table.fraction_bits)});
    }
  load(compile(code_.text, simd, directory), program.rounds.size());
}

void CodeLibrary::load(const std::string& path, size_t rounds) {
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw InputError(fmt::format("{} does not load: {}", path, dlerror()), "remove it");
  for (size_t k = 0; k < rounds; ++k) {
    meet_.emplace_back();
    for (const Ends ends : {Ends::own, Ends::other, Ends::both})
      meet_.back().push_back(reinterpret_cast<MeetCode>(dlsym(library, name_of(k, ends).c_str())));
  }
}

MeetCode CodeLibrary::meet(size_t round, Ends ends) const { return meet_[round][static_cast<size_t>(ends)]; }

void CodeLibrary::give_numbers(Job& job) const {
  job.constants = code_.constants.data();
  job.tables = tables_.data();
  job.type_constants = type_pointers_.data();
  job.pair_constants = pair_pointers_.data();
  job.types = types_;
}

}  // namespace cuboct::emu
