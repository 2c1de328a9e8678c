// SPDX-License-Identifier: MIT
#include "model/program/potential_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/input_file.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr uint64_t kMostOfFile = uint64_t{64} << 20;
constexpr size_t kMostElements = 32, kMostValues = 200000;  // of a table
constexpr const char* kOnlyElement = "its element";         // of a funcfl file, which does not name it
constexpr double kElectronvolt = 1.602176634e-19, kAngstrom = 1e-10;
// A funcfl file has charges Z(r), and r times the energy of a pair is Z^2 of these eV angstrom: LAMMPS's
// constants, for which such files are meant (pair_eam.cpp). Those of CODATA, 14.39964, change copper's energy
// by 2 meV.
constexpr double kCharges = 27.2 * 0.529;

struct FileWord {
  std::string_view text;
  int line = 0, column = 0;
};

class PotentialText {
 public:
  explicit PotentialText(const std::string& path) : path_(path), text_(read_input(path, kMostOfFile)) {}

  [[noreturn]] void fail(const FileWord& at, const std::string& what, const std::string& hint = {}) const {
    throw InputError(path_, at.line, at.column, what, hint);
  }
  // The words of the next line, which may be none.
  std::vector<FileWord> line() {
    std::vector<FileWord> words;
    const int number = line_;
    while (at_ < text_.size() && line_ == number) {
      if (text_[at_] == '\n') return step(), words;
      if (is_blank(text_[at_])) {
        step();
        continue;
      }
      words.push_back(word());
    }
    return words;
  }
  // The next word, on whatever line. `what` it should be of.
  FileWord next(const std::string& what) {
    while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '\n')) step();
    if (at_ == text_.size()) fail(here(), fmt::format("the file ends in {}", what));
    return word();
  }
  // Behind a table: what is left of its last line.
  void end_line() { (void)line(); }
  FileWord here() const { return {{}, line_, static_cast<int>(at_ - begin_) + 1}; }

  double number(const FileWord& word, const std::string& what) const {
    std::string_view text = word.text;
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    // What is too small for a double is 0.
    if (error == std::errc::result_out_of_range && text.find_first_of("eE") != std::string_view::npos &&
        text.find("-", text.find_first_of("eE")) != std::string_view::npos)
      return 0;
    if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value))
      fail(word, fmt::format("{} must be a number, not '{}'", what, line_text(std::string(word.text))));
    return value;
  }
  double positive(const FileWord& word, const std::string& what) const {
    const double value = number(word, what);
    if (!(value > 0)) fail(word, fmt::format("{} must be positive, not {}", what, value));
    return value;
  }
  size_t count(const FileWord& word, const std::string& what, size_t least, size_t most) const {
    const double value = number(word, what);
    if (value != std::floor(value) || !(value >= static_cast<double>(least)) ||
        !(value <= static_cast<double>(most)))
      fail(word, fmt::format("{} must be a whole number from {} to {}", what, least, most));
    return static_cast<size_t>(value);
  }
  std::vector<double> table(size_t count, const std::string& what) {
    std::vector<double> values;
    while (values.size() < count) {
      const std::string place = fmt::format("{}, value {} of {}", what, values.size() + 1, count);
      values.push_back(number(next(place), place));
    }
    return values;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  void step() {
    if (text_[at_++] == '\n') ++line_, begin_ = at_;
  }
  FileWord word() {
    FileWord of = here();
    const size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '\n') ++at_;
    of.text = std::string_view(text_).substr(begin, at_ - begin);
    return of;
  }

  std::string path_, text_;
  size_t at_ = 0, begin_ = 0;  // begin_: of the line
  int line_ = 1;
};

struct Grid {
  size_t densities = 0, distances = 0;
  double density_step = 0, distance_step = 0, cutoff = 0;
};

// As in the file.
struct Functions {
  std::vector<std::string> elements;
  Grid grid;
  std::vector<double> lattice_constant;
  std::vector<std::vector<double>> embedding, density;
  std::vector<std::vector<double>> pair;  // of (0, 0), (1, 0), (1, 1), (2, 0) ...: eV angstrom
};

bool is_number(const FileWord& word) {
  double value = 0;
  const char* end = word.text.data() + word.text.size();
  const auto [stop, error] = std::from_chars(word.text.data(), end, value);
  return error == std::errc() && stop == end;
}

Grid grid_of(const PotentialText& file, const std::vector<FileWord>& words, const FileWord& at) {
  if (words.size() < 5)
    file.fail(words.empty() ? at : words[0],
              "the numbers of values, their steps and the cutoff are expected on this line",
              "Nrho drho Nr dr cutoff");
  constexpr size_t kLeast = CubicTable::kLeastValues + 1;
  Grid grid;
  grid.densities = file.count(words[0], "the number of densities", kLeast, kMostValues);
  grid.density_step = file.positive(words[1], "the step of densities");
  grid.distances = file.count(words[2], "the number of distances", kLeast, kMostValues);
  grid.distance_step = file.positive(words[3], "the step of distances");
  grid.cutoff = file.positive(words[4], "the cutoff");
  const double last = grid.distance_step * static_cast<double>(grid.distances);
  if (grid.cutoff > last * (1 + 1e-9))
    file.fail(words[4], fmt::format("the cutoff, {}, is beyond the last distance, {}", grid.cutoff, last));
  return grid;
}

// Atomic number, mass, lattice constant, lattice; the first two are always there. The lattice constant.
double header_of(const PotentialText& file, const std::vector<FileWord>& words, const FileWord& at,
                 const std::string& element) {
  const std::string hint =
      "atomic number, mass, lattice constant, lattice; a file of eam/fs, with a density for each pair, is "
      "not "
      "read";
  if (words.size() < 2 || words[0].text.find_first_of(".eE") != std::string_view::npos)
    file.fail(words.empty() ? at : words[0],
              fmt::format("the line of the element {} is expected here", element), hint);
  file.count(words[0], "the atomic number", 0, 200);
  file.positive(words[1], "the mass");
  return words.size() > 2 && is_number(words[2]) ? file.number(words[2], "the lattice constant") : 0;
}

void check_units(const PotentialText& file, const std::vector<FileWord>& words) {
  for (size_t k = 0; k + 1 < words.size(); ++k)
    if (words[k].text == "UNITS:" && words[k + 1].text != "metal")
      file.fail(words[k + 1],
                fmt::format("a file in units '{}' is not read", line_text(std::string(words[k + 1].text))),
                "'UNITS: metal' is eV and angstrom");
}

Functions setfl(PotentialText& file, const std::vector<FileWord>& names) {
  Functions of;
  for (size_t k = 1; k < names.size(); ++k) of.elements.emplace_back(line_text(std::string(names[k].text)));
  const size_t count = of.elements.size();
  const FileWord at = file.here();
  of.grid = grid_of(file, file.line(), at);
  for (const std::string& element : of.elements) {
    const FileWord begin = file.here();
    of.lattice_constant.push_back(header_of(file, file.line(), begin, element));
    of.embedding.push_back(file.table(of.grid.densities, "the embedding energy of " + element));
    of.density.push_back(file.table(of.grid.distances, "the density of " + element));
    file.end_line();
  }
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j <= i; ++j)
      of.pair.push_back(file.table(of.grid.distances,
                                   fmt::format("the pairs of {} and {}", of.elements[i], of.elements[j])));
  return of;
}

// LAMMPS takes all values but the last of each table (PairEAM::file2array): so do we.
Functions funcfl(PotentialText& file, double lattice_constant) {
  Functions of;
  of.elements = {kOnlyElement};
  of.lattice_constant = {lattice_constant};
  const FileWord at = file.here();
  of.grid = grid_of(file, file.line(), at);
  of.embedding = {file.table(of.grid.densities, "the embedding energy")};
  std::vector<double> charge = file.table(of.grid.distances, "the charge");
  of.density = {file.table(of.grid.distances, "the density")};
  for (double& z : charge) z *= kCharges * z;
  of.pair = {std::move(charge)};
  for (auto* tables : {&of.embedding, &of.density, &of.pair}) tables->front().pop_back();
  return of;
}

// A setfl file names its elements in line 4; line 2 of a funcfl file is what line 6 of the other is.
Functions functions_of(PotentialText& file) {
  check_units(file, file.line());
  const FileWord second_at = file.here();
  const std::vector<FileWord> second = file.line();
  const auto numbers = [](const std::vector<FileWord>& words, size_t count) {
    return words.size() >= count &&
           std::all_of(words.begin(), words.begin() + static_cast<ptrdiff_t>(count), is_number);
  };
  PotentialText after = file;
  const std::vector<FileWord> third = file.line();
  if (numbers(second, 3) && numbers(third, 5))
    return funcfl(after, header_of(after, second, second_at, "of the file"));
  const FileWord at = file.here();
  const std::vector<FileWord> names = file.line();
  constexpr const char* kHint =
      "a setfl file: three lines of comments, then the number of elements and their names; a funcfl file: a "
      "comment, then atomic number, mass and lattice constant, then Nrho drho Nr dr cutoff";
  if (names.empty() || !is_number(names[0]))
    file.fail(names.empty() ? at : names[0], "neither a setfl file nor a funcfl file", kHint);
  const size_t count = file.count(names[0], "the number of elements", 1, kMostElements);
  if (names.size() != count + 1)
    file.fail(names[0], fmt::format("{} elements, but {} names", count, names.size() - 1), kHint);
  return setfl(file, names);
}

std::vector<size_t> used(const std::string& path, const Functions& of,
                         const std::vector<std::string>& elements) {
  const auto fail = [&](const std::string& what, const std::string& hint) {
    throw InputError(what, hint).about({"element"});
  };
  if (of.elements[0] == kOnlyElement && elements.size() > 1)
    fail(fmt::format("{} is a funcfl file, which has one element, not {}", line_text(path),
                     fmt::join(elements, ", ")),
         "a setfl file has several, and what pairs of them do");
  if (of.elements.size() == 1 && (elements.empty() || of.elements[0] == kOnlyElement)) return {0};
  if (elements.empty())
    fail(fmt::format("{} has several elements: {}", line_text(path), fmt::join(of.elements, ", ")),
         fmt::format("element = \"{}\"", of.elements[0]));
  std::vector<size_t> places;
  for (const std::string& element : elements) {
    const auto at = std::ranges::find(of.elements, element);
    if (at == of.elements.end())
      fail(fmt::format("{} has no element '{}'", line_text(path), line_text(element)),
           "it has " + fmt::format("{}", fmt::join(of.elements, ", ")));
    places.push_back(static_cast<size_t>(at - of.elements.begin()));
  }
  return places;
}

std::vector<double> times(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

}  // namespace

EmbeddedAtoms read_embedded_atoms(const std::string& path, const std::vector<std::string>& elements,
                                  bool si) {
  PotentialText file(path);
  const Functions of = functions_of(file);
  const std::vector<size_t> places = used(path, of, elements);
  const double length = si ? kAngstrom : 1, energy = si ? kElectronvolt : 1;
  EmbeddedAtoms made;
  Hash hash;
  const auto table = [&](const std::string& what, double step, std::vector<double> values, bool bounded) {
    hash.add(std::bit_cast<int64_t>(step));
    for (const double value : values) hash.add(std::bit_cast<int64_t>(value));
    return std::make_shared<const CubicTable>(what, step, values, bounded);
  };
  made.cutoff = of.grid.cutoff * length;
  hash.add(std::bit_cast<int64_t>(made.cutoff));
  made.lattice_constant = of.lattice_constant[places[0]] * length;
  for (const size_t i : places) {
    const std::string& name = of.elements[i];
    made.elements.push_back(elements.empty() ? name : elements[made.elements.size()]);
    made.embedding.push_back(
        table("embedding of " + name, of.grid.density_step, times(of.embedding[i], energy), true));
    made.density.push_back(table("density of " + name, of.grid.distance_step * length, of.density[i], false));
  }
  for (const size_t i : places)
    for (const size_t j : places) {
      const size_t more = std::max(i, j), less = std::min(i, j);
      made.pair.push_back(table("pair", of.grid.distance_step * length,
                                times(of.pair[more * (more + 1) / 2 + less], energy * length), false));
    }
  made.hash = hash.value();
  made.told =
      fmt::format("{}: {} densities, {} distances, cutoff {:.6g} angstrom", fmt::join(made.elements, ", "),
                  of.grid.densities, of.grid.distances, of.grid.cutoff);
  return made;
}

}  // namespace cuboct
