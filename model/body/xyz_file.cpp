// SPDX-License-Identifier: MIT
// Extended XYZ: frames one after another, each the number of particles, a line of key=value, and a line for
// each particle, whose columns `Properties` names. https://github.com/libAtoms/extxyz
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "model/base/error.h"
#include "model/body/particle_file.h"

namespace cuboct {
namespace {

constexpr const char* kPlainColumns = "species:S:1:pos:R:3";

struct XyzPart {
  std::string_view key, value;
};

// "key=value key="more words" flag": quotes, and the braces of older files, hold blanks.
std::vector<XyzPart> parts_of_comment(const ParticleText& text, std::string_view line) {
  std::vector<XyzPart> parts;
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  size_t at = 0;
  while (true) {
    while (at < line.size() && blank(line[at])) ++at;
    if (at == line.size()) return parts;
    const size_t begin = at;
    while (at < line.size() && !blank(line[at]) && line[at] != '=') ++at;
    XyzPart part{line.substr(begin, at - begin), line.substr(at, 0)};
    if (at < line.size() && line[at] == '=') {
      ++at;
      const char open = at < line.size() ? line[at] : ' ';
      if (open == '"' || open == '\'' || open == '{') {
        const size_t end = line.find(open == '{' ? '}' : open, at + 1);
        if (end == std::string_view::npos)
          text.fail(line.substr(at), fmt::format("the value of '{}' has no end", shown_word(part.key)),
                    "a quote closes it");
        part.value = line.substr(at + 1, end - at - 1);
        at = end + 1;
      } else {
        const size_t first = at;
        while (at < line.size() && !blank(line[at])) ++at;
        part.value = line.substr(first, at - first);
      }
    }
    parts.push_back(part);
  }
}

const XyzPart* find_part(const std::vector<XyzPart>& parts, std::string_view key) {
  const auto found = std::ranges::find(parts, key, &XyzPart::key);
  return found == parts.end() ? nullptr : &*found;
}

struct XyzColumn {
  std::string_view name;
  char type = 'S';
  size_t first = 0, count = 1;
};

std::vector<XyzColumn> columns_of(const ParticleText& text, std::string_view properties) {
  constexpr size_t kMostColumns = 10000;
  constexpr const char* kHint =
      "Properties=species:S:1:pos:R:3 has a name, a type (S, R, I, L) and a count for each";
  std::vector<XyzColumn> columns;
  size_t first = 0;
  std::string_view rest = properties;
  const auto next = [&] {
    const size_t end = std::min(rest.find(':'), rest.size());
    const std::string_view field = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return field;
  };
  while (!rest.empty()) {
    XyzColumn column{next(), 'S', first, 0};
    const std::string_view type = next(), count = next();
    const auto [stop, error] = std::from_chars(count.data(), count.data() + count.size(), column.count);
    const bool fine = !column.name.empty() && type.size() == 1 && std::string_view("SRIL").find(type) < 4 &&
                      error == std::errc() && stop == count.data() + count.size() && column.count > 0;
    if (!fine || first + column.count > kMostColumns)
      text.fail(column.name,
                fmt::format("Properties: no column is described by '{}:{}:{}'", shown_word(column.name),
                            shown_word(type), shown_word(count)),
                kHint);
    column.type = type[0];
    first += column.count;
    columns.push_back(column);
  }
  return columns;
}

const XyzColumn* find_column(const std::vector<XyzColumn>& columns,
                             std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(columns, name, &XyzColumn::name);
    if (found != columns.end()) return &*found;
  }
  return nullptr;
}

// That a column has the numbers that are looked for in it; null stays null.
const XyzColumn* numbers_of(const ParticleText& text, const XyzColumn* column, size_t count,
                            bool whole = false) {
  if (column == nullptr) return nullptr;
  if (column->count != count || (whole ? column->type != 'I' : column->type != 'R' && column->type != 'I'))
    text.fail(column->name, fmt::format("Properties: '{0}' must be {0}:{1}:{2}, not {0}:{3}:{4}",
                                        column->name, whole ? 'I' : 'R', count, column->type, column->count));
  return column;
}

// What a column of a row is for: an index into the numbers below, a kind, an id, or nothing.
struct XyzPlan {
  enum : int8_t { nothing = -1, kind = -2, id = -3 };
  // position 0 to 2, velocity 3 to 5, mass 6
  std::vector<int8_t> use;
  std::vector<std::string> name;  // of each column, for errors
};

XyzPlan plan_of_columns(const std::vector<XyzColumn>& columns, const XyzColumn* position,
                        const XyzColumn* velocity, const XyzColumn* mass, const XyzColumn* kind,
                        const XyzColumn* id) {
  XyzPlan plan;
  for (const XyzColumn& column : columns)
    for (size_t k = 0; k < column.count; ++k) {
      const auto number = static_cast<int8_t>(k);
      plan.use.push_back(&column == position   ? number
                         : &column == velocity ? static_cast<int8_t>(3 + number)
                         : &column == mass     ? static_cast<int8_t>(6)
                         : &column == kind     ? static_cast<int8_t>(XyzPlan::kind)
                         : &column == id       ? static_cast<int8_t>(XyzPlan::id)
                                               : static_cast<int8_t>(XyzPlan::nothing));
      plan.name.push_back(shown_word(column.name));
    }
  return plan;
}

std::array<bool, 3> periodic_of(const ParticleText& text, const XyzPart& part) {
  std::array<bool, 3> periodic{};
  std::string_view rest = part.value;
  for (bool& axis : periodic) {
    const std::string_view word = take_word(rest);
    const bool yes = word == "T" || word == "True" || word == "true" || word == "1";
    if (!yes && word != "F" && word != "False" && word != "false" && word != "0")
      text.fail(word,
                fmt::format("'pbc' is T or F for each of three axes, not '{}'", shown_word(part.value)));
    axis = yes;
  }
  return periodic;
}

// Three vectors one after another; along an axis that does not repeat one may be 0.
ParticleFileBox box_of_lattice(const ParticleText& text, const std::vector<XyzPart>& parts,
                               const XyzPart& lattice) {
  const auto numbers = [&](const XyzPart& part, size_t count) {
    std::vector<double> values;
    std::string_view rest = part.value;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest))
      values.push_back(text.number(word, count == 9 ? "a number of 'Lattice'" : "a number of 'Origin'"));
    if (values.size() != count)
      text.fail(part.key, fmt::format("'{}' has {} numbers: it needs {}", part.key, values.size(), count));
    return values;
  };
  const std::vector<double> v = numbers(lattice, 9);
  ParticleFileBox box;
  box.at = text.byte_of(lattice.key);
  box.periodic.fill(true);
  if (const XyzPart* pbc = find_part(parts, "pbc")) box.periodic = periodic_of(text, *pbc);
  if (const XyzPart* origin = find_part(parts, "Origin")) {
    const std::vector<double> o = numbers(*origin, 3);
    box.low = {o[0], o[1], o[2]};
  }
  const double largest = std::max({std::abs(v[0]), std::abs(v[4]), std::abs(v[8])});
  for (size_t k = 0; k < 9; ++k)
    if (k % 4 != 0 && std::abs(v[k]) > 1e-9 * largest)
      text.fail(lattice.key, "the box of the file is no cuboid along x, y and z",
                "a box that repeats is one; 'box = false' leaves this one out");
  box.extent = {v[0], v[4], v[8]};
  return box;
}

// "Time:s pos:m velo:m/s": the unit of a column, as cuboct's own frames tell it.
std::string unit_in(std::string_view units, std::string_view column) {
  for (std::string_view word = take_word(units); !word.empty(); word = take_word(units))
    if (word.starts_with(column) && word.substr(column.size()).starts_with(':'))
      return std::string(word.substr(column.size() + 1));
  return {};
}

// What a frame's first lines say, and where they are.
struct XyzHead {
  std::string_view number;  // the word
  uint64_t count = 0;
  size_t body = 0;  // byte of its second line
};

XyzHead head_at(ParticleText& text, const XyzHead* before) {
  std::string_view line = text.line(), rest = line;
  XyzHead head;
  head.number = take_word(rest);
  if (!is_whole(head.number) || !is_blank_line(rest)) {
    const std::string_view at = head.number.empty() ? line.substr(0, 0) : head.number;
    if (before != nullptr)
      text.fail(at, fmt::format("a frame's number of particles is expected here, not '{}'", shown_word(line)),
                fmt::format("line {} says that the frame before has {}",
                            text.line_at(text.byte_of(before->number)), before->count));
    text.fail(at, fmt::format("the number of particles is expected here, not '{}'", shown_word(line)),
              "extended XYZ begins with a line that holds it alone");
  }
  head.count = text.count(head.number, "the number of particles");
  head.body = text.at();
  return head;
}

// The head of the frame that is chosen; the text then stands behind its first line.
XyzHead find_frame(const ParticleFileChoice& choice, ParticleFile& file) {
  ParticleText& text = *file.text;
  std::vector<XyzHead> heads;
  const auto blank_to_end = [&] {
    return text.text().find_first_not_of(" \t\r\n", text.at()) == std::string_view::npos;
  };
  while (!text.ends() && !blank_to_end() && !(choice.frame && heads.size() > *choice.frame)) {
    heads.push_back(head_at(text, heads.empty() ? nullptr : &heads.back()));
    const XyzHead& head = heads.back();
    const uint64_t lines = text.skip_lines(head.count + 1);
    if (lines == head.count + 1 && head.count < UINT64_MAX) continue;
    text.fail(
        text.text().size(),
        fmt::format("the file ends behind {} of the {} particles of its frame {}", lines > 0 ? lines - 1 : 0,
                    head.count, heads.size() - 1),
        heads.size() > 1 ? fmt::format("frame = {} is the last one that is whole", heads.size() - 2) : "");
  }
  file.frames = heads.size();
  if (choice.frame && *choice.frame >= heads.size()) throw NoSuchFrame{heads.size()};
  const XyzHead head = choice.frame ? heads[*choice.frame] : heads.back();
  if (head.count == 0) text.fail(head.number, "the frame has no particle");
  text.seek(head.body);
  return head;
}

void read_rows(const XyzPlan& plan, uint64_t count, bool velocities, bool masses, bool ids,
               ParticleFile& file) {
  ParticleText& text = *file.text;
  constexpr const char* kWhat[] = {"the x of a particle",   "the y of a particle", "the z of a particle",
                                   "the x of a velocity",   "the y of a velocity", "the z of a velocity",
                                   "the mass of a particle"};
  file.x.reserve(count), file.at.reserve(count);
  if (velocities) file.v.reserve(count);
  ParticleKinds kinds(file);
  std::vector<uint64_t> id;
  for (uint64_t i = 0; i < count; ++i) {
    std::string_view line = text.line();
    std::array<double, 7> values{};
    size_t at = 0;
    for (size_t k = 0; k < plan.use.size(); ++k) {
      const std::string_view word = take_word(line);
      if (word.empty())
        text.fail(word,
                  fmt::format("column {} is missing, of '{}': a line has {} columns", k + 1, plan.name[k],
                              plan.use.size()),
                  fmt::format("the frame has {} particles, by its first line", count));
      const int8_t use = plan.use[k];
      if (use >= 0)
        values[static_cast<size_t>(use)] = text.number(word, kWhat[use]);
      else if (use == XyzPlan::kind)
        kinds.add(word);
      else if (use == XyzPlan::id)
        id.push_back(text.count(word, "the id of a particle"));
      if (use == 0) at = text.byte_of(word);
    }
    if (const std::string_view more = take_word(line); !more.empty())
      text.fail(more, fmt::format("a column too many: a line has {} columns", plan.use.size()),
                "'Properties' of the frame's second line names them");
    file.x.emplace_back(values[0], values[1], values[2]);
    file.at.push_back(at);
    if (velocities) file.v.emplace_back(values[3], values[4], values[5]);
    if (masses) {
      if (!(values[6] > 0)) text.fail(at, fmt::format("the mass of this particle is {:.6g}", values[6]));
      file.mass.push_back(values[6]);
    }
  }
  if (ids) order_particles(id, file);
}

}  // namespace

void read_xyz(const ParticleFileChoice& choice, ParticleFile& file) {
  const XyzHead head = find_frame(choice, file);
  ParticleText& text = *file.text;
  const std::string_view comment = text.line();
  const std::vector<XyzPart> parts = parts_of_comment(text, comment);
  const XyzPart* properties = find_part(parts, "Properties");
  const std::vector<XyzColumn> columns =
      columns_of(text, properties != nullptr ? properties->value : kPlainColumns);
  const XyzColumn* position = find_column(columns, {"pos"});
  if (position == nullptr) {
    std::vector<std::string> names;
    for (const XyzColumn& column : columns) names.push_back(shown_word(column.name));
    text.fail(properties->key, "Properties: no column 'pos:R:3'",
              names.empty() ? "" : fmt::format("there are {}", fmt::join(names, ", ")));
  }
  if (properties != nullptr) numbers_of(text, position, 3);
  const XyzColumn* velocity =
      numbers_of(text, find_column(columns, {"velo", "vel", "velocity", "velocities"}), 3);
  const XyzColumn* momenta = numbers_of(text, find_column(columns, {"momenta"}), 3);
  const XyzColumn* mass = numbers_of(text, find_column(columns, {"masses", "mass"}), 1);
  const XyzColumn* kind = find_column(columns, {"material", "species", "element", "type", "Z"});
  const XyzColumn* id = numbers_of(text, find_column(columns, {"id"}), 1, true);
  file.momenta = velocity == nullptr && momenta != nullptr;
  const XyzColumn* moves = velocity != nullptr ? velocity : momenta;
  if (const XyzPart* units = find_part(parts, "units")) {
    file.length_unit = unit_in(units->value, "pos");
    if (velocity != nullptr) file.velocity_unit = unit_in(units->value, velocity->name);
  }
  const XyzPart* lattice = find_part(parts, "Lattice");
  if (lattice != nullptr && choice.box) file.box = box_of_lattice(text, parts, *lattice);
  read_rows(plan_of_columns(columns, position, moves, mass, kind, id), head.count, moves != nullptr,
            mass != nullptr, id != nullptr, file);
}

}  // namespace cuboct
