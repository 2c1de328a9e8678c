// SPDX-License-Identifier: MIT
// LAMMPS's data files: a comment, a head of counts and the box's ends, then sections.
// https://docs.lammps.org/read_data.html
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "model/base/error.h"
#include "model/body/particle_file.h"

namespace cuboct {
namespace {

// Columns of a line of Atoms, without the three image flags that may follow; where its type and its x stand.
// `spins`: of Velocities, behind the velocity.
struct AtomStyle {
  const char* name;
  size_t columns, type, x, spins;
};
constexpr AtomStyle kAtomStyles[] = {
    {"atomic", 5, 1, 2, 0}, {"charge", 6, 1, 3, 0}, {"molecular", 6, 2, 3, 0}, {"bond", 6, 2, 3, 0},
    {"angle", 6, 2, 3, 0},  {"full", 7, 2, 4, 0},   {"sphere", 7, 1, 4, 3}};
constexpr size_t kImageFlags = 3;

// Sections of coefficients: the scene says which forces act.
constexpr const char* kCoefficients[] = {"Pair Coeffs",  "PairIJ Coeffs",   "Bond Coeffs",
                                         "Angle Coeffs", "Dihedral Coeffs", "Improper Coeffs"};

struct DataHead {
  uint64_t atoms = 0, types = 0;
  bool has_atoms = false, has_box = false;
  ParticleFileBox box;
};

std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

std::vector<std::string_view> words_in(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

// "... units = metal" of newer versions.
std::string stated_style(std::string_view line) {
  const size_t at = line.find("units = ");
  if (at == std::string_view::npos) return {};
  line.remove_prefix(at + 8);
  return std::string(take_word(line));
}

void read_bounds(const ParticleText& text, const std::vector<std::string_view>& words, size_t axis,
                 DataHead& head) {
  const double low = text.number(words[0], "the lower end of the box"),
               high = text.number(words[1], "the upper end of the box");
  if (!(low < high))
    text.fail(words[1], fmt::format("the box ends at {:.6g} along {}, where it begins at {:.6g}", high,
                                    "xyz"[axis], low));
  if (axis == 0) head.box.at = text.byte_of(words[0]);
  head.box.low[static_cast<Eigen::Index>(axis)] = low;
  head.box.extent[static_cast<Eigen::Index>(axis)] = high - low;
}

// A line of numbers and what they are. `box`: it counts.
void read_head_line(const ParticleText& text, const std::vector<std::string_view>& words, bool box,
                    DataHead& head) {
  size_t numbers = 0;
  while (numbers < words.size() && !std::isalpha(static_cast<unsigned char>(words[numbers][0]))) ++numbers;
  const std::string what =
      fmt::format("{}", fmt::join(words.begin() + static_cast<ptrdiff_t>(numbers), words.end(), " "));
  const auto is = [&](const char* name, size_t count) { return what == name && numbers == count; };
  const char* bounds[] = {"xlo xhi", "ylo yhi", "zlo zhi"};
  for (size_t axis = 0; axis < 3; ++axis)
    if (is(bounds[axis], 2)) return head.has_box = true, read_bounds(text, words, axis, head);
  if (is("xy xz yz", 3)) {
    for (size_t k = 0; k < 3; ++k)
      if (text.number(words[k], "a tilt of the box") != 0 && box)
        text.fail(words[k], "the box of the file is no cuboid along x, y and z",
                  "a box that repeats is one; 'box = false' leaves this one out");
    return;
  }
  if (is("atoms", 1)) {
    head.atoms = text.count(words[0], "the number of atoms"), head.has_atoms = true;
    if (head.atoms == 0) text.fail(words[0], "the file has no atom");
    return;
  }
  if (is("atom types", 1)) return void(head.types = text.count(words[0], "the number of atom types"));
  for (const char* joined :
       {"bonds", "angles", "dihedrals", "impropers", "ellipsoids", "lines", "triangles", "bodies"})
    if (is(joined, 1)) {
      if (text.count(words[0], "this number") > 0)
        text.fail(words[0], fmt::format("the file has {}, which no scene has", joined),
                  "particles of a scene are points, and its law acts between all");
      return;
    }
  for (const char* more : {"bond types", "angle types", "dihedral types", "improper types"})
    if (is(more, 1)) return;
  if (what.starts_with("extra ") && what.ends_with(" per atom")) return;
  text.fail(words[0],
            fmt::format("neither LAMMPS's data nor extended XYZ: '{}'",
                        shown_word(text.text().substr(
                            text.byte_of(words[0]),
                            text.byte_of(words.back()) + words.back().size() - text.byte_of(words[0])))),
            "the head of a data file has lines such as '4000 atoms' and '0 10 xlo xhi'");
}

struct SectionName {
  std::string name;
  std::string_view at, comment;
};

// The next line that is not blank, within the comment's reach; empty at the end of the text.
std::string_view next_line(ParticleText& text) {
  while (!text.ends()) {
    const std::string_view line = text.line();
    if (!is_blank_line(without_comment(line))) return line;
  }
  return text.text().substr(text.text().size());
}

bool names_section(std::string_view line) {
  const std::string_view word = take_word(line);
  return !word.empty() && std::isalpha(static_cast<unsigned char>(word[0])) != 0;
}

SectionName section_of(std::string_view line) {
  const std::vector<std::string_view> words = words_in(without_comment(line));
  SectionName section{fmt::format("{}", fmt::join(words, " ")), words[0], {}};
  if (const size_t mark = line.find('#'); mark != std::string_view::npos) {
    std::string_view comment = line.substr(mark + 1);
    section.comment = take_word(comment);
  }
  return section;
}

// The words of `count` lines of a section; `take` has each.
template <typename Take>
void section_lines(ParticleText& text, const SectionName& section, uint64_t count, Take take) {
  for (uint64_t k = 0; k < count; ++k) {
    const std::string_view line = next_line(text);
    if (line.empty() || names_section(line))
      text.fail(line.empty() ? text.text().size() : text.byte_of(line),
                fmt::format("{}: {} of {} lines are there", section.name, k, count));
    take(without_comment(line));
  }
}

const AtomStyle& style_by_name(const ParticleText& text, const SectionName& section,
                               const std::string& name) {
  const auto* found = std::ranges::find(kAtomStyles, name, &AtomStyle::name);
  if (found == std::end(kAtomStyles))
    text.fail(section.comment, fmt::format("the atom style '{}' is not read", shown_word(section.comment)),
              fmt::format("read are {}", fmt::join(particle_atom_styles(), ", ")));
  return *found;
}

const AtomStyle& atom_style(ParticleText& text, const SectionName& section,
                            const ParticleFileChoice& choice) {
  if (choice.atom_style) {
    if (section.comment != *choice.atom_style &&
        std::ranges::find(kAtomStyles, section.comment, &AtomStyle::name) != std::end(kAtomStyles))
      text.fail(section.comment,
                fmt::format("the file states that its atom style is '{}', and 'atom_style' says '{}'",
                            section.comment, *choice.atom_style),
                "leave 'atom_style' out");
    return style_by_name(text, section, *choice.atom_style);
  }
  if (!section.comment.empty()) return style_by_name(text, section, std::string(section.comment));
  const size_t begin = text.at();
  const size_t columns = words_in(without_comment(next_line(text))).size();
  text.seek(begin);
  UnknownAtomStyle unknown{columns, {}};
  for (const AtomStyle& style : kAtomStyles)
    if (columns == style.columns || columns == style.columns + kImageFlags)
      unknown.styles.emplace_back(style.name);
  if (unknown.styles.size() > 1) throw unknown;
  return style_by_name(text, section, unknown.styles.empty() ? "atomic" : unknown.styles[0]);
}

// Types of a file count from 1.
void check_type(const ParticleText& text, std::string_view word, const DataHead& head) {
  const uint64_t type = text.count(word, "the type of an atom");
  if (type == 0 || (head.types > 0 && type > head.types))
    text.fail(word, fmt::format("the type {} is not one of 1 to {}", type, head.types));
}

void read_atoms(ParticleText& text, const SectionName& section, const AtomStyle& style, const DataHead& head,
                std::vector<uint64_t>& ids, ParticleFile& file) {
  const auto most = static_cast<size_t>(std::min<uint64_t>(head.atoms, text.text().size() / 10));
  file.x.reserve(most), file.at.reserve(most), file.kind.reserve(most), ids.reserve(most);
  ParticleKinds kinds(file);
  section_lines(text, section, head.atoms, [&](std::string_view line) {
    Vec3 x = Vec3::Zero();
    size_t k = 0;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++k) {
      if (k == 0) ids.push_back(text.count(word, "the id of an atom"));
      if (k == style.type) check_type(text, word, head), kinds.add(word);
      if (k == style.x) file.at.push_back(text.byte_of(word));
      if (k >= style.x && k < style.x + 3) {
        constexpr const char* kWhat[] = {"the x of an atom", "the y of an atom", "the z of an atom"};
        x[static_cast<Eigen::Index>(k - style.x)] = text.number(word, kWhat[k - style.x]);
      }
    }
    if (k != style.columns && k != style.columns + kImageFlags)
      text.fail(line, fmt::format("{} columns: a line of atom style '{}' has {}, or {} with image flags", k,
                                  style.name, style.columns, style.columns + kImageFlags));
    file.x.push_back(x);
  });
  order_particles(ids, file);
}

void read_data_velocities(ParticleText& text, const SectionName& section, size_t columns,
                          const std::vector<uint64_t>& ids, ParticleFile& file) {
  std::vector<char> there(ids.size(), 0);
  file.v.assign(ids.size(), Vec3::Zero());
  section_lines(text, section, ids.size(), [&](std::string_view line) {
    const std::string_view word = take_word(line);
    const uint64_t id = text.count(word, "the id of an atom");
    const auto found = std::ranges::lower_bound(ids, id);
    if (found == ids.end() || *found != id) text.fail(word, fmt::format("no atom has the id {}", id));
    const auto i = static_cast<size_t>(found - ids.begin());
    if (there[i] != 0) text.fail(word, fmt::format("the velocity of atom {} is there twice", id));
    there[i] = 1;
    constexpr const char* kWhat[] = {"the x of a velocity", "the y of a velocity", "the z of a velocity"};
    size_t k = 1;
    for (std::string_view number = take_word(line); !number.empty(); number = take_word(line), ++k)
      if (k < 4) file.v[i][static_cast<Eigen::Index>(k - 1)] = text.number(number, kWhat[k - 1]);
    if (k != columns) text.fail(line, fmt::format("{} columns: a line of Velocities has {}", k, columns));
  });
}

// By type; kinds come when the atoms do.
std::vector<double> read_data_masses(ParticleText& text, const SectionName& section, const DataHead& head) {
  constexpr uint64_t kMostTypes = 1'000'000;
  if (head.types > kMostTypes) text.fail(section.at, fmt::format("more than {} atom types", kMostTypes));
  std::vector<double> masses(head.types + 1, 0);
  section_lines(text, section, head.types, [&](std::string_view line) {
    const std::vector<std::string_view> words = words_in(line);
    if (words.size() != 2) text.fail(line, fmt::format("{} columns: a line of Masses has 2", words.size()));
    check_type(text, words[0], head);
    const double mass = text.number(words[1], "the mass of a type");
    if (!(mass > 0)) text.fail(words[1], fmt::format("the mass of a type must be above 0, not {:.6g}", mass));
    masses[text.count(words[0], "the type")] = mass;
  });
  return masses;
}

}  // namespace

const std::vector<std::string>& particle_atom_styles() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const AtomStyle& style : kAtomStyles) all.emplace_back(style.name);
    return all;
  }();
  return names;
}

void read_lammps_data(const ParticleFileChoice& choice, ParticleFile& file) {
  ParticleText& text = *file.text;
  if (choice.frame.value_or(0) != 0) throw NoSuchFrame{1};
  file.style = stated_style(text.line());
  DataHead head;
  head.box.periodic.fill(true);
  std::string_view line = next_line(text);
  for (; !line.empty() && !names_section(line); line = next_line(text))
    read_head_line(text, words_in(without_comment(line)), choice.box, head);
  if (!head.has_atoms)
    text.fail(line.empty() ? text.text().size() : text.byte_of(line),
              "neither LAMMPS's data nor extended XYZ: no line such as '4000 atoms'",
              "extended XYZ begins with a line that holds the number of particles alone");
  if (head.types == 0)
    text.fail(line.empty() ? text.text().size() : text.byte_of(line),
              "no line such as '1 atom types' is above this");
  std::vector<uint64_t> ids;
  std::vector<double> masses;
  size_t velocity_columns = 4;
  while (!line.empty()) {
    const SectionName section = section_of(line);
    if (section.name == "Atoms") {
      if (!ids.empty()) text.fail(section.at, "a second section Atoms");
      const AtomStyle& style = atom_style(text, section, choice);
      velocity_columns = 4 + style.spins;
      read_atoms(text, section, style, head, ids, file);
    } else if (section.name == "Velocities") {
      if (ids.empty()) text.fail(section.at, "Velocities stand before Atoms");
      if (!file.v.empty()) text.fail(section.at, "a second section Velocities");
      read_data_velocities(text, section, velocity_columns, ids, file);
    } else if (section.name == "Masses") {
      masses = read_data_masses(text, section, head);
    } else if (std::ranges::find(kCoefficients, section.name) != std::end(kCoefficients)) {
      for (line = next_line(text); !line.empty() && !names_section(line);) line = next_line(text);
      continue;
    } else {
      text.fail(section.at, fmt::format("a section '{}' is not read", shown_word(section.name)),
                "read are Masses, Atoms and Velocities, and coefficients are left out");
    }
    line = next_line(text);
    if (!line.empty() && !names_section(line))
      text.fail(line, fmt::format("more lines than {} has by the head of the file", section.name));
  }
  if (ids.empty()) text.fail(text.text().size(), "the file has no section Atoms");
  if (!masses.empty())
    for (const std::string& kind : file.kinds) file.kind_mass.push_back(masses[std::stoul(kind)]);
  if (choice.box && head.has_box) file.box = head.box;
}

}  // namespace cuboct
