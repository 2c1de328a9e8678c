// SPDX-License-Identifier: MIT
#include "emu/lattice/code/library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "emu/lattice/code/emit_finish.h"
#include "emu/lattice/code/sources.h"
#include "model/base/error.h"
#include "model/base/host_compiler.h"
#include "model/base/module.h"
#include "model/base/output.h"

namespace cuboct::emu {
namespace {

namespace fs = std::filesystem;

// No operation rounds but those that are written as fused: a contraction changes no bit.
constexpr const char* kFlags =
    "-std=c++17 -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC -shared -w -I.";

constexpr const char* kAvx2 = " -mavx2 -mfma";
constexpr const char* kAvx512 = " -mavx2 -mfma -mavx512f -mavx512dq -mavx512vl -mavx512bw";

// Of the machines that code is kept for.
std::vector<std::string> kept_flags() {
#if defined(__x86_64__)
  return {kAvx2, kAvx512};
#else
  return {""};
#endif
}

std::string flags_of(const std::string& simd) {
#if defined(__x86_64__)
  const bool fma = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool wide = fma && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (wide && (simd.empty() || simd == "avx512")) return kAvx512;
  if (fma && (simd.empty() || simd == "avx2")) return kAvx2;
  if (fma && simd == "128-bit") return " -mfma";
#endif
  static_cast<void>(simd);
  return {};
}

// `tools`: what the code is made with.
std::string name_of_code(const std::string& text, const std::string& tools) {
  std::vector<std::string> parts{text, tools};
  for (const auto& [name, source] : code_sources()) parts.insert(parts.end(), {name, source});
  return fmt::format("rule-{:016x}", key_of_texts(parts));
}

void compile(const std::string& text, const std::string& command, const fs::path& home,
             const std::string& name) {
  const fs::path log = home / (name + ".log");
  const BuildDirectory scratch(home / name);
  for (const auto& [file, source] : code_sources()) {
    fs::create_directories((scratch.path() / file).parent_path());
    write_text((scratch.path() / file).string(), source);
  }
  write_text((scratch.path() / "rule.cpp").string(), text);
  std::error_code none;
  fs::remove(log, none);
  run_logged("the C++ compiler", command + " -o rule.so rule.cpp", scratch.path(), log);
  fs::rename(scratch.path() / "rule.so", home / (name + ".so"));
  fs::remove(log, none);
}

// Compiled unless the directory has it.
std::string compiled(const std::string& text, const std::string& simd, const std::string& directory) {
  const std::string command = host_compiler() + " " + kFlags + flags_of(simd);
  const std::string tools =
      command + "\n" + version_of(host_compiler(), "g++", "a rule's code is compiled with it");
  make_directory(directory);
  const fs::path home = fs::absolute(directory);
  const std::string name = name_of_code(text, tools);
  if (!fs::exists(home / (name + ".so"))) compile(text, command, home, name);
  return (home / (name + ".so")).string();
}

// What keep_code made, beside the program; empty where it did not. Whatever compiler made it.
std::string kept(const std::string& text, const std::string& simd) {
  return part_path(fmt::format("{}/{}.so", kKeptCode, name_of_code(text, kFlags + flags_of(simd))));
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
    for (const graph::Graph* graph : {&round.pair, &round.finish})
      for (const FixedTable& table : graph->tables) tables_.add(table);
  const std::string path = kept(code_.text, simd);
  load(path.empty() ? compiled(code_.text, simd, directory) : path, program.rounds.size());
}

bool is_kept(const graph::FixedProgram& program, bool once, const std::string& simd) {
  return !kept(code_of(program, once).text, simd).empty();
}

std::string keep_code(const graph::FixedProgram& program, bool once, const std::string& directory) {
  std::string failed;
  const std::string text = code_of(program, once).text;
  make_directory(directory);
  for (const std::string& flags : kept_flags()) try {
      compile(text, host_compiler() + " " + kFlags + flags, fs::absolute(directory),
              name_of_code(text, kFlags + flags));
    } catch (const InputError& error) {  // a compiler that does not know them, say
      failed = error.told();
    }
  return failed;
}

void CodeLibrary::load(const std::string& path, size_t rounds) {
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw InputError(fmt::format("{} does not load: {}", path, dlerror()), "remove it");
  const auto find = [&](const std::string& name) { return dlsym(library, name.c_str()); };
  for (size_t k = 0; k < rounds; ++k) {
    meet_.emplace_back();
    for (const Ends ends : {Ends::own, Ends::other, Ends::both})
      meet_.back().push_back(reinterpret_cast<MeetCode>(find(name_of(k, ends))));
    finish_.push_back(reinterpret_cast<FinishCode>(find(name_of_finish(k))));
  }
}

MeetCode CodeLibrary::meet(size_t round, Ends ends) const { return meet_[round][static_cast<size_t>(ends)]; }

CodeNumbers CodeLibrary::numbers() const {
  return {code_.constants.data(), code_.seeds.data(),    tables_.data(),
          type_pointers_.data(),  pair_pointers_.data(), types_};
}

}  // namespace cuboct::emu
