// SPDX-License-Identifier: MIT
#include "model/program/expression.h"

#include <fmt/format.h>

#include <cctype>
#include <initializer_list>
#include <utility>

namespace cuboct {
namespace {

constexpr int kDeepest = 64;            // brackets and signs within one another
constexpr size_t kMostBytes = 1 << 14;  // of a formula

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool in_name(char c) { return begins_name(c) || std::isdigit(static_cast<unsigned char>(c)) != 0; }

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Expression whole() {
    if (text_.size() > kMostBytes) fail(0, fmt::format("a formula of {} bytes", text_.size()));
    Expression all = either();
    if (const size_t at = next(); at < text_.size())
      fail(at, fmt::format("'{}' does not go on the formula", text_.substr(at, 1)));
    return all;
  }

 private:
  using Kind = Expression::Kind;

  [[noreturn]] static void fail(size_t at, const std::string& message, const std::string& hint = {}) {
    throw FormulaError{at, message, hint};
  }

  size_t next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
    return at_;
  }
  bool takes(std::string_view mark) {
    next();
    if (!text_.substr(at_).starts_with(mark)) return false;
    const char after = at_ + mark.size() < text_.size() ? text_[at_ + mark.size()] : ' ';
    if (begins_name(mark[0]) && in_name(after)) return false;
    at_ += mark.size();
    return true;
  }
  void want(std::string_view mark) {
    if (!takes(mark)) fail(next(), fmt::format("'{}' is missing here", mark));
  }
  static Expression binary(std::string_view op, Expression a, Expression b) {
    Expression e{Kind::binary, std::string(op), 0, {}, {}, a.at};
    e.of = {std::move(a), std::move(b)};
    return e;
  }
  static Expression unary(std::string_view op, size_t at, Expression a) {
    Expression e{Kind::unary, std::string(op), 0, {}, {}, at};
    e.of = {std::move(a)};
    return e;
  }
  // Left to right: part (op part)*.
  Expression chain(std::initializer_list<std::string_view> ops, Expression (Parser::*part)()) {
    Expression e = (this->*part)();
    for (bool more = true; more;) {
      more = false;
      for (const std::string_view op : ops)
        if (takes(op)) {
          e = binary(op, std::move(e), (this->*part)());
          more = true;
          break;
        }
    }
    return e;
  }

  Expression either() {
    if (++depth_ > kDeepest) fail(at_, fmt::format("more than {} brackets within one another", kDeepest));
    Expression e = chain({"or"}, &Parser::both);
    --depth_;
    return e;
  }
  Expression both() { return chain({"and"}, &Parser::negation); }
  Expression negation() {
    const size_t at = next();
    if (!takes("not")) return comparison();
    if (++depth_ > kDeepest) fail(at, fmt::format("more than {} signs in a row", kDeepest));
    Expression e = unary("not", at, negation());
    --depth_;
    return e;
  }
  Expression comparison() {
    Expression e = sum();
    for (const std::string_view op : {"<=", ">=", "==", "<", ">"})
      if (takes(op)) {
        e = binary(op, std::move(e), sum());
        for (const std::string_view again : {"<", ">", "="})
          if (next(), text_.substr(at_).starts_with(again))
            fail(at_, "comparisons do not follow one another", "a < b and b < c");
        break;
      }
    return e;
  }
  Expression sum() { return chain({"+", "-"}, &Parser::product); }
  Expression product() { return chain({"*", "/"}, &Parser::sign); }
  Expression sign() {
    const size_t at = next();
    if (!takes("-")) return power();
    if (++depth_ > kDeepest) fail(at, fmt::format("more than {} signs in a row", kDeepest));
    Expression e = unary("-", at, sign());
    --depth_;
    return e;
  }
  Expression power() {
    Expression base = component();
    if (!takes("^")) return base;
    return binary("^", std::move(base), sign());
  }
  Expression component() {
    Expression e = primary();
    while (next() < text_.size() && text_[at_] == '.') {
      const std::string_view axis = text_.substr(at_ + 1, 1);
      const bool is_axis = axis == "x" || axis == "y" || axis == "z";
      if (!is_axis || (at_ + 2 < text_.size() && in_name(text_[at_ + 2])))
        fail(at_, "a component is .x, .y or .z");
      Expression of{Kind::component, std::string(axis), 0, {}, {}, e.at};
      of.of = {std::move(e)};
      e = std::move(of);
      at_ += 2;
    }
    return e;
  }
  Expression primary() {
    const size_t at = next();
    if (at == text_.size()) fail(at, "the formula ends too early");
    const char c = text_[at];
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') return number();
    if (begins_name(c)) return name();
    if (takes("(")) {
      Expression e = either();
      want(")");
      return e;
    }
    if (takes("[")) {
      Expression e{Kind::vector, "", 0, {}, list("]"), at};
      if (e.of.size() != 3) fail(at, fmt::format("a vector has three components, not {}", e.of.size()));
      return e;
    }
    fail(at, fmt::format("a number or a name is expected, not '{}'", c));
  }
  std::vector<Expression> list(std::string_view end) {
    std::vector<Expression> items;
    if (takes(end)) return items;
    do items.push_back(either());
    while (takes(","));
    want(end);
    return items;
  }
  Expression name() {
    const size_t at = at_;
    while (at_ < text_.size() && in_name(text_[at_])) ++at_;
    const std::string word(text_.substr(at, at_ - at));
    for (const char* reserved : {"and", "or", "not"})
      if (word == reserved) fail(at, fmt::format("a number or a name is expected, not '{}'", word));
    if (takes("(")) return {Kind::call, word, 0, {}, list(")"), at};
    return {Kind::name, word, 0, {}, {}, at};
  }

  size_t digits_end() const {
    size_t end = at_;
    const auto digits = [&] {
      while (end < text_.size() && std::isdigit(static_cast<unsigned char>(text_[end]))) ++end;
    };
    digits();
    if (end < text_.size() && text_[end] == '.') ++end, digits();
    if (end < text_.size() && (text_[end] == 'e' || text_[end] == 'E')) {
      size_t exponent = end + 1;
      if (exponent < text_.size() && (text_[exponent] == '-' || text_[exponent] == '+')) ++exponent;
      if (exponent < text_.size() && std::isdigit(static_cast<unsigned char>(text_[exponent])))
        end = exponent, digits();
    }
    return end;
  }
  // Ends of the unit that may stand at `begin`, the longest first: "N/m^2", "N/m", "N".
  std::vector<size_t> unit_ends(size_t begin) const {
    std::vector<size_t> ends;
    size_t at = begin;
    while (at < text_.size() && begins_name(text_[at])) {
      while (at < text_.size() && in_name(text_[at])) ++at;
      if (at < text_.size() && text_[at] == '^') {
        size_t exponent = at + 1;
        if (exponent < text_.size() && text_[exponent] == '-') ++exponent;
        const size_t first = exponent;
        while (exponent < text_.size() && std::isdigit(static_cast<unsigned char>(text_[exponent])))
          ++exponent;
        if (exponent > first) at = exponent;
      }
      ends.insert(ends.begin(), at);
      if (at + 1 < text_.size() && (text_[at] == '/' || text_[at] == '*') && begins_name(text_[at + 1]))
        ++at;
      else
        break;
    }
    return ends;
  }
  Expression number() {
    const size_t at = at_, end = digits_end();
    size_t unit = end;
    while (unit < text_.size() && text_[unit] == ' ') ++unit;
    const std::string digits(text_.substr(at, end - at));
    for (const char* word : {"and", "or"})
      if (at_ = unit; takes(word)) unit = text_.size();
    at_ = end;
    const std::vector<size_t> ends = unit_ends(unit);
    for (const size_t unit_end : ends) try {
        const ParsedQuantity q =
            parse_quantity(digits + " " + std::string(text_.substr(unit, unit_end - unit)));
        at_ = unit_end;
        return {Kind::number, std::string(text_.substr(at, unit_end - at)), q.values[0], q.dimension, {}, at};
      } catch (const UnitError&) {
      }
    if (!ends.empty()) {
      const std::string word(text_.substr(unit, ends.back() - unit));
      fail(unit, fmt::format("'{}' is no unit", word), fmt::format("a product is {} * {}", digits, word));
    }
    try {
      return {Kind::number, digits, parse_quantity(digits).values[0], {}, {}, at};
    } catch (const UnitError& error) {
      fail(at, error.message, error.hint);
    }
  }

  std::string_view text_;
  size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

Expression parse_expression(std::string_view text) { return Parser(text).whole(); }

}  // namespace cuboct
