// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/tersoff_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "model/base/error.h"
#include "model/base/input_file.h"
#include "model/base/spelling.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

struct Named {
  const char* name;
  const char* element;
  TersoffTerm<double> term;
};

// In eV and angstrom.
const std::array<Named, 6> kSets = {{
    // J. Tersoff, Phys. Rev. B 37 (1988) 6991, as in LAMMPS's Si.tersoff.
    {"si_1988",
     "Si",
     {3, 1, 1.3258, 4.8381, 2.0417, 0, 22.956, 0.33675, 1.3258, 95.373, 3.0, 0.2, 3.2394, 3264.7}},
    // J. Tersoff, Phys. Rev. B 39 (1989) 5566 with its erratum, 41 (1990) 3248, as in LAMMPS's SiC.tersoff.
    {"si_1989",
     "Si",
     {3, 1, 0, 100390, 16.217, -0.59825, 0.78734, 1.1e-6, 1.73222, 471.18, 2.85, 0.15, 2.4799, 1830.8}},
    {"c_1989",
     "C",
     {3, 1, 0, 38049, 4.3484, -0.57058, 0.72751, 1.5724e-7, 2.2119, 346.7, 1.95, 0.15, 3.4879, 1393.6}},
    // P. Erhart and K. Albe, Phys. Rev. B 71 (2005) 035211, as in LAMMPS's SiC_Erhart-Albe.tersoff.
    {"si_erhart_albe",
     "Si",
     {1, 0.114354, 0, 2.00494, 0.81472, -0.259, 1, 1, 1.53810493, 219.521624, 2.82, 0.14, 2.83318929,
      2145.7128}},
    {"c_erhart_albe",
     "C",
     {1, 0.11233, 0, 181.91, 6.28433, -0.5556, 1, 1, 1.93090093, 175.426651, 2, 0.15, 4.18426232, 2019.8449}},
    // A. Zhuravlev, K. Abgaryan and D. Reviznikov, Symmetry 13 (2021) 219, table 2.
    {"si_multiscale",
     "Si",
     {3, 5.71477, 1.19417, 9.69902, 2.35646, -0.40882, 4.16334, 0.132272, 1.27279, 113.17, 2.85, 0.15,
      3.36252, 3821.34}},
}};

// Numbers of a file's entry, in its order.
constexpr std::array<const char*, 14> kWords = {"m",    "gamma",   "lambda3", "c", "d", "cos_theta0", "n",
                                                "beta", "lambda2", "B",       "R", "D", "lambda1",    "A"};

TersoffTerm<double> term_of(const std::array<double, 14>& v) {
  return {static_cast<int>(v[0]),
          v[1],
          v[2],
          v[3],
          v[4],
          v[5],
          v[6],
          v[7],
          v[8],
          v[9],
          v[10],
          v[11],
          v[12],
          v[13]};
}

// What is wrong with a term: LAMMPS's own conditions, and what the formulas need. `bond`: of a triple (i, j,
// j), whose n ... A count; in the others they are not read and usually 0.
std::optional<std::string> fault_of(const std::array<double, 14>& v, bool bond) {
  for (size_t k = 0; k < v.size(); ++k)
    if (!std::isfinite(v[k])) return fmt::format("{} is not a number", kWords[k]);
  if (v[0] != 1 && v[0] != 3) return fmt::format("m is {}, which must be 1 or 3", v[0]);
  const auto below = [&](size_t k) {
    return fmt::format("{} is {}, which must not be negative", kWords[k], v[k]);
  };
  for (const size_t k : {1, 3, 7, 8, 9, 12, 13})
    if (v[k] < 0) return below(k);
  if (v[4] <= 0) return fmt::format("d is {}, which must be positive", v[4]);
  if (bond && v[6] <= 0) return fmt::format("n is {}, which must be positive", v[6]);
  if (v[11] <= 0) return fmt::format("D is {}, which must be positive", v[11]);
  if (v[11] > v[10]) return fmt::format("D is {}, which must not be above R, {}", v[11], v[10]);
  return std::nullopt;
}

struct Word {
  std::string text;
  int line = 0, column = 0;
};

struct File {
  std::vector<Word> words, comments;
};

File words_of(const std::string& path) {
  std::istringstream in(read_input(path));
  File file;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const size_t comment = std::min(line.size(), line.find('#'));
    constexpr const char* kBlank = " \t\r";
    for (size_t at = line.find_first_not_of(kBlank); at != std::string::npos;) {
      size_t end = std::min(line.find_first_of(kBlank, at), line.size());
      if (at < comment) end = std::min(end, comment);
      (at < comment ? file.words : file.comments)
          .push_back({line.substr(at, end - at), number, static_cast<int>(at) + 1});
      at = line.find_first_not_of(kBlank, end);
    }
  }
  return file;
}

InputError wrong(const std::string& path, const Word& at, const std::string& what,
                 const std::string& hint = {}) {
  return InputError(path, at.line, at.column, what, hint);
}

// eV per kcal/mol: the thermochemical calorie, 4.184 J (NIST SP 811, appendix B.8), Avogadro's number and the
// elementary charge (CODATA 2018, exact). LAMMPS's own factor, 1/23.060549, is 5e-8 of it less.
constexpr double kKilocaloriePerMole = 4184 / (6.02214076e23 * 1.602176634e-19);

// eV of the file's unit of energy, by LAMMPS's tag "UNITS: metal" or "UNITS: real" in a comment; both have
// angstrom. Without a tag metal, as LAMMPS's own files were before there were tags.
double energy_unit(const std::string& path, const std::vector<Word>& comments) {
  constexpr const char* kHint = "'UNITS: metal' is eV and angstrom, 'UNITS: real' kcal/mol and angstrom";
  const Word* said = nullptr;
  for (size_t k = 0; k < comments.size(); ++k) {
    if (comments[k].text != "UNITS:") continue;
    if (k + 1 == comments.size() || comments[k + 1].line != comments[k].line)
      throw wrong(path, comments[k], "'UNITS:' names no units", kHint);
    const Word& units = comments[k + 1];
    if (units.text != "metal" && units.text != "real")
      throw wrong(path, units, fmt::format("parameters in units '{}' are not read", line_text(units.text)),
                  kHint);
    if (said && said->text != units.text)
      throw wrong(path, units,
                  fmt::format("units '{}', but line {} says '{}'", units.text, said->line, said->text));
    said = &units;
  }
  return said && said->text == "real" ? kKilocaloriePerMole : 1;
}

double number_of(const std::string& path, const Word& word, const char* name) {
  double value = 0;
  const char* const end = word.text.data() + word.text.size();
  const auto [stop, error] = std::from_chars(word.text.data(), end, value);
  if (error != std::errc() || stop != end)
    throw wrong(path, word, fmt::format("expected the number {}, got '{}'", name, line_text(word.text)),
                "an entry has three elements and 14 numbers");
  return value;
}

}  // namespace

double Tersoff::cutoff() const {
  double longest = 0;
  for (const auto& t : terms) longest = std::max(longest, t.R + t.D);
  return longest;
}

Tersoff Tersoff::scaled(double energy, double length) const {
  Tersoff other = *this;
  for (auto& t : other.terms) {
    t.A *= energy, t.B *= energy;
    t.R *= length, t.D *= length;
    t.lambda1 /= length, t.lambda2 /= length, t.lambda3 /= length;
  }
  return other;
}

std::vector<std::string> tersoff_set_names() {
  std::vector<std::string> names;
  for (const Named& set : kSets) names.emplace_back(set.name);
  return names;
}

Tersoff tersoff_set(std::string_view name) {
  for (const Named& set : kSets)
    if (set.name == name) return {{set.element}, {set.term}};
  throw InputError(fmt::format("no set of Tersoff parameters is called '{}'", line_text(std::string(name))),
                   did_you_mean(std::string(name), tersoff_set_names()));
}

Tersoff tersoff_of(const std::string& element, const TersoffTerm<double>& t) {
  const std::array<double, 14> numbers = {static_cast<double>(t.m),
                                          t.gamma,
                                          t.lambda3,
                                          t.c,
                                          t.d,
                                          t.cos_theta0,
                                          t.n,
                                          t.beta,
                                          t.lambda2,
                                          t.B,
                                          t.R,
                                          t.D,
                                          t.lambda1,
                                          t.A};
  if (const auto fault = fault_of(numbers, true)) throw InputError(*fault);
  return {{element}, {t}};
}

Tersoff read_tersoff(const std::string& path, const std::vector<std::string>& elements) {
  const File file = words_of(path);
  const std::vector<Word>& words = file.words;
  const double unit = energy_unit(path, file.comments);
  const size_t count = elements.size();
  std::vector<std::optional<TersoffTerm<double>>> found(count * count * count);
  for (size_t at = 0; at < words.size(); at += 17) {
    if (words.size() - at < 17)
      throw wrong(path, words[at], fmt::format("the last entry has {} words, not 17", words.size() - at),
                  "an entry has three elements and 14 numbers");
    std::array<double, 14> numbers{};
    for (size_t k = 0; k < numbers.size(); ++k) numbers[k] = number_of(path, words[at + 3 + k], kWords[k]);
    size_t index = 0;
    bool wanted = true;
    for (size_t k = 0; k < 3; ++k) {
      const auto place = std::find(elements.begin(), elements.end(), words[at + k].text);
      wanted = wanted && place != elements.end();
      index = index * count + static_cast<size_t>(place - elements.begin());
    }
    if (!wanted) continue;
    if (const auto fault = fault_of(numbers, words[at + 1].text == words[at + 2].text))
      throw wrong(path, words[at], *fault);
    if (found[index]) throw wrong(path, words[at], "the same three elements have an entry above");
    found[index] = term_of(numbers);
  }
  Tersoff tersoff{elements, {}};
  for (size_t index = 0; index < found.size(); ++index) {
    if (!found[index])
      throw InputError(fmt::format("{} has no entry for {} {} {}", line_text(path),
                                   elements[index / count / count], elements[index / count % count],
                                   elements[index % count]));
    tersoff.terms.push_back(*found[index]);
  }
  return unit == 1 ? tersoff : tersoff.scaled(unit, 1);
}

std::vector<std::string> tersoff_elements(const std::string& path) {
  const std::vector<Word> words = words_of(path).words;
  std::vector<std::string> elements;
  for (size_t at = 0; at + 17 <= words.size(); at += 17)
    if (words[at].text == words[at + 1].text && words[at].text == words[at + 2].text)
      elements.push_back(words[at].text);
  if (elements.empty())
    throw InputError(fmt::format("{} has no entry of one element", line_text(path)),
                     "an entry has three elements and 14 numbers");
  return elements;
}

}  // namespace cuboct
