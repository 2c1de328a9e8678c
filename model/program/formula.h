// SPDX-License-Identifier: MIT
// Formulas into nodes of a graph: names get their meaning, units are checked.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "model/program/expression.h"
#include "model/program/real_graph.h"

namespace cuboct {

// A formula, and who tells that it is wrong: `fail` throws InputError with the place in its file.
struct Formula {
  std::string text;
  Expression expression;
  std::function<void(const FormulaError&)> fail;
};

// What a formula or a name stands for.
struct Value {
  enum class Kind : unsigned char { number, vector, truth };
  Kind kind = Kind::number;
  Dimension dimension;
  std::array<NodeId, 3> node{};  // one, or x, y, z
};

// A function of one number that formulas call by its name: f(a), and slope(f, a).
struct TableFunction {
  Dimension argument, value;
  std::function<NodeId(NodeId at, bool of_slope)> make;
};

// A seed of noise has four streams: of a number, and of x, y and z of a vector.
inline constexpr uint32_t kNoiseStreams = 4;
inline constexpr uint32_t kMostSeed = (uint32_t{1} << 30) - 1;

// Whether every formula has a function of this name.
bool is_function(const std::string& name);

// The names that a formula may use. A name's nodes are made when it is first used.
class Scope {
 public:
  // `units`: whether dimensions are checked; else all are plain numbers.
  Scope(RealGraph& graph, bool units) : graph_(graph), units_(units) {}

  RealGraph& graph() { return graph_; }
  // From now on the name means this.
  void define(const std::string& name, std::function<Value()> make) {
    names_[name] = std::move(make);
    made_.clear();
  }
  // Formulas by name, which mean what they mean where they are used. They must outlive the scope.
  void define_lets(const std::map<std::string, Formula>& lets) { lets_ = &lets; }
  // Inputs of one, or of x, y, z; `first` is the index of the first.
  void define_number(const std::string& name, RealSource source, uint32_t index, const Dimension& dimension,
                     Value::Kind kind = Value::Kind::number);
  void define_vector(const std::string& name, RealSource source, uint32_t first, const Dimension& dimension);
  void define_constant(const std::string& name, double value, const Dimension& dimension);

  void define_function(const std::string& name, TableFunction function) {
    functions_[name] = std::move(function);
  }
  // A function of a region's name: a truth. `regions` must outlive the scope.
  void define_inside(const std::string& function, RealSource source,
                     const std::vector<std::string>& regions) {
    inside_[function] = source;
    regions_ = &regions;
  }
  void allow_noise() { noise_ = true; }

  // Throws what the formula's `fail` throws.
  Value value_of(const Formula& formula);
  // The same of a known kind and dimension; `what` completes "... must be": "sum 'force'".
  Value value_of(const Formula& formula, const std::string& what, Value::Kind kind,
                 const Dimension& dimension);

 private:
  friend class Compiler;
  Value named(const Expression& name);

  RealGraph& graph_;
  bool units_, noise_ = false;
  std::map<std::string, std::function<Value()>> names_;
  std::map<std::string, TableFunction> functions_;
  std::map<std::string, RealSource> inside_;
  const std::vector<std::string>* regions_ = nullptr;
  const std::map<std::string, Formula>* lets_ = nullptr;
  std::map<std::string, Value> made_;
  std::set<std::string> open_;  // lets that are being compiled
};

}  // namespace cuboct
