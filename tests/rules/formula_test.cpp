// SPDX-License-Identifier: MIT
// Formulas of a rule's text: what they mean, and what is told of one that means nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "model/program/formula.h"
#include "model/program/real_block.h"

namespace cuboct {
namespace {

// With d = (3, 4, 12) m, T_i = 300 K, T_j = 290 K, k = 2 N/m.
struct Compiled {
  RealGraph graph;
  Value value;
  std::vector<double> numbers;
};

Compiled compiled(const std::string& text, const std::map<std::string, Formula>& lets = {}) {
  Compiled out;
  Scope scope(out.graph, true);
  scope.define_vector("d", RealSource::difference, 0, quantity::length.dimension);
  scope.define_number("T_i", RealSource::own_field, 0, quantity::temperature.dimension);
  scope.define_number("T_j", RealSource::other_field, 0, quantity::temperature.dimension);
  scope.define_constant("k", 2, quantity::stiffness.dimension);
  scope.define_lets(lets);
  out.value = scope.value_of({text, parse_expression(text), [](const FormulaError& error) { throw error; }});
  RealBlock block(out.graph);
  block.run(2, [](const RealInput& input, double* to) {
    const double d[] = {3, 4, 12};
    to[0] = to[1] = input.source == RealSource::difference  ? d[input.index]
                    : input.source == RealSource::own_field ? 300
                                                            : 290;
  });
  const int numbers = out.value.kind == Value::Kind::vector ? 3 : 1;
  for (int n = 0; n < numbers; ++n) {
    const double* lanes = block.of(out.value.node[static_cast<size_t>(n)]);
    EXPECT_EQ(lanes[0], lanes[1]) << text;
    out.numbers.push_back(lanes[0]);
  }
  return out;
}

double number_of(const std::string& text) {
  const Compiled of = compiled(text);
  EXPECT_EQ(of.numbers.size(), 1u) << text;
  return of.numbers[0];
}

TEST(Formula, MeansWhatItSays) {
  EXPECT_EQ(number_of("1 + 2 * 3"), 7);
  EXPECT_EQ(number_of("2 - 3 - 4"), -5);
  EXPECT_EQ(number_of("8 / 4 / 2"), 1);
  EXPECT_EQ(number_of("-2 ^ 2"), -4);
  EXPECT_EQ(number_of("2 ^ -1"), 0.5);
  EXPECT_EQ(number_of("2 ^ 3 ^ 2"), 512);
  EXPECT_EQ(number_of("norm(d)"), 13);
  EXPECT_EQ(number_of("dot(d, d) / (1 m^2)"), 169);
  EXPECT_EQ(number_of("d.y"), 4);
  EXPECT_EQ(number_of("(T_j - T_i) / 1 K"), -10);
  EXPECT_EQ(number_of("5 mm"), 0.005);
  EXPECT_EQ(number_of("3 kN/m^2"), 3000);
  EXPECT_EQ(number_of("select(T_i > T_j and not T_i == T_j, 1, 2)"), 1);
  EXPECT_EQ(number_of("min(3, max(1, 2)) + abs(-4)"), 6);
  EXPECT_EQ(number_of("sqrt(dot(d, d))"), 13);
  EXPECT_DOUBLE_EQ(number_of("log(exp(1.5)) + sin(0) + cos(0)"), 2.5);
  EXPECT_DOUBLE_EQ(number_of("erfc(1)"), 0.15729920705028513);  // Abramowitz and Stegun, table 7.1
  EXPECT_EQ(compiled("k * d").numbers, (std::vector<double>{6, 8, 24}));
  EXPECT_EQ(compiled("[1, 0, 2] - [0, 1, 0]").numbers, (std::vector<double>{1, -1, 2}));
  EXPECT_EQ(compiled("k * d").value.dimension, quantity::force.dimension);
  EXPECT_EQ(compiled("sqrt(k / (2 kg))").value.dimension, (Dimension{{0, 0, -1, 0}}));
}

TEST(Formula, IsOneGraphWithoutRepetition) {
  const Compiled once = compiled("norm(d)"), twice = compiled("norm(d) * norm(d) + norm(d)^2");
  EXPECT_EQ(twice.graph.nodes().size(), once.graph.nodes().size() + 2 + 1);  // product, sum; the exponent 2
}

struct WrongFormula {
  const char* text;
  size_t at;
  const char* message;
};

TEST(Formula, SaysWhereItMeansNothing) {
  const WrongFormula all[] = {
      {"k * ", 4, "the formula ends too early"},
      {"k * (d.x", 8, "')' is missing here"},
      {"1 < 2 < 3", 6, "comparisons do not follow one another"},
      {"1.5 pitch", 4, "'pitch' is no unit"},
      {"T + 1 K", 0, "'T' of which particle?"},
      {"q", 0, "unknown name 'q'"},
      {"sqr(4)", 0, "unknown function 'sqr'"},
      {"min(1)", 0, "'min' takes 2 arguments, not 1"},
      {"T_i - k", 0, "'-' between a temperature and a stiffness"},
      {"d * d", 0, "'*' between two vectors"},
      {"1 / d", 0, "a vector divides nothing"},
      {"exp(d.x)", 4, "a plain number is needed here, not a length"},
      {"norm(d) ^ 0.5", 0, "a length to the power of 0.5 has no unit"},
      {"2 ^ (T_i / 1 K)", 5, "an exponent is a constant"},
      {"1 and 2 > 1", 0, "a truth is needed here, not a number"},
      {"d.w", 1, "a component is .x, .y or .z"},
      {"k.x", 0, "a number has no component"},
      {"[1, 2]", 0, "a vector has three components, not 2"},
      {"[k, T_i, 0]", 4, "a vector of a stiffness and a temperature"},
      {"loop", 0, "'loop' is defined by itself"},
      {"1 $ 2", 2, "'$' does not go on the formula"},
  };
  const std::map<std::string, Formula> lets{
      {"loop", {"1 + loop", parse_expression("1 + loop"), [](const FormulaError& e) { throw e; }}}};
  for (const WrongFormula& wrong : all) try {
      compiled(wrong.text, lets);
      ADD_FAILURE() << wrong.text;
    } catch (const FormulaError& error) {
      EXPECT_EQ(error.message, wrong.message) << wrong.text;
      if (std::string(wrong.text) != "loop") {
        EXPECT_EQ(error.at, wrong.at) << wrong.text;
      }
    }
}

TEST(Formula, OfAStrangerEndsInAnError) {
  for (const std::string& text : {std::string(100000, '('), std::string(100000, '-'), std::string(20000, '1'),
                                  std::string("not ").append(100000, ' ')}) {
    EXPECT_THROW(parse_expression(text), FormulaError);
  }
  std::string nots;
  for (int k = 0; k < 2000; ++k) nots += "not ";
  EXPECT_THROW(parse_expression(nots + "true"), FormulaError);
}

}  // namespace
}  // namespace cuboct
