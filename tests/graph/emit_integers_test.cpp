// SPDX-License-Identifier: MIT
// Graphs as C++, compiled by the host's compiler: every node's value, and whether a check fails, beside
// golden's interpreter.
#include "model/graph/emit_integers.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "model/base/output.h"
#include "tests/graph/random_graph.h"

namespace cuboct::test {
namespace {

using graph::Graph;
using graph::Node;
using graph::Op;

constexpr size_t kLanes = 200;

std::vector<int> all_of(const Graph& graph) {
  std::vector<int> all;
  for (int n = 0; n < static_cast<int>(graph.nodes.size()); ++n) all.push_back(n);
  return all;
}

// Inputs come by node, and all nodes' values go out.
std::string function_of(const Graph& graph, int number) {
  std::string tables;
  for (size_t t = 0; t < graph.tables.size(); ++t) {
    const FixedTable& table = graph.tables[t];
    tables += fmt::format("static const gpu::TableEntry entries{}[] = {{\n", t);
    for (size_t k = 0; k < table.c0.size(); ++k)
      tables +=
          fmt::format("{{{}, {}, {}, 0}},\n", table.c0[k], table.c1[k], table.degree == 2 ? table.c2[k] : 0);
    tables += "};\n";
  }
  int next = 0;
  const graph::Outside outside{
      [&](const Node&) {
        while (graph.nodes[static_cast<size_t>(next)].op != Op::input) ++next;
        return fmt::format("in[{}]", next++);
      },
      [&](const Node& node, const std::string& argument, const std::string& law) {
        const FixedTable& t = graph.tables[static_cast<size_t>(node.table)];
        return fmt::format("gpu::EntryTable<{}, {}, {}, {}, {}, {}, {}>::value<{}>(entries{}, {}, {})",
                           static_cast<int>(t.shape), t.degree, t.difference_frac, t.index_bits, t.bin_bits,
                           t.first_octave, t.fraction_bits, number % 2 == 0, node.table, argument, law);
      }};
  std::string text =
      fmt::format("extern \"C\" bool graph_{}(const int64_t* in, int64_t* out) {{\n{}bool fits = true;\n{}",
                  number, tables, graph::statements(graph, all_of(graph), outside));
  for (const int n : all_of(graph)) text += fmt::format("out[{}] = {};\n", n, graph::value_text(graph, n));
  return text + "return fits;\n}\n";
}

// The host's library of these functions.
class Library {
 public:
  explicit Library(const std::string& source) {
    const auto dir = std::filesystem::path(testing::TempDir()) / "emitted_graphs";
    std::filesystem::create_directories(dir);
    write_text((dir / "graphs.cpp").string(),
               "#include \"emu/gpu/rounds/rounds_table.h\"\n#include \"model/graph/integer_ops.h\"\n"
               "namespace cuboct {\n" +
                   source + "}\n");
    const std::string command =
        fmt::format("cd {} && c++ -std=c++20 -O1 -shared -fPIC -I {} -o graphs.so graphs.cpp", dir.string(),
                    CUBOCT_SOURCE_DIR);
    if (std::system(command.c_str()) == 0) library_ = dlopen((dir / "graphs.so").c_str(), RTLD_NOW);
  }
  ~Library() {
    if (library_ != nullptr) dlclose(library_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  using Function = bool (*)(const int64_t*, int64_t*);
  Function function(int number) const {
    if (library_ == nullptr) return nullptr;
    return reinterpret_cast<Function>(dlsym(library_, fmt::format("graph_{}", number).c_str()));
  }

 private:
  void* library_ = nullptr;
};

void compare_graphs(uint64_t first_seed, int count) {
  std::vector<Graph> graphs;
  std::string source;
  for (int k = 0; k < count; ++k) {
    graphs.push_back(random_graph(first_seed + static_cast<uint64_t>(k), 60).graph);
    source += function_of(graphs.back(), k);
  }
  const Library library(source);
  uint64_t values = 0, faults = 0, narrow = 0;
  std::map<Op, int> seen;
  for (int k = 0; k < count; ++k) {
    SCOPED_TRACE(fmt::format("graph {}", k));
    const Graph& graph = graphs[static_cast<size_t>(k)];
    const auto function = library.function(k);
    ASSERT_NE(function, nullptr);
    graph::Block<int64_t> block(graph, kLanes);
    run_all(block, graph, static_cast<uint64_t>(k) + 7, kLanes);
    for (const Node& node : graph.nodes)
      ++seen[node.op], narrow += std::string(graph::type_text(node)) == "int32_t";
    for (size_t lane = 0; lane < kLanes; ++lane) {
      std::vector<int64_t> in(graph.nodes.size()), out(graph.nodes.size());
      for (const int n : all_of(graph)) in[static_cast<size_t>(n)] = block.values(n)[lane];
      const bool fits = function(in.data(), out.data());
      for (const int n : all_of(graph))
        ASSERT_EQ(out[static_cast<size_t>(n)], block.values(n)[lane])
            << label(graph, n) << " of lane " << lane;
      const bool sound = std::ranges::none_of(
          block.faults(), [&](const graph::LaneFault& f) { return f.lane == static_cast<int>(lane); });
      ASSERT_EQ(fits, sound) << "lane " << lane;
      values += in.size(), faults += !sound;
    }
  }
  for (int op = 0; op <= static_cast<int>(Op::noise); ++op)
    EXPECT_GT(seen[static_cast<Op>(op)], 2) << graph::to_string(static_cast<Op>(op));
  EXPECT_GT(values, 50000u);
  EXPECT_GT(faults, 100u);
  EXPECT_GT(narrow, 500u);
}

TEST(EmitIntegers, RandomGraphsHaveGoldensValues) { compare_graphs(1, 24); }

TEST(EmitIntegersMore, RandomGraphsHaveGoldensValues) { compare_graphs(1000, 400); }

// What 32 bits hold is computed in them; one more bit is not.
TEST(EmitIntegers, WidthsFollowIntervals) {
  const auto text_of_product = [](int64_t most, int shift) {
    graph::Builder b;
    const int x = b.input(graph::Source::own_field, 0, 0, {-most, most});
    const int y = b.input(graph::Source::own_field, 1, 0, {-most, most});
    b.mul(x, y, shift);
    const Graph graph = b.take();
    return graph::statements(graph, {2}, {});
  };
  EXPECT_EQ(text_of_product(46340, 0), "const int32_t n2 = static_cast<int32_t>(n0 * n1);\n");
  EXPECT_EQ(text_of_product(46341, 0), "const int64_t n2 = static_cast<int64_t>(product(n0, n1));\n");
  EXPECT_EQ(text_of_product(46340, 4),
            "const int32_t n2 = static_cast<int32_t>(graph::round_odd_32(n0 * n1, 4));\n");
  EXPECT_EQ(text_of_product(46341, 4),
            "const int32_t n2 = static_cast<int32_t>(round_odd(product(n0, n1), 4));\n");
  EXPECT_EQ(text_of_product(int64_t{1} << 31, 40),
            "const int32_t n2 = static_cast<int32_t>(round_odd(n0 * n1, 40));\n");
}

}  // namespace
}  // namespace cuboct::test
