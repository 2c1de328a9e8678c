// SPDX-License-Identifier: MIT
// Technology files: what is wrong in one is told at its place; those of the tree are sound.
#include "hw/cost/technology.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "model/base/error.h"
#include "model/config/config.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const std::string kTechnologies = CUBOCT_SOURCE_DIR "/technologies";

std::string error_of(const std::string& text) {
  return refused_with([&] { parse_technology(text, "t.toml"); });
}

// A file of one constant, with these lines.
std::string of(const std::string& lines, const std::string& constant = "add_bit") {
  return "name = \"t\"\n[" + constant + "]\n" + lines;
}

constexpr const char* kGood = "low = 1\nhigh = 2\nunit = \"pJ/bit\"\nsource = \"a book\"\n";

TEST(Technology, ReadsABandWithItsSource) {
  const Technology t = parse_technology(of(kGood), "t.toml");
  const auto& figure = t.at(Constant::add_bit);
  ASSERT_TRUE(figure);
  EXPECT_EQ(figure->band, (Band{1, 2}));
  EXPECT_EQ(figure->source, "a book");
  EXPECT_FALSE(t.at(Constant::multiply_bit2));
}

TEST(Technology, RefusesEveryMistakeAtItsPlace) {
  EXPECT_EQ(error_of("[add_bit]\n"), "t.toml:1:1: missing key 'name'");
  EXPECT_EQ(error_of(of("low = 1\nhigh = 2\nunit = \"pJ/bit\"\n")),
            "t.toml:2:1: 'add_bit' has no source\n"
            "  hint: where low and high are published, or \"measured by\" which script");
  EXPECT_EQ(error_of(of("low = 1\nhigh = 2\nunit = \"pJ/bit\"\nsource = \" \"\n")),
            "t.toml:6:10: the source of 'add_bit' is empty\n"
            "  hint: where low and high are published, or \"measured by\" which script");
  EXPECT_EQ(
      error_of(of("low = 1\nhigh = 2\nunit = \"pJ/bit\"\nsource = \"" + std::string(200'000, '0') + "\"\n")),
      "t.toml:6:10: 'source' is a text of 200000 bytes: at most 4096 are read");
  EXPECT_EQ(error_of(of("low = 3\nhigh = 2\nunit = \"pJ/bit\"\nsource = \"a\"\n")),
            "t.toml:3:7: 'add_bit': low 3 is above high 2\n"
            "  hint: low is the least figure published or measured, high the greatest");
  EXPECT_EQ(error_of(of("high = 2\nunit = \"pJ/bit\"\nsource = \"a\"\n")),
            "t.toml:2:1: missing key 'low' in 'add_bit'");
  EXPECT_EQ(error_of(of("low = 1\nhigh = 2\nsource = \"a\"\n")),
            "t.toml:2:1: 'add_bit' has no unit\n  hint: unit = \"pJ/bit\"");
  EXPECT_EQ(error_of(of("low = 1\nhigh = 2\nunit = \"fJ/bit\"\nsource = \"a\"\n")),
            "t.toml:5:8: 'add_bit' is in pJ/bit, not in 'fJ/bit'\n  hint: convert low and high");
  EXPECT_EQ(error_of(of(kGood, "ad_bit")),
            "t.toml:2:1: unknown constant 'ad_bit'\n  hint: did you mean 'add_bit'?");
  EXPECT_EQ(error_of(of(std::string(kGood) + "words = 3\n")), "t.toml:7:1: unknown key 'words'");
  EXPECT_EQ(error_of(of("low = -1\nhigh = 2\nunit = \"pJ/bit\"\nsource = \"a\"\n"))
                .find("t.toml:3:7: 'low' must be"),
            0U);
  EXPECT_EQ(error_of(of("low = nan\nhigh = 2\nunit = \"pJ/bit\"\nsource = \"a\"\n")).find("t.toml:3:7: "),
            0U);
  EXPECT_EQ(error_of(of("low = 1\nhigh = inf\nunit = \"pJ/bit\"\nsource = \"a\"\n")).find("t.toml:4:8: "),
            0U);
  EXPECT_EQ(error_of("name = \"t\"\nadd_bit = 3\n"),
            "t.toml:2:11: 'add_bit' must be a table\n  hint: write [add_bit]");
}

TEST(Technology, AMemoryNeedsItsWordsAndAnExponent) {
  EXPECT_EQ(error_of(of(kGood, "memory_read")), "t.toml:2:1: missing key 'words' in 'memory_read'");
  EXPECT_EQ(error_of(of(std::string("words = 8\n") + kGood, "memory_read")),
            "t.toml:1:1: memory_read and memory_write need memory_exponent\n"
            "  hint: [memory_exponent]: energy of a bit goes with words to this power");
}

TEST(Technology, FilesOfTheTreeAreSound) {
  int files = 0, figures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kTechnologies)) {
    const std::string stem = entry.path().stem();
    if (stem == "links" || stem == "machines" || stem == "boards") continue;  // of other kinds
    const Technology t = read_technology(entry.path().string());
    EXPECT_EQ(t.name, entry.path().stem().string());
    EXPECT_FALSE(t.title.empty()) << t.name;
    ++files;
    for (const auto& figure : t.figures)
      if (figure) ++figures;
  }
  EXPECT_EQ(files, 5);
  EXPECT_GE(figures, 45);
  const auto links = parse_links(read_config_text(kTechnologies + "/links.toml"), "links.toml");
  ASSERT_EQ(links.size(), 4U);
  EXPECT_EQ(links[1].name, "ucie");
  EXPECT_EQ(links[1].figure.band, (Band{0.25, 0.5}));
}

TEST(Technology, ThePagesExampleIsRead) {
  const std::string page = read_config_text(CUBOCT_SOURCE_DIR "/docs/user/energy.md");
  const size_t begin = page.find("```toml\n") + 8, end = page.find("```", begin);
  ASSERT_LT(end, page.size());
  const Technology t = parse_technology(page.substr(begin, end - begin), "energy.md");
  EXPECT_EQ(t.name, "mine");
  EXPECT_TRUE(t.at(Constant::add_bit));
}

// Two published tables of one operation differ: no band of these is a point.
TEST(Technology, PublishedBandsAreBands) {
  for (const char* name : {"cmos45", "cmos7"}) {
    const Technology t = read_technology(kTechnologies + "/" + name + ".toml");
    for (size_t k = 0; k < kConstants; ++k) {
      if (!t.figures[k]) continue;
      EXPECT_LT(t.figures[k]->band.low, t.figures[k]->band.high) << name << " " << name_of(Constant(k));
    }
  }
}

}  // namespace
}  // namespace cuboct
