// SPDX-License-Identifier: MIT
// One function for each format that cuboct reads. It takes any bytes; what it may throw says that they are
// bad input. Everything else is a fault: a crash, a sanitizer's report, another exception, seconds of work,
// much memory.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace cuboct::fuzz {

using Bytes = std::span<const uint8_t>;

struct Target {
  std::string_view name;
  void (*take)(Bytes input);
};

// Of what the model reads; of what machines do; of what studies and commands do.
std::span<const Target> model_targets();
std::span<const Target> machine_targets();
std::span<const Target> study_targets();

// Calls `work`; InputError and RunError are how cuboct refuses.
void refusing(const std::function<void()>& work);
// The same where a std::runtime_error, too, is told in a line and ends the command with 1: of boards and of
// other programs' files. Types derived from it are faults, but for those two.
void failing(const std::function<void()>& work);

std::string text_of(Bytes input);
// The bytes as a file of this name in a directory of this process; its path.
std::string file_of(Bytes input, const std::string& name);
// An absolute path below the sources.
std::string in_tree(const std::string& path);

void take_scene(Bytes input);
void take_plan(Bytes input);
void take_arch(Bytes input);
void take_rule(Bytes input);
void take_study(Bytes input);
void take_technology(Bytes input);
void take_liberty(Bytes input);
void take_mesh(Bytes input);
void take_potential(Bytes input);
void take_particles(Bytes input);
void take_trace(Bytes input);
void take_hand_over(Bytes input);
void take_checkpoint(Bytes input);
void take_board(Bytes input);
void take_json(Bytes input);
void take_results(Bytes input);
void take_words(Bytes input);

}  // namespace cuboct::fuzz
