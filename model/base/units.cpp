// SPDX-License-Identifier: MIT
#include "model/base/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

#include "model/base/spelling.h"
#include "model/base/unit_names.h"

namespace cuboct {
namespace {

struct NamedUnit {
  std::string_view name;
  int decimal;    // power of ten
  double factor;  // the rest, 1 for almost all
  Dimension dimension;
};

constexpr NamedUnit kUnits[] = {
    {"g", -3, 1, {{1, 0, 0, 0}}},
    {"m", 0, 1, {{0, 1, 0, 0}}},
    {"s", 0, 1, {{0, 0, 1, 0}}},
    {"N", 0, 1, {{1, 1, -2, 0}}},
    {"Pa", 0, 1, {{1, -1, -2, 0}}},
    {"J", 0, 1, {{1, 2, -2, 0}}},
    {"W", 0, 1, {{1, 2, -3, 0}}},
    {"Hz", 0, 1, {{0, 0, -1, 0}}},
    {"eV", -19, 1.602176634, {{1, 2, -2, 0}}},  // exact since 2019
    {"u", -27, 1.66053906660, {{1, 0, 0, 0}}},  // CODATA 2018
    {"K", 0, 1, {{0, 0, 0, 0, 1}}},
    {"angstrom", -10, 1, {{0, 1, 0, 0}}},
    {"min", 0, 60, {{0, 0, 1, 0}}},
    {"rad", 0, 1, {{0, 0, 0, 1}}},
    {"deg", 0, std::numbers::pi / 180, {{0, 0, 0, 1}}},
};

struct Prefix {
  std::string_view name;
  int decimal;
};

constexpr Prefix kPrefixes[] = {{"f", -15}, {"p", -12}, {"n", -9}, {"u", -6}, {"\u00b5", -6}, {"\u03bc", -6},
                                {"m", -3},  {"c", -2},  {"k", 3},  {"M", 6},  {"G", 9},       {"T", 12}};

struct Unit {
  int decimal = 0;
  double factor = 1;
  Dimension dimension;

  void multiply(const Unit& other, int power) {
    decimal += power * other.decimal;
    for (int i = 0; i < std::abs(power); ++i) {
      if (power > 0)
        factor *= other.factor;
      else
        factor /= other.factor;
    }
    for (size_t i = 0; i < dimension.exponent.size(); ++i)
      dimension.exponent[i] += power * other.dimension.exponent[i];
  }
};

const NamedUnit* find_unit(std::string_view name) {
  const auto* found = std::ranges::find(kUnits, name, &NamedUnit::name);
  return found == std::end(kUnits) ? nullptr : found;
}

std::vector<std::string> common_spellings() {
  std::vector<std::string> names = named_units();
  for (const char* name : {"kg", "mg", "mm",  "um",  "nm",  "cm", "km", "ms", "us",  "ns", "kN",
                           "mN", "MN", "kPa", "MPa", "GPa", "mJ", "uJ", "nJ", "kHz", "MHz"})
    names.emplace_back(name);
  return names;
}

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  ParsedQuantity quantity() {
    ParsedQuantity result;
    std::vector<std::string_view> numbers;
    skip_space();
    if (eat('[')) {
      result.list = true;
      do {
        numbers.push_back(number());
      } while (eat(','));
      if (!eat(']')) fail("expected ',' or ']'");
    } else {
      numbers.push_back(number());
    }
    Unit unit;
    skip_space();
    if (at_ < text_.size()) unit = product();
    if (at_ < text_.size()) fail(fmt::format("unexpected '{}'", shown(rest())), hint_for_rest());
    for (std::string_view digits : numbers)
      result.values.push_back(scaled(digits, unit.decimal) * unit.factor);
    result.dimension = unit.dimension;
    return result;
  }

 private:
  static constexpr int kDeepest = 64;
  static constexpr size_t kShown = 60;  // bytes of a text in a message

  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const {
    throw UnitError{fmt::format("{} in \"{}\"", what, shown(text_)), hint};
  }
  static std::string shown(std::string_view text) {
    if (text.size() <= kShown) return std::string(text);
    size_t end = kShown;
    while (end > 0 && (text[end] & 0xc0) == 0x80) --end;  // whole characters
    return std::string(text.substr(0, end)) + "...";
  }
  std::string_view rest() const { return text_.substr(at_); }
  void skip_space() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool eat(char c) {
    skip_space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    skip_space();
    return true;
  }

  static bool is_digit(char c) { return c >= '0' && c <= '9'; }

  std::string_view number() {
    skip_space();
    const size_t start = at_;
    auto peek = [&](size_t i) { return i < text_.size() ? text_[i] : '\0'; };
    if (peek(at_) == '+' || peek(at_) == '-') ++at_;
    size_t digits = 0;
    while (is_digit(peek(at_))) ++at_, ++digits;
    if (peek(at_) == '.') {
      ++at_;
      while (is_digit(peek(at_))) ++at_, ++digits;
    }
    if (digits == 0) {
      at_ = start;
      fail("expected a number");
    }
    // "1e-3 m" has an exponent, "1 eV" has not.
    if (peek(at_) == 'e' || peek(at_) == 'E') {
      const size_t sign = peek(at_ + 1) == '-' || peek(at_ + 1) == '+' ? 1 : 0;
      if (is_digit(peek(at_ + 1 + sign))) {
        at_ += 1 + sign;
        while (is_digit(peek(at_))) ++at_;
      }
    }
    return text_.substr(start, at_ - start);
  }

  double scaled(std::string_view digits, int decimal) const {
    std::string text(digits.front() == '+' ? digits.substr(1) : digits);
    int exponent = 0;
    const size_t e = text.find_first_of("eE");
    if (e != std::string::npos) {
      const size_t sign = text[e + 1] == '+' ? 1 : 0;
      const auto read = std::from_chars(text.data() + e + 1 + sign, text.data() + text.size(), exponent);
      if (read.ec != std::errc{} || std::abs(exponent) > 1000) fail("number out of range");
      text.resize(e);
    }
    text += fmt::format("e{}", exponent + decimal);
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc{} || !std::isfinite(value)) fail("number out of range");
    return value;
  }

  Unit product() {
    Unit unit;
    unit.multiply(power(), 1);
    while (true) {
      if (eat('*'))
        unit.multiply(power(), 1);
      else if (eat('/'))
        unit.multiply(power(), -1);
      else
        return unit;
    }
  }

  Unit power() {
    Unit base;
    if (eat('(')) {
      if (++depth_ > kDeepest) fail(fmt::format("more than {} parentheses within one another", kDeepest));
      base = product();
      --depth_;
      if (!eat(')')) fail("expected ')'");
    } else if (!eat('1')) {
      base = named();
    }
    int exponent = 1;
    if (eat('^')) {
      const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), exponent);
      if (read.ec != std::errc{} || std::abs(exponent) > 9)
        fail("expected an exponent between -9 and 9 after '^'");
      at_ = static_cast<size_t>(read.ptr - text_.data());
      skip_space();
    }
    Unit unit;
    unit.multiply(base, exponent);
    return unit;
  }

  Unit named() {
    const size_t start = at_;
    while (at_ < text_.size() &&
           (std::isalpha(static_cast<unsigned char>(text_[at_])) || (text_[at_] & 0x80) || text_[at_] == '%'))
      ++at_;
    const std::string_view name = text_.substr(start, at_ - start);
    if (name.empty()) fail("expected a unit", hint_for_rest());
    if (const NamedUnit* unit = find_unit(name)) return {unit->decimal, unit->factor, unit->dimension};
    for (const Prefix& prefix : kPrefixes) {
      if (!name.starts_with(prefix.name)) continue;
      if (const NamedUnit* unit = find_unit(name.substr(prefix.name.size())))
        return {unit->decimal + prefix.decimal, unit->factor, unit->dimension};
    }
    fail(fmt::format("unknown unit '{}'", shown(name)), hint_for(name));
  }

  // Of what stands where a text should end, or its unit begin.
  std::string hint_for_rest() const {
    const char next = at_ < text_.size() ? text_[at_] : ' ';
    if (next == ',') return "several values stand in brackets, as in \"[10, 4, 4] mm\"";
    if (is_digit(next) && at_ > 0 && std::isalpha(static_cast<unsigned char>(text_[at_ - 1])))
      return fmt::format("a power is written with '^': \"^{}\"", next);
    if (std::isalpha(static_cast<unsigned char>(next)))
      return "units are joined by '*' or '/', as in \"N*m\"";
    return {};
  }
  std::string hint_for(std::string_view name) const {
    if (name == "C" || name == "°C" || name == "degC") return "temperatures are in K: 0 °C is 273.15 K";
    return did_you_mean(std::string(name), common_spellings());
  }

  std::string_view text_;
  size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

std::string describe(const Dimension& dimension) {
  for (const Quantity& known :
       {quantity::number, quantity::length, quantity::area, quantity::mass, quantity::time,
        quantity::velocity, quantity::acceleration, quantity::density, quantity::force, quantity::stiffness,
        quantity::pressure, quantity::energy, quantity::damping, quantity::angle, quantity::angular_velocity,
        quantity::temperature})
    if (known.dimension == dimension) return known.name;
  return si_unit(dimension);
}

std::string si_unit(const Dimension& dimension) {
  for (const auto& [known, unit] : {std::pair{quantity::force, "N"},
                                    {quantity::pressure, "Pa"},
                                    {quantity::energy, "J"},
                                    {quantity::stiffness, "N/m"}})
    if (known.dimension == dimension) return unit;
  const char* base[] = {"kg", "m", "s", "rad", "K"};
  std::string above, below;
  for (size_t i = 0; i < std::size(base); ++i) {
    const int power = dimension.exponent[i];
    if (power == 0) continue;
    std::string& side = power > 0 ? above : below;
    if (power > 0 && !side.empty()) side += '*';
    if (power < 0) side += '/';
    side += base[i];
    if (std::abs(power) > 1) side += fmt::format("^{}", std::abs(power));
  }
  return (above.empty() ? "1" : above) + below;
}

std::vector<std::string> named_units() {
  std::vector<std::string> names;
  for (const NamedUnit& unit : kUnits) names.emplace_back(unit.name);
  return names;
}

ParsedQuantity parse_quantity(std::string_view text) { return Parser(text).quantity(); }

}  // namespace cuboct
