// SPDX-License-Identifier: MIT
// A graph as C++ for vectors (lanes.h): one statement for each node. Its shape is text; its numbers are data.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/graph/graph.h"

namespace cuboct::emu {

// Numbers that the text reads, one for each use: no two rules differ in their text where they differ in
// numbers.
class CodeConstants {
 public:
  CodeConstants(std::vector<double>& values, std::vector<int64_t>& seeds) : values_(values), seeds_(seeds) {}
  // Expressions: a number in all lanes; a seed.
  std::string operator()(double value);
  std::string seed(int64_t value);

 private:
  std::vector<double>& values_;
  std::vector<int64_t>& seeds_;
};

// What stands outside of a graph.
struct Surroundings {
  std::function<std::string(const graph::Node& input)> input;
  std::string counts;       // a truth: checks of these lanes count
  size_t first_table = 0;   // of the graph's, in T
  bool both_signs = false;  // as of VectorBlock
};

// Values of node n are `v<n>`, its truths `w<n>`. A finish and a pair never stand in one scope.
class GraphText {
 public:
  // All must outlive it.
  GraphText(const graph::Graph& graph, CodeConstants& constants, const Surroundings& surroundings)
      : graph_(graph), constant_(constants), outside_(surroundings) {}

  // Of nodes in order. `late`: all lanes count that anyone looks at, so that `within` is its input.
  std::string statements(const std::vector<int>& nodes, bool late, const std::string& indent) const;
  std::string value(int node) const;
  std::string truth(int node) const;

  // A number that a sum takes: whole(product * factor), rounded once with the sum's own addition.
  struct Term {
    bool rounds = false;  // else `product` is the number, and there is no factor
    double sign = 1;      // of both
    std::string product, factor;
  };
  Term term(int node) const;
  // Nodes that terms need: of a term that rounds, not the term itself.
  std::vector<int> needed_by_terms(const std::vector<int>& terms, const std::vector<int>& others) const;

 private:
  struct Unsigned {
    int node;
    double sign;
  };
  const graph::Node& at(int node) const { return graph_.nodes[static_cast<size_t>(node)]; }
  Unsigned without_sign(int node) const;
  std::string truth_text(const graph::Node& node) const;
  std::string value_text(const graph::Node& node, bool late) const;
  std::string rounded(const std::string& value, int shift) const;
  std::string dot(const graph::Node& node) const;
  std::string lookup(const graph::Node& node) const;
  std::string check(const graph::Node& node) const;

  const graph::Graph& graph_;
  CodeConstants& constant_;
  const Surroundings& outside_;
};

}  // namespace cuboct::emu
