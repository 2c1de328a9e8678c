// SPDX-License-Identifier: MIT
// A design as yosys elaborates it: modules with their parameters set, their ports, and who instantiates whom.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cuboct::synth {

struct Port {
  std::string name;
  bool input = false;
  uint64_t bits = 0;
};

struct Module {
  std::string base;         // its name in the library; the key of Design::modules says its parameters too
  std::vector<Port> ports;  // in the order of the source
  std::map<std::string, std::string> instances;  // name: key of the module
  uint64_t bits = 0;                             // of the outputs of its own cells, before anything is mapped
};

struct Design {
  std::string top;
  std::map<std::string, Module> modules;  // by yosys's name, e.g. "$paramod$<hash>\cuboct_fifo"
};

// Reads what yosys's write_json wrote after `hierarchy` and `proc`; blocks go by their names without
// `prefix`. Throws std::runtime_error where it is something else.
Design read_design(const std::string& file, const std::string& prefix = "");

// Those bits of a module and of all below it: what synthesis has to work on.
uint64_t bits_below(const Design& design, const std::string& module);

// The module that `unit` ("pipe", "cuboct_pipe", "fifo#2") names: its key in the design. Blocks of one source
// that are instantiated with different parameters are numbered from 1 in the order in which a walk from the
// top, by names of instances, meets them. Throws InputError: no such block (with those that there are), or
// one of several without a number.
std::string module_of(const Design& design, const std::string& unit);

// "cuboct_fifo" of "$paramod$<hash>\cuboct_fifo" and of "$paramod\cuboct_fifo\Depth=s32'...".
std::string base_name(const std::string& yosys_name);

// A harness that reaches a module of any number of ports over three pins: see docs/reference/synth.md.
// Verilog.
struct Harness {
  std::string text;
  uint64_t flip_flops = 0;
};
inline constexpr const char* kHarness = "cuboct_harness";
Harness make_harness(const std::string& unit, const std::vector<Port>& ports);

}  // namespace cuboct::synth
