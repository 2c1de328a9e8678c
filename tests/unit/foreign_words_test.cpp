// SPDX-License-Identifier: MIT
// Keys of other tools are told where they went; docs/user/limits.md has each of them.
#include <gtest/gtest.h>

#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "model/base/error.h"
#include "model/config/foreign_words.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

// A bar with `line` in `table`, or at the top of the file.
std::string refusal(const std::string& table, const std::string& line) {
  std::string text = table.empty() ? line + "\n" : "";
  for (const auto& [name, lines] : std::vector<std::pair<std::string, std::string>>{
           {"", "density = \"1 g/cm^3\"\n"},
           {"packing", "pitch = \"1 mm\"\n"},
           {"box", "cells = [3, 3, 3]\nperiodic = \"xyz\"\n"},
           {"law", "kind = \"elastic\"\nstiffness = \"1 kN/m\"\n"},
           {"run", "steps = 1\n"}})
    text += (name.empty() ? "" : "[" + name + "]\n") + lines +
            (name == table && !name.empty() ? line + "\n" : "");
  return refused_with([&] { parse_scene(text, "a.toml"); });
}

TEST(ForeignWords, AreToldWhereTheyWent) {
  const auto expect = [](const std::string& table, const std::string& line, const std::string& told) {
    EXPECT_EQ(refusal(table, line), told) << line;
  };
  expect("law", "poissons_ratio = 0.3",
         "a.toml:10:1: unknown key 'poissons_ratio'\n"
         "  hint: a pair law has the ratio that its packing makes; [rule] kind = \"lps\" takes any: "
         "docs/user/limits.md#forces");
  expect("run", "thermostat = \"nose_hoover\"",
         "a.toml:12:1: unknown key 'thermostat'\n"
         "  hint: pair laws have no thermostat; the rules scenes/rules/langevin.toml and dpd.toml hold a "
         "temperature: "
         "docs/user/limits.md#motion");
  expect("run", "timestep = \"1 us\"", "a.toml:12:1: unknown key 'timestep'\n  hint: the time step is 'dt'");
  expect("box", "erate = [1, 0, 0]",
         "a.toml:7:1: unknown key 'erate'\n"
         "  hint: deform = { strain_rate = ... } or deform = { final_strain = ... } changes the lengths");
  expect("box", "tilt = 1",
         "a.toml:7:1: unknown key 'tilt'\n"
         "  hint: lengths change at a constant engineering strain rate, and positions go with them: "
         "docs/user/limits.md#the-box");
  expect("", "barostat = true",
         "a.toml:1:1: unknown key 'barostat'\n"
         "  hint: no box follows a pressure; a traction on faces presses a body, 'deform' strains a box: "
         "docs/user/limits.md#the-box");
  // The key of a table counts as that of its first line.
  expect("run", "[thermostat]\nkind = \"bath\"",
         "a.toml:12:2: unknown key 'thermostat'\n"
         "  hint: pair laws have no thermostat; the rules scenes/rules/langevin.toml and dpd.toml hold a "
         "temperature: "
         "docs/user/limits.md#motion");
  expect("run", "nlist = \"cell\"",
         "a.toml:12:1: unknown key 'nlist'\n"
         "  hint: the engine chooses how it finds neighbours: nothing is to be set");
  expect("run", "[[fix]]\nkind = \"nve\"",
         "a.toml:12:3: unknown key 'fix'\n"
         "  hint: [[constraint]] holds and moves regions, [damping] damps: docs/user/coming-from.md");
  // In other tables a word means what it says, or nothing.
  expect("law", "timestep = \"1 us\"", "a.toml:10:1: unknown key 'timestep'");
  expect("packing", "omega = 3", "a.toml:4:1: unknown key 'omega'");
  // A misspelling is one.
  expect("run", "stesp = 1", "a.toml:12:1: unknown key 'stesp'");
  expect("run", "dt_saftey = 0.1", "a.toml:12:1: unknown key 'dt_saftey'\n  hint: did you mean 'dt_safety'?");
}

TEST(ForeignWords, KindsToo) {
  const auto of = [](const std::string& kind, const std::string& table) {
    return refused_with([&] {
      parse_scene("density = \"1 g/cm^3\"\npacking = { pitch = \"1 mm\" }\n[" + table + "]\nkind = \"" +
                      kind + "\"\n",
                  "a.toml");
    });
  };
  EXPECT_EQ(of("eam", "rule"),
            "a.toml:4:8: unknown rule 'eam'\n"
            "  hint: embedded atoms are a rule of text, as in scenes/rules/copper.toml: docs/user/rules.md");
  EXPECT_EQ(
      of("coulomb", "law"),
      "a.toml:4:8: unknown law 'coulomb'\n"
      "  hint: forces end at a cutoff; a rule of text has screened charges: docs/user/limits.md#charges");
  EXPECT_EQ(of("tersoff", "law"),
            "a.toml:4:8: unknown law 'tersoff'\n  hint: [rule] has this kind, in the place of [law]");
  EXPECT_EQ(refused_with([] { parse_scene("units = \"metal\"\n", "a.toml"); }),
            "a.toml:1:9: unknown units 'metal'\n"
            "  hint: \"SI\": values carry their units, as \"300 K\"; [particles] units are those of a file");
  EXPECT_EQ(of("elastik", "law"), "a.toml:4:8: unknown law 'elastik'\n  hint: did you mean 'elastic'?");
}

std::string page() {
  std::ifstream file(CUBOCT_SOURCE_DIR "/docs/user/limits.md");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// What stands beneath the heading of that anchor, up to the next one.
std::string section(const std::string& text, const std::string& anchor) {
  std::istringstream lines(text);
  std::string line, found;
  bool within = false;
  while (std::getline(lines, line)) {
    if (line.starts_with("#")) {
      std::string name = line.substr(line.find(' ') + 1);
      for (char& c : name) c = c == ' ' ? '-' : static_cast<char>(std::tolower(c));
      within = name == anchor;
    } else if (within) {
      found += line + "\n";
    }
  }
  return found;
}

std::vector<std::string> words_of(const ForeignWord& row) {
  std::istringstream words{std::string(row.words)};
  return {std::istream_iterator<std::string>(words), {}};
}

TEST(ForeignWords, EachStandsInItsSectionOfThePage) {
  const std::string text = page();
  int keys = 0;
  std::set<std::string> sections;
  for (const ForeignWord& row : foreign_keys()) {
    if (row.section.empty()) continue;
    const std::string within = section(text, std::string(row.section));
    EXPECT_FALSE(within.empty()) << row.section;
    sections.insert(std::string(row.section));
    for (const std::string& word : words_of(row)) {
      EXPECT_NE(within.find("`" + word + "`"), std::string::npos) << word << " is not in #" << row.section;
      ++keys;
    }
  }
  for (const ForeignWord& row : foreign_kinds())
    EXPECT_TRUE(row.section.empty() || !section(text, std::string(row.section)).empty()) << row.section;
  EXPECT_GT(keys, 50);
  EXPECT_EQ(sections.size(), 7U);
}

// Of tables and parentheses in text: every key that the page gives in parentheses gets its hint.
TEST(ForeignWords, ThePageNamesNoOthers) {
  std::set<std::string> known;
  for (const ForeignWord& row : foreign_keys())
    for (const std::string& word : words_of(row)) known.insert(word);
  // Parentheses that hold nothing but words in code.
  const std::regex list("\\(((?:`[a-z_]+`(?:,\\s+)?)+)\\)"), word("`([a-z_]+)`");
  const std::string text = page();
  int found = 0;
  for (std::sregex_iterator one(text.begin(), text.end(), list), end; one != end; ++one) {
    const std::string inside = (*one)[1];
    for (std::sregex_iterator w(inside.begin(), inside.end(), word); w != end; ++w, ++found)
      EXPECT_TRUE(known.contains((*w)[1])) << (*w)[1];
  }
  EXPECT_GT(found, 50);
}

// What is not there, why, and a link to what to take instead.
TEST(ForeignWords, EachRowOfThePageLeadsSomewhere) {
  std::istringstream lines(page());
  std::string line;
  int rows = 0;
  while (std::getline(lines, line)) {
    if (!line.starts_with("| ") || line.starts_with("| what")) continue;
    const size_t last = line.rfind(" | ");
    EXPECT_NE(line.find("](", last), std::string::npos) << line;
    EXPECT_NE(line.find(" | "), last) << line;
    ++rows;
  }
  EXPECT_GT(rows, 20);
}

}  // namespace
}  // namespace cuboct
