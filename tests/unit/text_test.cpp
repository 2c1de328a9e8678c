// SPDX-License-Identifier: MIT
// Each escape against what its place would make of the text.
#include "model/base/text.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/config/config.h"
#include "tests/support/hostile.h"

namespace cuboct {
namespace {

using test::hostile_text, test::is_tame;

TEST(Text, LinesShowWhatTheyHide) {
  EXPECT_EQ(line_text("Zug, 5 µm: „ok“ 🙂"), "Zug, 5 µm: „ok“ 🙂");
  EXPECT_EQ(line_text("a\nb\tc\rd\x1b[2Je\x7f"), "a\\nb\\tc\\rd\\x1b[2Je\\x7f");
  EXPECT_EQ(line_text(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(line_text("\xc2\x9b"
                      "31m\xe2\x80\xae\xe2\x80\xa8\xf3\xa0\x81\x81"),
            "\\u009b31m\\u202e\\u2028\\U000e0041");
  // No UTF-8: a lone byte of the end of a symbol, an overlong '/', a surrogate, a cut symbol, one beyond
  // Unicode.
  EXPECT_EQ(line_text("\x9b\xc0\xaf\xed\xa0\x80\xe2\x82"), "\\x9b\\xc0\\xaf\\xed\\xa0\\x80\\xe2\\x82");
  EXPECT_EQ(line_text("\xf4\x90\x80\x80\xff"), "\\xf4\\x90\\x80\\x80\\xff");
  EXPECT_EQ(block_text("a\nb\x1b"), "a\nb\\x1b");
  EXPECT_FALSE(is_tame(hostile_text()));
  EXPECT_TRUE(is_tame(line_text(hostile_text())));
  EXPECT_EQ(line_text(hostile_text()).find('\n'), std::string::npos);
}

TEST(Text, HtmlHasNoTagsAndNoEndOfAnAttribute) {
  EXPECT_EQ(html_text("a<b>&\"c\"'d'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;d&#39;");
  EXPECT_EQ(html_text(hostile_text()).find_first_of("<>\"'\x1b\x07"), std::string::npos);
  EXPECT_EQ(html_text("a\n\tb"), "a\n\tb");
}

TEST(Text, JsonAndTomlReadBack) {
  const std::string text = hostile_text() + "🙂\xf3\xa0\x81\x81";
  EXPECT_EQ(nlohmann::json::parse(json_text(text)).get<std::string>(), text);
  EXPECT_TRUE(is_tame(json_text(text)));
  EXPECT_EQ(json_text(text).find('<'), std::string::npos);
  EXPECT_EQ(json_text("a\xff"), "\"a\\ufffd\"");
  EXPECT_EQ(parse_config("key = " + toml_string(text) + "\n", "a").at("key").string(), text);
  EXPECT_TRUE(is_tame(toml_string(text)));
}

// What gnuplot prints of a string, and what it does besides.
std::string by_gnuplot(const Scratch& scratch, const std::string& script) {
  write_text(scratch.path("script.gp"),
             fmt::format("set print {}\n{}", gnuplot_file(scratch.path("out")), script));
  EXPECT_EQ(Process("gnuplot", {"-d", scratch.path("script.gp")}, false, {"/dev/null", "/dev/null"}).wait(),
            0);
  std::ifstream in(scratch.path("out"), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Text, GnuplotTakesAStringForAString) {
  const Scratch scratch;
  EXPECT_EQ(gnuplot_text("it's"), "'it''s'");
  EXPECT_EQ(gnuplot_label("a_1"), "'a_1' noenhanced");
  EXPECT_EQ(by_gnuplot(scratch, "print " + gnuplot_text(hostile_text()) + "\n"),
            line_text(hostile_text()) + "\n");
  EXPECT_FALSE(test::take_loot());
}

TEST(Text, GnuplotOpensAFileAndNoPipe) {
  EXPECT_EQ(gnuplot_file("/a/it's"), "'/a/it''s'");
  EXPECT_EQ(gnuplot_file("| touch x"), "'./| touch x'");
  EXPECT_EQ(gnuplot_file("-"), "'./-'");
  EXPECT_THROW(gnuplot_file("a\nb"), InputError);
}

TEST(Text, AShellTakesAWordForAWord) {
  EXPECT_EQ(shell_word("out/a-1.toml"), "out/a-1.toml");
  EXPECT_EQ(shell_word(""), "''");
  for (const std::string& text :
       {hostile_text(), std::string("a b"), std::string("it's"), std::string("$x;`y`")}) {
    std::array<char, 4096> read{};
    FILE* pipe = popen(("printf %s " + shell_word(text)).c_str(), "r");
    const size_t size = fread(read.data(), 1, read.size(), pipe);
    EXPECT_EQ(pclose(pipe), 0);
    EXPECT_EQ(std::string(read.data(), size), text);
  }
  EXPECT_FALSE(test::take_loot());
}

TEST(Text, TclAndYosys) {
  EXPECT_EQ(tcl_word("/a/b.lib"), "/a/b.lib");
  EXPECT_EQ(tcl_word("a} ; exec touch x"), "a\\}\\ \\;\\ exec\\ touch\\ x");
  EXPECT_EQ(tcl_word("[exec x]$y\n"), "\\[exec\\ x\\]\\$y\\n");
  EXPECT_EQ(tcl_word(""), "{}");
  EXPECT_EQ(yosys_file("/a b/c.v"), "\"/a b/c.v\"");
  EXPECT_EQ(yosys_file("rtl/c.v"), "\"./rtl/c.v\"");
  for (const char* path :
       {"", "a\"; !touch x", "a\n!touch x", "*.v", "a;b", "a!b", "$(x)", "`x`", "a|b", "<<EOT"})
    EXPECT_THROW(yosys_file(path), InputError) << path;
}

TEST(Text, AWordOfXyzHasNoBlanks) {
  EXPECT_EQ(xyz_word("steel/grip"), "steel/grip");
  EXPECT_EQ(xyz_word("soft steel\tA\n1 2\x1b"), "soft_steel_A_1_2_");
  EXPECT_EQ(xyz_word("a\xc2\xa0"
                     "b\xe3\x80\x80"
                     "c\xe2\x80\x83"
                     "d\xc2\x85"
                     "e"),
            "a_b_c_d_e");
  EXPECT_EQ(xyz_word(""), "_");
}

TEST(Text, FileNamesHaveNoDirectories) {
  EXPECT_EQ(file_word("scene-run-dt_1"), "scene-run-dt_1");
  EXPECT_EQ(file_word("../a b"), "%2e%2e%2fa%20b");
  // No file system takes more than 255 bytes.
  const std::string end(300, 'x');
  EXPECT_EQ(file_word(end).size(), 80U);
  EXPECT_NE(file_word(end + "a"), file_word(end + "b"));
}

TEST(Text, ErrorsAreTwoLinesAtMost) {
  EXPECT_STREQ(InputError("a\nb\x1b[2J", "c\n  hint: d").what(), "a\\nb\\x1b[2J\n  hint: c\\n  hint: d");
  EXPECT_STREQ(InputError("a\nb", 1, 2, "c\n").what(), "a\\nb:1:2: c\\n");
}

}  // namespace
}  // namespace cuboct
