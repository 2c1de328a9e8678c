// SPDX-License-Identifier: MIT
// Reads a certificate and follows its intervals, with arithmetic of its own: no code of the builder is used.
#include <algorithm>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "model/graph/certificate.h"

namespace cuboct::graph {
namespace {

__extension__ typedef __int128 Big;

// Beyond any value.
constexpr Big kNone = Big{1} << 100;

struct Ends {
  Big low = 0, high = 0;
  bool holds(const Ends& o) const { return low <= o.low && o.high <= high; }
  bool operator==(const Ends&) const = default;
};

Ends ends_of(std::initializer_list<Big> v) { return {std::min(v), std::max(v)}; }

// A value of 64 bits times the largest of these stays a Big.
constexpr int kMostPlaces = 63;

Big power(Big n) {
  if (n < 0 || n > kMostPlaces) throw std::runtime_error("a shift by places that there are not");
  return Big{1} << static_cast<int>(n);
}

Big down(Big a, Big places) {
  if (places < 0 || places > kMostPlaces) throw std::runtime_error("a shift by places that there are not");
  return a >> static_cast<int>(places);
}

// To nearest, halves away from zero.
Big nearest(Big a, Big shift) {
  const Big half = shift > 0 ? power(shift - 1) : 0;
  return a < 0 ? -down(-a + half, shift) : down(a + half, shift);
}

int bits_below(Big a) {  // place of the leading bit; -1 for none
  int n = -1;
  for (; a > 0; a >>= 1) ++n;
  return n;
}

struct Entry {
  Big c0, c1, c2;
};

struct Curve {
  bool octaves = false;
  int degree = 1, D = 0, index = 0, bins = 0, first = 0, T = 0;
  std::vector<Entry> entries;

  // First argument of a bin; that of the bin behind the last is the end of the table.
  Big start(Big bin) const {
    if (!octaves) return bin * power(2 * D - index);
    if (bin == 0) return 0;
    const int octave = first + static_cast<int>(bin >> bins);
    const Big mantissa = power(bins) + bin % power(bins);
    return octave >= bins ? mantissa * power(octave - bins)
                          : down(mantissa + power(bins - octave) - 1, bins - octave);
  }
  // The bits of the argument below the bin.
  Big fraction(Big x) const {
    if (!octaves) return down(x, 2 * D - index - T) % power(T);
    const int octave = bits_below(x), spare = octave - bins - T;
    if (octave < first) return 0;
    return (spare >= 0 ? down(x, spare) : x * power(-spare)) % power(T);
  }
  Ends over(Ends argument, Ends law) const {
    if (argument.low < 0 || argument.high >= power(2 * D) || law.low < 0 ||
        (law.high + 1) * power(index) > static_cast<Big>(entries.size()))
      throw std::runtime_error("the lookup reaches beyond its table");
    const Big count = octaves ? (2 * D - first) * power(bins) : power(index);
    if (count > power(index)) throw std::runtime_error("the table has no room for its bins");
    Ends all{kNone, -kNone};
    for (Big n = law.low; n <= law.high; ++n)
      for (Big bin = 0; bin < count; ++bin) {
        const Big low = std::max(argument.low, start(bin)),
                  high = std::min(argument.high, start(bin + 1) - 1);
        if (low <= high)
          add(all, entries[static_cast<size_t>(n * power(index) + bin)], fraction(low), fraction(high));
        if (octaves && bin == 0 && low < power(first))
          add(all, entries[static_cast<size_t>(n * power(index))], 0, 0);
      }
    return all;
  }
  void add(Ends& all, const Entry& e, Big t0, Big t1) const {
    for (const Big t : {t0, t1}) {
      const Big v = e.c0 + nearest((e.c1 + nearest(e.c2 * t, T)) * t, T);
      all = {std::min(all.low, v), std::max(all.high, v)};
    }
    // Between the ends a parabola's extreme is at t = -c1 2^T / (2 c2), and there c0 - c1^2 / (4 c2).
    const Big sign = e.c2 < 0 ? -1 : 1, size = sign * e.c2, at = -sign * e.c1 * power(T);
    if (e.c2 == 0 || at <= 2 * size * t0 || at >= 2 * size * t1) return;
    const Big beyond = e.c0 - sign * (e.c1 * e.c1 / (4 * size) + 2);
    all = {std::min(all.low, beyond), std::max(all.high, beyond)};
  }
};

using Words = std::istringstream;

class Checker {
 public:
  void line(const std::string& text) {
    Words words(text.substr(0, text.find('#')));
    std::string first, what;
    words >> first;
    if (first == "partners") return read_partners(words);
    if (first == "pair" || first == "finish")
      return nodes_.clear(), in_pair_ = first == "pair", begin_tables();
    if (first == "format") return words >> what, read_format(what, words);
    if (first == "table") return read_table(words);
    if (first == "entry") return read_entry(words);
    if (first == "sum") return read_sum(words);
    if (first == "write") return words >> what, read_write(what, words);
    if (first != std::to_string(nodes_.size())) throw std::runtime_error("this is not the next node");
    read_node(words);
  }

 private:
  void read_partners(Words& words) {
    int partners = 0;
    if (!(words >> partners) || partners < 0) throw std::runtime_error("no number of partners");
    partners_ = partners;
  }
  void begin_tables() {
    curves_.clear();
    if (in_pair_) sums_.clear();
  }
  void read_format(const std::string& what, Words& words) {
    int index = 0;
    std::string in;
    words >> index >> in;
    formats_[{what, index}] = ends(words);
  }
  void read_table(Words& words) {
    Curve c;
    std::string shape, w;
    size_t number = 0;
    words >> number >> shape >> w >> c.degree >> w >> c.D >> w >> c.index >> w >> c.bins >> w >> c.first >>
        w >> c.T;
    c.octaves = shape == "octaves";
    if (number != curves_.size()) throw std::runtime_error("this is not the next table");
    if (std::min({c.D, c.index, c.bins, c.first, c.T}) < 0 || c.D > 31 || c.first > 2 * c.D ||
        std::max(c.index, c.T) > 62 || c.index + c.T > 62)
      throw std::runtime_error("no widths of a table");
    curves_.push_back(c);
  }
  void read_entry(Words& words) {
    int64_t c0 = 0, c1 = 0, c2 = 0;
    words >> c0 >> c1 >> c2;
    curves_.at(curves_.size() - 1).entries.push_back({c0, c1, c2});
  }
  void read_sum(Words& words) {
    int sum = 0, component = 0;
    words >> sum >> component;
    const Ends term = from(words);
    sums_[{sum, component}] = {std::min<Big>(term.low, 0) * partners_,
                               std::max<Big>(term.high, 0) * partners_};
  }
  void read_write(const std::string& what, Words& words) {
    int index = 0;
    words >> index;
    if (!formats_.at({what, index}).holds(from(words)))
      throw std::runtime_error("the value may leave its format");
  }
  Ends from(Words& words) {
    std::string from;
    size_t node = 0;
    words >> from >> node;
    return nodes_.at(node);
  }
  static Ends ends(Words& words) {
    int64_t low = 0, high = 0;
    if (!(words >> low >> high) || low > high) throw std::runtime_error("no interval");
    return {low, high};
  }

  void read_node(Words& words) {
    std::string op, source, word;
    words >> op;
    if (op == "input") words >> source;
    std::vector<size_t> in;
    std::map<std::string, int64_t> with;
    while (words >> word && word != "in")
      if (std::isdigit(static_cast<unsigned char>(word[0])) != 0)
        in.push_back(std::stoul(word));
      else
        words >> with[word];
    const Ends told = ends(words), room{-power(62), power(62) - 1};
    if (!room.holds(told)) throw std::runtime_error("more than 63 bits");
    const Ends needed = op == "input" ? input(source, in, told) : value(op, in, with, told);
    if (!told.holds(needed)) throw std::runtime_error("the interval does not hold the value");
    nodes_.push_back(told);
  }

  Ends input(const std::string& source, const std::vector<size_t>& at, Ends told) {
    const int index = static_cast<int>(at.at(0)), axis = static_cast<int>(at.at(1));
    if (source == "sum") return sums_.at({index, axis});
    if (source == "own_field" || source == "other_field") return formats_.at({"field", index});
    if (source == "bond_field") return formats_.at({"bond", index});
    if (source == "own_v" || source == "other_v") return formats_.at({"velocity", 0});
    return source == "own_u" ? formats_.at({"displacement", 0}) : told;
  }

  // A product of nodes p and q; squares are not negative.
  Ends product(size_t p, size_t q) const {
    const Ends a = nodes_.at(p), b = nodes_.at(q);
    Ends all = ends_of({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
    if (p == q) all.low = a.low > 0 || a.high < 0 ? std::min(a.low * a.low, a.high * a.high) : 0;
    return all;
  }
  static Ends rounded(Ends a, Big shift) {
    const Big half = shift > 0 ? power(shift - 1) : 0;
    if (a.low < -power(63) || a.high + half >= power(63))
      throw std::runtime_error("a product beyond 64 bits");
    return {nearest(a.low, shift), nearest(a.high, shift)};
  }

  Ends dot(const std::vector<size_t>& in, Big shift) const {
    Ends sum;
    const size_t n = in.size() / 2;
    for (size_t k = 0; k < n; ++k) {
      const Ends one = product(in[k], in.at(n + k));
      sum = {sum.low + one.low, sum.high + one.high};
    }
    return rounded(sum, shift);
  }

  Ends value(const std::string& op, const std::vector<size_t>& in, std::map<std::string, int64_t>& with,
             Ends told) {
    const Big shift = with["shift"], width = with["width"];
    if (op == "constant") return {with["number"], with["number"]};
    if (op == "dot") return dot(in, shift);
    if (op == "mul") return rounded(product(in.at(0), in.at(1)), shift);
    if (op == "noise") return {-power(width - 1), power(width - 1) - 1};
    const Ends a = nodes_.at(in.at(0)), b = in.size() > 1 ? nodes_.at(in[1]) : Ends{};
    if (op == "add") return {a.low + b.low, a.high + b.high};
    if (op == "sub") return {a.low - b.high, a.high - b.low};
    if (op == "neg") return {-a.high, -a.low};
    if (op == "shl") return {a.low * power(shift), a.high * power(shift)};
    if (op == "round") return rounded(a, shift);
    if (op == "floor") return {down(a.low, shift), down(a.high, shift)};
    if (op == "lookup") return curves_.at(static_cast<size_t>(with["table"])).over(a, b);
    if (op == "min") return {std::min(a.low, b.low), std::min(a.high, b.high)};
    if (op == "max") return {std::max(a.low, b.low), std::max(a.high, b.high)};
    if (op == "abs") return {a.low > 0 ? a.low : a.high < 0 ? -a.high : 0, std::max(-a.low, a.high)};
    if (op == "clamp" || op == "within") return told;
    if (op == "msb") return {bits_below(a.low), bits_below(a.high)};
    return other_value(op, in, a, b, shift, width);
  }

  static Ends aligned(Ends a, Big place, Big step) {
    if (step < 1) throw std::runtime_error("no step of an alignment");
    const auto moved = [&](Big v) { return place - bits_below(v) / step * step; };
    const auto at = [&](Big v, Big by) { return by >= 0 ? v * power(by) : down(v, -by); };
    if (a.high <= 0) return {};
    if (a.low > 0 && moved(a.low) == moved(a.high))
      return {at(a.low, moved(a.low)), at(a.high, moved(a.low))};
    return {a.low > 0 ? power(place) : 0, power(place + step) - 1};
  }

  Ends other_value(const std::string& op, const std::vector<size_t>& in, Ends a, Ends b, Big shift,
                   Big width) const {
    if (op == "check") {
      const Ends wrapped{-power(width - 1), power(width - 1) - 1};
      return wrapped.holds(a) ? a : wrapped;
    }
    if (op == "align") return aligned(a, shift, width);
    if (op == "shift") {
      const auto at = [](Big v, Big by) { return by >= 0 ? v * power(by) : nearest(v, -by); };
      return ends_of({at(a.low, b.low), at(a.low, b.high), at(a.high, b.low), at(a.high, b.high)});
    }
    const auto c = [&] { return nodes_.at(in.at(2)); };
    if (op == "mac") {
      const Ends p = rounded(product(in.at(1), in.at(2)), shift);
      return {a.low + p.low, a.high + p.high};
    }
    const Ends truth{0, 1};
    if (op == "select" && truth.holds(a)) return {std::min(b.low, c().low), std::max(b.high, c().high)};
    if (op == "lt" || op == "le" || op == "eq") return truth;
    if ((op == "both" || op == "either") && truth.holds(a) && truth.holds(b)) return truth;
    if (op == "negate" && truth.holds(a)) return truth;
    throw std::runtime_error("no such operation of truths: " + op);
  }

  Big partners_ = 0;
  bool in_pair_ = false;
  std::vector<Ends> nodes_;
  std::vector<Curve> curves_;
  std::map<std::pair<int, int>, Ends> sums_;
  std::map<std::pair<std::string, int>, Ends> formats_;
};

}  // namespace

Refusal refusal_of(const std::string& certificate) {
  std::istringstream lines(certificate);
  std::string text;
  Checker checker;
  for (int line = 1; std::getline(lines, text); ++line) try {
      checker.line(text);
    } catch (const std::exception& e) {
      return {line, e.what()};
    }
  return {};
}

}  // namespace cuboct::graph
