// SPDX-License-Identifier: MIT
#include "tests/pipeline/pipelines.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "emu/verilated/compile.h"
#include "emu/verilated/sources.h"
#include "model/base/output.h"
#include "tests/graph/random_graph.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;
using graph::Node;

// Inputs of all pipelines, one after another, and so their outputs: `valid`, the nodes, the fault's three.
struct Lanes {
  size_t in, out;
};

std::vector<Lanes> lanes_of(const std::vector<Pipeline>& pipelines) {
  std::vector<Lanes> all{{0, 0}};
  for (const Pipeline& p : pipelines) {
    const size_t outputs = 1 + p.outputs.nodes.size() + (p.schedule.steps.fault >= 0 ? 3 : 0);
    all.push_back({all.back().in + p.schedule.steps.inputs.size(), all.back().out + outputs});
  }
  return all;
}

// A lane from a port: the port's sign extends it.
std::string lane(size_t number, const std::string& port, pipeline::Form form, std::string& connected) {
  connected += fmt::format(", .{}(y{})", port, number);
  return fmt::format(
      "  logic {0}[{1}:0] y{2};\n  logic {0}[63:0] lane{2};\n  assign lane{2} = y{2};\n"
      "  assign out_o[64*{2} +: 64] = lane{2};\n",
      form.is_signed ? "signed " : "", form.bits - 1, number);
}

std::string print_top(const std::vector<Pipeline>& pipelines) {
  const std::vector<Lanes> lanes = lanes_of(pipelines);
  std::string text = fmt::format(
      "module cuboct_pipelines (\n  input logic clk_i,\n  input logic rst_ni,\n  input logic valid_i,\n"
      "  input logic [64*{}-1:0] in_i,\n  output logic [64*{}-1:0] out_o\n);\n",
      std::max<size_t>(1, lanes.back().in), lanes.back().out);
  for (size_t k = 0; k < pipelines.size(); ++k) {
    const Pipeline& p = pipelines[k];
    const pipeline::Steps& steps = p.schedule.steps;
    std::string ports = ".clk_i, .rst_ni, .valid_i";
    size_t in = lanes[k].in, out = lanes[k].out;
    for (const pipeline::Port& port : steps.inputs)
      ports += fmt::format(", .{}(in_i[64*{} +: {}])",
                           pipeline::port_name(p.graph.nodes[static_cast<size_t>(port.node)]), in++,
                           steps.steps[static_cast<size_t>(port.step)].bits);
    const auto add = [&](const std::string& port, pipeline::Form form) {
      text += lane(out++, port, form, ports);
    };
    const auto form = [&](int step) {
      const pipeline::Step& of = steps.steps[static_cast<size_t>(step)];
      return pipeline::Form{of.bits, of.is_signed};
    };
    add("valid_o", {});
    for (size_t n = 0; n < p.outputs.nodes.size(); ++n) {
      // By the interval, as docs/reference/pipeline.md has it.
      const graph::Interval range = p.graph.nodes[static_cast<size_t>(p.outputs.nodes[n])].range;
      add(p.outputs.names[n] + "_o", pipeline::form_of(range));
    }
    if (steps.fault >= 0)
      add("fault_valid_o", {}), add("fault_code_o", form(steps.fault_code)),
          add("fault_number_o", form(steps.fault_number));
    text += fmt::format("  {} u_{} ({});\n", p.name, k, ports);
  }
  return text + "endmodule\n";
}

class Model {
 public:
  Model(const std::vector<Pipeline>& pipelines, Form form) {
    emu::Build build;
    build.top = "cuboct_pipelines", build.verilator_flags = "--cc -Wno-WIDTH", build.compiler_flags = "-O0";
    for (const auto& [name, text] : emu::shim_sources())
      if (name.ends_with(".h")) build.sources.emplace_back(name, text);
    build.sources.emplace_back("pipeline_shim.cpp",
                               read_text(CUBOCT_SOURCE_DIR "/tests/pipeline/pipeline_shim.cpp"));
    build.emit = [&](const std::string& dir) {
      fs::create_directories(fs::path(dir) / "rtl");
      std::string list;
      const auto add = [&](const std::string& name, const std::string& text) {
        write_text((fs::path(dir) / "rtl" / (name + ".sv")).string(), text);
        list += "rtl/" + name + ".sv\n";
      };
      add("cuboct_mult", read_text(CUBOCT_SOURCE_DIR "/rtl/lib/arithmetic/cuboct_mult.sv"));
      add("cuboct_leading_zeros", read_text(CUBOCT_SOURCE_DIR "/rtl/pipeline/cuboct_leading_zeros.sv"));
      for (const Pipeline& p : pipelines)
        for (const pipeline::Module& module :
             pipeline::print_unchecked(p.name, p.graph, p.outputs, p.schedule))
          add(module.name, module.text);
      add("cuboct_pipelines", print_top(pipelines));
      if (form == Form::gates) list = gates(dir, list);
      write_text((fs::path(dir) / "files.f").string(), list);
    };
    library_ = dlopen(emu::compile(build, CUBOCT_TEST_CACHE).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) throw std::runtime_error(dlerror());
    find("pipelines_create", create_), find("pipelines_destroy", destroy_), find("pipelines_clock", clock_);
    model_ = create_();
  }
  ~Model() {
    destroy_(model_);
    dlclose(library_);
  }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  void clock(bool reset_n, bool valid, const std::vector<uint64_t>& in, std::vector<uint64_t>& out) {
    clock_(model_, reset_n, valid, in.data(), out.data());
  }

 private:
  // The list of the netlist's one file. What it was made of goes.
  static std::string gates(const std::string& dir, std::string files) {
    std::ranges::replace(files, '\n', ' ');
    const std::string command = fmt::format(
        "cd '{}' && yosys -q -p 'read_verilog -sv {}; synth -flatten -top cuboct_pipelines; "
        "write_verilog -noattr gates.v' && rm -r rtl && mkdir rtl && mv gates.v rtl",
        dir, files);
    if (std::system(command.c_str()) != 0) throw std::runtime_error("yosys failed");
    return "rtl/gates.v\n";
  }
  template <class F>
  void find(const char* name, F& function) {
    function = reinterpret_cast<F>(dlsym(library_, name));
    if (function == nullptr) throw std::runtime_error(name);
  }
  void* library_ = nullptr;
  void* model_ = nullptr;
  void* (*create_)() = nullptr;
  void (*destroy_)(void*) = nullptr;
  void (*clock_)(void*, bool, bool, const uint64_t*, uint64_t*) = nullptr;
};

// Patterns that fit a range, or its ends, or what random_value gives.
int64_t stimulus(Dice& dice, graph::Interval range) {
  constexpr uint64_t kFives = 0x5555555555555555;
  const int keep = dice.draw(1, 63);
  const auto cut = [&](uint64_t v) { return static_cast<int64_t>(v) >> keep; };
  const int64_t patterns[] = {
      0, -1, 1, cut(kFives), cut(~kFives), range.low, range.high, int64_t{1} << (keep - 1)};
  const int kind = dice.draw(0, 15);
  return kind < 8 ? std::clamp(patterns[kind], range.low, range.high) : random_value(dice, range);
}

// One pipeline's sets of inputs, and what the interpreter makes of them.
class Expected {
 public:
  Expected(const Pipeline& p, size_t sets, Dice& dice)
      : p_(p), granted_(taken_for_granted(p.graph)), block_(p.graph, sets) {
    for (const pipeline::Port& port : p.schedule.steps.inputs) {
      const graph::Interval range = p.graph.nodes[static_cast<size_t>(port.node)].range;
      // What is between two particles is short now and then, so that pairs count.
      const bool apart = p.graph.nodes[static_cast<size_t>(port.node)].source == graph::Source::apart;
      int64_t* values = block_.values(port.node);
      for (size_t k = 0; k < sets; ++k) {
        values[k] = stimulus(dice, range);
        if (apart && k % 4 != 0) values[k] /= 1 + static_cast<int64_t>(k % 5);
      }
    }
    std::vector<int> nodes = p.outputs.nodes;
    if (p.when >= 0) nodes.push_back(p.when);
    block_.run(graph::needed_by(p.graph, nodes), sets);
    for (const int n : graph::needed_by(p.graph, p.outputs.nodes)) {
      const Node& node = p.graph.nodes[static_cast<size_t>(n)];
      fault_granted_ = fault_granted_ || (node.op == graph::Op::check && granted_[static_cast<size_t>(n)]);
    }
    for (const graph::LaneFault& fault : block_.faults()) faults_[static_cast<size_t>(fault.lane)] = fault;
  }

  void drive(size_t set, uint64_t* in) {
    for (const pipeline::Port& port : p_.schedule.steps.inputs)
      *in++ = static_cast<uint64_t>(block_.values(port.node)[set]);
  }

  // `out`: from `valid` on.
  std::string difference(size_t set, const uint64_t* out, Compared& compared) {
    const bool counts = p_.when < 0 || block_.values(p_.when)[set] != 0;
    ++compared.sets, compared.counting += counts;
    for (size_t n = 0; n < p_.outputs.nodes.size(); ++n) {
      const int node = p_.outputs.nodes[n];
      if (!counts && granted_[static_cast<size_t>(node)]) continue;
      const auto got = static_cast<int64_t>(out[1 + n]);
      const int64_t right = block_.values(node)[set];
      if (got != right)
        return fmt::format("{}: {} ({}) of set {} is {} and not {}", p_.name, p_.outputs.names[n],
                           label(p_.graph, node), set, got, right);
      ++compared.values, ++compared.by_op[p_.graph.nodes[static_cast<size_t>(node)].op];
    }
    if (p_.schedule.steps.fault < 0 || (!counts && fault_granted_)) return {};
    const uint64_t* fault = out + 1 + p_.outputs.nodes.size();
    const auto own = faults_.find(set);
    if ((fault[0] != 0) != (own != faults_.end()))
      return fmt::format("{}: fault_valid_o of set {} is {}", p_.name, set, fault[0]);
    if (own == faults_.end()) return {};
    ++compared.faults;
    if (fault[1] != static_cast<uint64_t>(own->second.fault) ||
        static_cast<int64_t>(fault[2]) != own->second.number)
      return fmt::format("{}: the fault of set {} is {} with {}, and not {} with {}", p_.name, set, fault[1],
                         static_cast<int64_t>(fault[2]), static_cast<int>(own->second.fault),
                         own->second.number);
    return {};
  }

 private:
  const Pipeline& p_;
  std::vector<bool> granted_;
  graph::Block<int64_t> block_;
  bool fault_granted_ = false;
  std::map<size_t, graph::LaneFault> faults_;
};

std::string sanitised(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

}  // namespace

std::vector<bool> taken_for_granted(const graph::Graph& graph) {
  std::vector<bool> all;
  for (const Node& node : graph.nodes)
    all.push_back(node.op == graph::Op::within ||
                  std::ranges::any_of(node.inputs, [&](int k) { return all[static_cast<size_t>(k)]; }));
  return all;
}

Pipeline all_of(const std::string& name, graph::Graph graph, int when) {
  Pipeline p{.name = name, .graph = std::move(graph), .outputs = {}, .when = when, .schedule = {}};
  for (int n = 0; n < static_cast<int>(p.graph.nodes.size()); ++n)
    if (p.graph.nodes[static_cast<size_t>(n)].op != graph::Op::constant)
      p.outputs.nodes.push_back(n), p.outputs.names.push_back(fmt::format("y{}", n));
  p.schedule = pipeline::schedule_of(p.graph, p.outputs.nodes);
  return p;
}

Pipeline pair_of(const std::string& name, const graph::Round& round) {
  Pipeline p{.name = sanitised("pair_" + name),
             .graph = round.pair,
             .outputs = pipeline::pair_pipeline(round),
             .when = round.when,
             .schedule = {}};
  p.schedule = pipeline::schedule_of(p.graph, p.outputs.nodes);
  return p;
}

Pipeline finish_of(const std::string& name, const graph::FixedProgram& program, const graph::Round& round) {
  Pipeline p{.name = sanitised("finish_" + name),
             .graph = round.finish,
             .outputs = pipeline::finish_pipeline(program, round),
             .when = -1,
             .schedule = {}};
  p.schedule = pipeline::schedule_of(p.graph, p.outputs.nodes);
  return p;
}

Compared compare(const std::vector<Pipeline>& pipelines, size_t sets, uint64_t seed,
                 std::vector<Difference>& differences, Form form) {
  Model model(pipelines, form);
  Dice dice(seed);
  const std::vector<Lanes> lanes = lanes_of(pipelines);
  std::vector<Expected> expected;
  expected.reserve(pipelines.size());
  for (const Pipeline& p : pipelines) expected.emplace_back(p, sets, dice);
  differences.assign(pipelines.size(), {});
  std::vector<uint64_t> in(std::max<size_t>(1, lanes.back().in)), out(lanes.back().out);
  Compared compared;
  constexpr size_t kNone = ~size_t{0};
  std::vector<size_t> driven;  // by cycle: the set, if any
  int longest = 0;
  for (const Pipeline& p : pipelines) longest = std::max(longest, p.schedule.cycles);
  for (int cycle = 0; cycle < 3; ++cycle) model.clock(false, true, in, out);
  for (size_t next = 0; next < sets || driven.size() < 2 * sets + static_cast<size_t>(longest);) {
    // Mostly back to back; in between any inputs that do not count.
    const bool valid = next < sets && !dice.chance(10);
    const size_t set = valid ? next : kNone;
    for (size_t k = 0; k < pipelines.size(); ++k)
      expected[k].drive(valid ? next : static_cast<size_t>(dice.draw(0, static_cast<int>(sets) - 1)),
                        in.data() + lanes[k].in);
    next += valid;
    model.clock(true, valid, in, out);
    driven.push_back(set);
    for (size_t k = 0; k < pipelines.size(); ++k) {
      const uint64_t* own = out.data() + lanes[k].out;
      const auto ago = static_cast<size_t>(pipelines[k].schedule.cycles);
      const size_t here = driven.size() > ago ? driven[driven.size() - 1 - ago] : kNone;
      std::string& told = differences[k].what;
      if (!told.empty()) continue;
      if ((own[0] != 0) != (here != kNone))
        told = fmt::format("{}: valid_o is {} in cycle {}", pipelines[k].name, own[0], driven.size() - 1);
      else if (here != kNone)
        told = expected[k].difference(here, own, compared);
    }
  }
  return compared;
}

}  // namespace cuboct::test
