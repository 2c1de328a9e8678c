// SPDX-License-Identifier: MIT
#include "model/program/formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/base/spelling.h"

namespace cuboct {
namespace {

using Kind = Value::Kind;

struct Function {
  const char* name;
  size_t arguments;
  const char* use;
};
constexpr Function kFunctions[] = {
    {"sqrt", 1, "sqrt(a)"},        {"exp", 1, "exp(a)"},
    {"log", 1, "log(a)"},          {"sin", 1, "sin(a)"},
    {"cos", 1, "cos(a)"},          {"erfc", 1, "erfc(a)"},
    {"abs", 1, "abs(a)"},          {"norm", 1, "norm(v)"},
    {"dot", 2, "dot(v, w)"},       {"noise", 1, "noise(seed)"},
    {"noises", 1, "noises(seed)"}, {"min", 2, "min(a, b)"},
    {"max", 2, "max(a, b)"},       {"select", 3, "select(truth, a, b)"},
};

const char* kind_text(Kind kind) {
  return kind == Kind::number ? "a number" : kind == Kind::vector ? "a vector" : "a truth";
}

std::string told(const Dimension& dimension) {
  return dimension == Dimension{} ? "a plain number" : describe(dimension);
}

bool is_inside(const std::string& function) {
  return function == "inside" || function == "inside_i" || function == "inside_j";
}

Dimension combined(const Dimension& a, const Dimension& b, int sign) {
  Dimension of = a;
  for (size_t k = 0; k < of.exponent.size(); ++k) of.exponent[k] += sign * b.exponent[k];
  return of;
}

}  // namespace

bool is_function(const std::string& name) {
  return name == "slope" || is_inside(name) ||
         std::ranges::any_of(kFunctions, [&](const Function& f) { return name == f.name; });
}

class Compiler {
 public:
  explicit Compiler(Scope& scope) : scope_(scope), graph_(scope.graph_) {}

  Value value(const Expression& e) {
    switch (e.kind) {
      case Expression::Kind::number:
        if (!scope_.units_ && e.dimension != Dimension{})
          fail(e, fmt::format("'{}' has a unit, and units = \"reduced\"", e.text), "a plain number");
        return number(graph_.constant(e.value), e.dimension);
      case Expression::Kind::name:
        return scope_.named(e);
      case Expression::Kind::call:
        return call(e);
      case Expression::Kind::unary:
        return e.text == "-" ? negated(e) : truth(graph_.add(RealOp::inverse, truth_of(e.of[0])));
      case Expression::Kind::binary:
        return binary(e);
      case Expression::Kind::component: {
        const Value v = value(e.of[0]);
        if (v.kind != Kind::vector) fail(e, fmt::format("{} has no component", kind_text(v.kind)));
        return number(v.node[static_cast<size_t>(e.text[0] - 'x')], v.dimension);
      }
      case Expression::Kind::vector:
        return vector(e);
    }
    return {};
  }

  [[noreturn]] static void fail(const Expression& e, const std::string& message,
                                const std::string& hint = {}) {
    throw FormulaError{e.at, message, hint};
  }

 private:
  static Value number(NodeId node, const Dimension& dimension) {
    return {Kind::number, dimension, {node, 0, 0}};
  }
  static Value truth(NodeId node) { return {Kind::truth, {}, {node, 0, 0}}; }

  bool is_zero(const Value& v) const {
    return v.kind == Kind::number && graph_.at(v.node[0]).op == RealOp::constant &&
           graph_.at(v.node[0]).value == 0;
  }
  // A zero is of any dimension. Of both, the dimension.
  Dimension same(const Expression& e, const Value& a, const Value& b) const {
    if (!scope_.units_ || is_zero(b)) return a.dimension;
    if (is_zero(a)) return b.dimension;
    if (a.dimension != b.dimension)
      fail(e, fmt::format("'{}' between {} and {}", e.text, told(a.dimension), told(b.dimension)));
    return a.dimension;
  }
  Value number_of(const Expression& e) {
    const Value v = value(e);
    if (v.kind != Kind::number) fail(e, fmt::format("a number is needed here, not {}", kind_text(v.kind)));
    return v;
  }
  Value plain(const Expression& e, bool angle = false) {
    const Value v = number_of(e);
    const Dimension radian{{0, 0, 0, 1}};
    if (scope_.units_ && v.dimension != Dimension{} && !(angle && v.dimension == radian))
      fail(e, fmt::format("a plain number is needed here, not {}", told(v.dimension)),
           "divide by a constant of its unit");
    return v;
  }
  NodeId truth_of(const Expression& e) {
    const Value v = value(e);
    if (v.kind != Kind::truth)
      fail(e, fmt::format("a truth is needed here, not {}", kind_text(v.kind)),
           "a comparison, such as r < reach");
    return v.node[0];
  }

  Value each(RealOp op, const Value& a, const Value& b, const Dimension& dimension) {
    Value of{a.kind, dimension, {}};
    for (size_t k = 0; k < (a.kind == Kind::vector ? 3 : 1); ++k)
      of.node[k] = graph_.add(op, a.node[k], b.node[k]);
    return of;
  }
  Value negated(const Expression& e) {
    const Value a = value(e.of[0]);
    if (a.kind == Kind::truth) fail(e, "a truth has no sign");
    return each(RealOp::negate, a, a, a.dimension);
  }

  Value binary(const Expression& e) {
    if (e.text == "and" || e.text == "or") {
      const NodeId second = truth_of(e.of[1]), first = truth_of(e.of[0]);
      return truth(graph_.add(e.text == "and" ? RealOp::both : RealOp::either, first, second));
    }
    if (e.text == "^") return power(e);
    const Value a = value(e.of[0]), b = value(e.of[1]);
    for (const Value& v : {a, b})
      if (v.kind == Kind::truth) fail(e, fmt::format("'{}' does not take a truth", e.text));
    if (e.text == "+" || e.text == "-") {
      if (a.kind != b.kind) fail(e, fmt::format("'{}' between a number and a vector", e.text));
      return each(e.text == "+" ? RealOp::add : RealOp::subtract, a, b, same(e, a, b));
    }
    if (e.text == "*" || e.text == "/") return product(e, a, b);
    return compared(e, a, b);
  }
  Value compared(const Expression& e, const Value& a, const Value& b) {
    if (a.kind != Kind::number || b.kind != Kind::number)
      fail(e, fmt::format("'{}' compares numbers", e.text));
    same(e, a, b);
    const bool turned = e.text[0] == '>';
    const RealOp op = e.text == "==" ? RealOp::equal : e.text.size() == 2 ? RealOp::at_most : RealOp::below;
    return truth(turned ? graph_.add(op, b.node[0], a.node[0]) : graph_.add(op, a.node[0], b.node[0]));
  }
  Value product(const Expression& e, const Value& a, const Value& b) {
    const bool divides = e.text == "/";
    const Dimension dimension = combined(a.dimension, b.dimension, divides ? -1 : 1);
    const RealOp op = divides ? RealOp::divide : RealOp::multiply;
    if (a.kind == Kind::vector && b.kind == Kind::vector)
      fail(e, fmt::format("'{}' between two vectors", e.text), "dot(v, w) is their scalar product");
    if (divides && b.kind == Kind::vector) fail(e, "a vector divides nothing");
    if (a.kind == Kind::number && b.kind == Kind::number)
      return number(graph_.add(op, a.node[0], b.node[0]), dimension);
    const Value &v = a.kind == Kind::vector ? a : b, &factor = a.kind == Kind::vector ? b : a;
    return each(op, v, {Kind::vector, {}, {factor.node[0], factor.node[0], factor.node[0]}}, dimension);
  }
  Value power(const Expression& e) {
    const Value a = number_of(e.of[0]), exponent = plain(e.of[1]);
    const RealNode& node = graph_.at(exponent.node[0]);
    if (node.op != RealOp::constant) fail(e.of[1], "an exponent is a constant", "exp(b * log(a))");
    Dimension dimension = a.dimension;
    for (int& part : dimension.exponent) {
      const double raised = part * node.value;
      if (scope_.units_ && (raised != std::round(raised) || std::abs(raised) > 100))
        fail(e, fmt::format("{} to the power of {} has no unit", told(a.dimension), node.value));
      part = static_cast<int>(raised);
    }
    return number(graph_.add(RealOp::power, a.node[0], exponent.node[0]), dimension);
  }

  Value vector(const Expression& e) {
    std::array<Value, 3> parts;
    Value of{Kind::vector, {}, {}};
    bool any = false;
    for (size_t k = 0; k < 3; ++k) {
      parts[k] = number_of(e.of[k]);
      of.node[k] = parts[k].node[0];
      if (is_zero(parts[k])) continue;
      if (any && scope_.units_ && parts[k].dimension != of.dimension)
        fail(e.of[k], fmt::format("a vector of {} and {}", told(of.dimension), told(parts[k].dimension)));
      of.dimension = parts[k].dimension, any = true;
    }
    return of;
  }

  NodeId dot(const Value& v, const Value& w) {
    NodeId sum = graph_.add(RealOp::multiply, v.node[0], w.node[0]);
    for (size_t k = 1; k < 3; ++k)
      sum = graph_.add(RealOp::add, sum, graph_.add(RealOp::multiply, v.node[k], w.node[k]));
    return sum;
  }
  Value vector_of(const Expression& e) {
    const Value v = value(e);
    if (v.kind != Kind::vector) fail(e, fmt::format("a vector is needed here, not {}", kind_text(v.kind)));
    return v;
  }

  // slope(f, a), of a function f by its name.
  Value slope(const Expression& e) {
    const auto known = [&] { return e.of.size() == 2 && e.of[0].kind == Expression::Kind::name; };
    const auto at = known() ? scope_.functions_.find(e.of[0].text) : scope_.functions_.end();
    if (at == scope_.functions_.end())
      fail(known() ? e.of[0] : e, "'slope' takes the name of a table's function and its argument",
           "slope(embedding, total)");
    return tabled(e.of[1], at->second, true);
  }
  Value tabled(const Expression& argument, const TableFunction& f, bool of_slope) {
    const Value a = number_of(argument);
    if (scope_.units_ && a.dimension != f.argument && !is_zero(a))
      fail(argument, fmt::format("{} is needed here, not {}", told(f.argument), told(a.dimension)));
    return number(f.make(a.node[0], of_slope), of_slope ? combined(f.value, f.argument, -1) : f.value);
  }
  // Whether a particle stands in a region.
  Value inside(const Expression& e) {
    const auto of = scope_.inside_.find(e.text);
    if (of == scope_.inside_.end())
      fail(e, fmt::format("'{}' is not known here", e.text),
           "inside(region) is of a particle's start, inside_i and inside_j are of a bond's; a field keeps "
           "them");
    if (e.of.size() != 1 || e.of[0].kind != Expression::Kind::name)
      fail(e, fmt::format("'{}' takes the name of a region", e.text), e.text + "(top)");
    const std::vector<std::string>& known = *scope_.regions_;
    const auto at = std::ranges::find(known, e.of[0].text);
    if (at == known.end()) {
      const std::string near = did_you_mean(e.of[0].text, known);
      fail(e.of[0], fmt::format("unknown region '{}'", e.of[0].text),
           !near.empty()   ? near
           : known.empty() ? "[regions] of the scene names shapes"
                           : "known: " + list_of(known));
    }
    return truth(graph_.input(of->second, static_cast<uint32_t>(at - known.begin())));
  }
  Value call(const Expression& e) {
    if (is_inside(e.text)) return inside(e);
    if (e.text == "slope" && !scope_.functions_.empty()) return slope(e);
    if (const auto table = scope_.functions_.find(e.text); table != scope_.functions_.end()) {
      if (e.of.size() != 1)
        fail(e, fmt::format("'{}' takes 1 argument, not {}", e.text, e.of.size()), e.text + "(a)");
      return tabled(e.of[0], table->second, false);
    }
    const auto* const known =
        std::ranges::find_if(kFunctions, [&](const Function& f) { return e.text == f.name; });
    if (known == std::end(kFunctions)) {
      std::vector<std::string> names;
      for (const Function& f : kFunctions) names.emplace_back(f.name);
      for (const auto& [name, table] : scope_.functions_) names.push_back(name);
      const std::string near = did_you_mean(e.text, names);
      fail(e, fmt::format("unknown function '{}'", e.text), near.empty() ? "known: " + list_of(names) : near);
    }
    if (e.of.size() != known->arguments)
      fail(e,
           fmt::format("'{}' takes {} argument{}, not {}", e.text, known->arguments,
                       known->arguments == 1 ? "" : "s", e.of.size()),
           known->use);
    return called(e);
  }
  Value called(const Expression& e) {
    const std::string& name = e.text;
    if (name == "sqrt") return root(e);
    if (name == "noise" || name == "noises") return drawn(e);
    if (name == "abs") {
      const Value a = number_of(e.of[0]);
      return number(graph_.add(RealOp::absolute, a.node[0]), a.dimension);
    }
    if (name == "norm") {
      const Value v = vector_of(e.of[0]);
      return number(graph_.add(RealOp::square_root, dot(v, v)), v.dimension);
    }
    if (name == "dot") {
      const Value v = vector_of(e.of[0]), w = vector_of(e.of[1]);
      return number(dot(v, w), combined(v.dimension, w.dimension, 1));
    }
    if (name == "min" || name == "max") {
      const Value a = number_of(e.of[0]), b = number_of(e.of[1]);
      return number(graph_.add(name == "min" ? RealOp::least : RealOp::most, a.node[0], b.node[0]),
                    same(e, a, b));
    }
    if (name == "select") return selected(e);
    const bool angle = name == "sin" || name == "cos";
    const RealOp op = name == "exp"   ? RealOp::exponential
                      : name == "log" ? RealOp::logarithm
                      : name == "sin" ? RealOp::sine
                      : name == "cos" ? RealOp::cosine
                                      : RealOp::error_function;
    return number(graph_.add(op, plain(e.of[0], angle).node[0]), {});
  }
  Value root(const Expression& e) {
    const Value a = number_of(e.of[0]);
    Dimension half = a.dimension;
    for (int& part : half.exponent) {
      if (scope_.units_ && part % 2 != 0) fail(e, fmt::format("{} has no root", told(a.dimension)));
      part /= 2;
    }
    return number(graph_.add(RealOp::square_root, a.node[0]), half);
  }
  Value drawn(const Expression& e) {
    if (!scope_.noise_)
      fail(e, fmt::format("nothing is drawn here: '{}' is of rounds and of starts", e.text),
           "a field may hold what a finish or a start draws");
    const Value seed = plain(e.of[0]);
    const RealNode& node = graph_.at(seed.node[0]);
    if (node.op != RealOp::constant) fail(e.of[0], "a seed is a constant", "noise(1), or a parameter");
    if (!(node.value >= 0 && node.value <= kMostSeed && node.value == std::floor(node.value)))
      fail(e.of[0], fmt::format("a seed is a whole number from 0 to {}, not {}", kMostSeed, node.value));
    const uint32_t stream = kNoiseStreams * static_cast<uint32_t>(node.value);
    if (e.text == "noise") return number(graph_.input(RealSource::noise, stream), {});
    Value v{Kind::vector, {}, {}};
    for (uint32_t k = 0; k < 3; ++k) v.node[k] = graph_.input(RealSource::noise, stream + 1 + k);
    return v;
  }
  Value selected(const Expression& e) {
    const NodeId which = truth_of(e.of[0]);
    const Value a = value(e.of[1]), b = value(e.of[2]);
    if (a.kind != b.kind)
      fail(e, fmt::format("select between {} and {}", kind_text(a.kind), kind_text(b.kind)));
    Value of{a.kind, a.kind == Kind::truth ? Dimension{} : same(e, a, b), {}};
    for (size_t k = 0; k < (a.kind == Kind::vector ? 3 : 1); ++k)
      of.node[k] = graph_.add(RealOp::select, which, a.node[k], b.node[k]);
    return of;
  }

  Scope& scope_;
  RealGraph& graph_;
};

void Scope::define_number(const std::string& name, RealSource source, uint32_t index,
                          const Dimension& dimension, Value::Kind kind) {
  define(name, [=, this] { return Value{kind, dimension, {graph_.input(source, index), 0, 0}}; });
}

void Scope::define_vector(const std::string& name, RealSource source, uint32_t first,
                          const Dimension& dimension) {
  define(name, [=, this] {
    Value v{Kind::vector, dimension, {}};
    for (uint32_t k = 0; k < 3; ++k) v.node[k] = graph_.input(source, first + k);
    return v;
  });
}

void Scope::define_constant(const std::string& name, double value, const Dimension& dimension) {
  define(name, [=, this] { return Value{Kind::number, dimension, {graph_.constant(value), 0, 0}}; });
}

Value Scope::named(const Expression& name) {
  if (const auto made = made_.find(name.text); made != made_.end()) return made->second;
  if (const auto known = names_.find(name.text); known != names_.end())
    return made_[name.text] = known->second();
  if (lets_ != nullptr)
    if (const auto let = lets_->find(name.text); let != lets_->end()) {
      if (!open_.insert(name.text).second)
        Compiler::fail(name, fmt::format("'{}' is defined by itself", name.text));
      const Value value = value_of(let->second);
      open_.erase(name.text);
      return made_[name.text] = value;
    }
  std::vector<std::string> known;
  for (const auto& [word, make] : names_) known.push_back(word);
  if (lets_ != nullptr)
    for (const auto& [word, let] : *lets_) known.push_back(word);
  if (names_.count(name.text + "_i") > 0)
    Compiler::fail(name, fmt::format("'{}' of which particle?", name.text),
                   fmt::format("{}_i is of the particle itself, {}_j of the other", name.text, name.text));
  const std::string near = did_you_mean(name.text, known);
  Compiler::fail(name, fmt::format("unknown name '{}'", name.text),
                 near.empty() ? "known here: " + list_of(known) : near);
}

Value Scope::value_of(const Formula& formula) {
  try {
    return Compiler(*this).value(formula.expression);
  } catch (const FormulaError& error) {
    formula.fail(error);
    throw;
  }
}

Value Scope::value_of(const Formula& formula, const std::string& what, Value::Kind kind,
                      const Dimension& dimension) {
  Value value = value_of(formula);
  const auto refuse = [&](const std::string& wanted, const std::string& found) {
    formula.fail({formula.expression.at, fmt::format("{} must be {}, not {}", what, wanted, found), {}});
  };
  if (value.kind != kind) refuse(kind_text(kind), kind_text(value.kind));
  const RealNode& first = graph_.at(value.node[0]);
  const bool zero = kind == Kind::number && first.op == RealOp::constant && first.value == 0;
  if (units_ && value.dimension != dimension && !zero) refuse(told(dimension), told(value.dimension));
  return value;
}

}  // namespace cuboct
