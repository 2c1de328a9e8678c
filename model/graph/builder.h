// SPDX-License-Identifier: MIT
// Makes graphs: each function adds the node of one operation of graph.h, or returns the earlier node that has
// the same value, and proves its interval. An interval wider than 63 bits is an InputError that names the
// operation, its inputs and both ends. Inputs that an operation does not take (a truth that is none, an
// argument beyond a table) are std::logic_error.
//
//   Builder b;
//   const int d = b.named(b.round(b.input(Source::apart, 0, 0, {-2047, 2047}, 10), 2), "d");
//   const int r2 = b.mul(d, d);
//   b.counts(b.lt(r2, b.constant(5000)));
//   const int force = b.neg(b.mul(b.lookup(table, b.within(r2)), b.within(d), 12));
//   Graph graph = b.take();   // force and b.when() remain its nodes' indices
#pragma once

#include <string>
#include <vector>

#include "model/graph/graph.h"
#include "model/graph/interval.h"

namespace cuboct::graph {

class Builder {
 public:
  int constant(int64_t number, int frac = 0);
  // `range` must be right: everything is proven from it. A range of one number makes a constant.
  int input(Source source, int index, int axis, Interval range, int frac = 0, bool symmetric = false,
            bool opposite = false);

  int add(int a, int b);
  int sub(int a, int b);
  int neg(int a);
  int shl(int a, int shift);
  int round(int a, int shift);
  int floor(int a, int shift);
  int mul(int a, int b, int shift = 0);
  int mac(int a, int b, int c, int shift = 0);
  int dot(const std::vector<int>& a, const std::vector<int>& b, int shift = 0);
  int table(const FixedTable& table);  // its number, for lookups; equal tables are one
  int lookup(int table, int argument, int law = -1);
  int lt(int a, int b);
  int le(int a, int b);
  int eq(int a, int b);
  int both(int a, int b);
  int either(int a, int b);
  int negate(int a);
  int select(int truth, int a, int b);
  int min(int a, int b);
  int max(int a, int b);
  int abs(int a);
  int clamp(int a, Interval range);
  int msb(int a);
  int align(int a, int place, int step = 1);
  int shift(int a, int by);
  // Without `when` the check always holds. A value that is proven to fit is returned as it is.
  int check(int a, int width, Fault fault, int when = -1);
  int noise(int a, int b, int c, int64_t seed, int width);

  // The pair counts where this truth holds; an engine uses what follows from the graph for such pairs alone.
  void counts(int when);
  int when() const { return when_; }
  // `a` in the interval that it has where the pair counts: ends of comparisons in `when`; components of a
  // vector whose square is compared; products with such a vector, by Cauchy and Schwarz.
  int within(int a);

  int named(int node, const std::string& name);  // returns the node
  Interval range(int node) const { return graph_.nodes[static_cast<size_t>(node)].range; }
  int frac(int node) const { return graph_.nodes[static_cast<size_t>(node)].frac; }
  const Graph& graph() const { return graph_; }
  Graph take() { return std::move(graph_); }

 private:
  struct Fact {
    int node;
    Interval range;
  };
  struct Vector {
    std::vector<int> parts;
    int64_t square;  // |v|^2 is at most this
  };
  const Node& at(int node) const { return graph_.nodes[static_cast<size_t>(node)]; }
  Node made(Op op, std::vector<int> inputs, int shift = 0, int width = 0) const;
  int added(Node node);
  int same_as_earlier(const Node& node) const;
  std::vector<Interval> ranges(const Node& node) const;
  void refuse(const Node& node, WideInterval range, const char* room) const;
  void check_product(const Node& node) const;
  void need_truth(int node) const;
  bool is(int node, int64_t number) const { return range(node) == Interval{number, number}; }
  int chosen(Op op, int a, int b);

  void learn(int truth);
  void learn_below(int a, int b, int64_t gap);
  void learn(int node, Interval range);
  void learn_square(int node, int64_t square);
  int bare(int node) const;
  std::vector<int> beside(const Node& dot, const Vector& vector) const;
  Interval by_cauchy(int node) const;

  Graph graph_;
  int when_ = -1;
  std::vector<Fact> facts_;
  std::vector<Vector> vectors_;
};

}  // namespace cuboct::graph
