// SPDX-License-Identifier: MIT
#include "model/base/excerpt.h"

#include <gtest/gtest.h>

#include <string>

#include "model/base/error.h"
#include "model/config/config.h"

namespace cuboct {
namespace {

TEST(Excerpt, FindsLines) {
  const std::string text = "a\r\nbc\n\nd";
  EXPECT_EQ(line_of(text, 1), "a");
  EXPECT_EQ(line_of(text, 2), "bc");
  EXPECT_EQ(line_of(text, 3), "");
  EXPECT_EQ(line_of(text, 4), "d");
  EXPECT_EQ(line_of(text, 5), "");
  EXPECT_EQ(lines_of(text), (std::vector<std::string_view>{"a", "bc", "", "d"}));
  EXPECT_EQ(lines_of("a\n"), (std::vector<std::string_view>{"a", ""}));
}

TEST(Excerpt, PutsACaretUnderTheColumn) {
  EXPECT_EQ(excerpt("ab = 1", 3, 1), "   3 | ab = 1\n     | ^");
  EXPECT_EQ(excerpt("ab = 1", 12345, 6), "12345 | ab = 1\n      |      ^");
  EXPECT_EQ(excerpt("ab =", 3, 5), "   3 | ab =\n     |     ^");   // one beyond
  EXPECT_EQ(excerpt("ab =", 3, 99), "   3 | ab =\n     |     ^");  // where it would stand elsewhere
  EXPECT_EQ(excerpt("ab", 3, 0), "");
  EXPECT_EQ(excerpt("", 3, 1), "");
  EXPECT_EQ(excerpt(" \t", 3, 1), "");
}

// What is not ASCII: characters count, not bytes; what cannot be seen is told as elsewhere.
TEST(Excerpt, CountsCharacters) {
  EXPECT_EQ(excerpt("\t\tx = 1", 3, 3), "   3 |   x = 1\n     |   ^");
  EXPECT_EQ(excerpt("\xc3\xa4\xe2\x82\xac x", 3, 4), "   3 | \xc3\xa4\xe2\x82\xac x\n     |    ^");
  EXPECT_EQ(excerpt("\x1b[2Jx\xff y", 3, 7), "   3 | \\x1b[2Jx\\xff y\n     |             ^");
  EXPECT_EQ(excerpt("\xe2\x80\xae x", 3, 3), "   3 | \\u202e x\n     |        ^");
  EXPECT_EQ(characters("\xc3\xa4\xe2\x82\xac x"), 4);
}

TEST(Excerpt, CutsLongLinesAroundTheColumn) {
  const auto digits = [](int from, int to) {
    std::string text;
    for (int k = from; k < to; ++k) text += static_cast<char>('0' + k % 10);
    return text;
  };
  const std::string line = digits(0, 1000);
  EXPECT_EQ(excerpt(digits(0, 80), 1, 80),
            "   1 | " + digits(0, 80) + "\n     | " + std::string(79, ' ') + "^");
  EXPECT_EQ(excerpt(line, 1, 1), "   1 | " + digits(0, 80) + "...\n     | ^");
  // The 501st is a 0; fifty before it.
  EXPECT_EQ(excerpt(line, 1, 501),
            "   1 | ..." + digits(450, 530) + "...\n     | " + std::string(53, ' ') + "^");
  EXPECT_EQ(excerpt(line, 1, 1000),
            "   1 | ..." + digits(920, 1000) + "\n     | " + std::string(82, ' ') + "^");
  EXPECT_EQ(excerpt(line, 1, 1001),
            "   1 | ..." + digits(920, 1000) + "\n     | " + std::string(83, ' ') + "^");
}

std::string told(const std::string& text) {
  try {
    parse_config(text, "a.toml").at("node").table().at("capacity").integer(1, 4);
  } catch (const InputError& error) {
    return error.told();
  }
  return "";
}

TEST(Excerpt, StandsBetweenMessageAndHint) {
  EXPECT_EQ(told("[node]\n  capacity = 5\n"),
            "a.toml:2:14: 'capacity' must be between 1 and 4, not 5\n"
            "   2 |   capacity = 5\n"
            "     |              ^");
  EXPECT_EQ(told("[node]\ncapcity = 5\n"),
            "a.toml:2:1: unknown key 'capcity'\n"
            "   2 | capcity = 5\n"
            "     | ^\n"
            "  hint: did you mean 'capacity'?");
  // Of the whole file: no line would say more.
  EXPECT_EQ(told("# nothing\n"), "a.toml:1:1: missing key 'node'");
  const std::string wrong = told("\xc3\xa4 = = 1\n");
  EXPECT_TRUE(wrong.starts_with("a.toml:1:")) << wrong;
  EXPECT_TRUE(wrong.find("\n   1 | \xc3\xa4 = = 1\n     | ") != std::string::npos) << wrong;
  const InputError error("a.toml", 1, 2, "wrong", "a hint", "   1 | x\n     |  ^");
  EXPECT_STREQ(error.what(), "a.toml:1:2: wrong\n  hint: a hint");
  EXPECT_EQ(error.with("another").told(), "a.toml:1:2: wrong\n   1 | x\n     |  ^\n  hint: another");
  EXPECT_EQ(InputError("wrong", "a hint").told(), "wrong\n  hint: a hint");
  // Of a name of megabytes both ends of the message stay, cut between characters.
  std::string name;
  for (int k = 0; k < 500000; ++k) name += "ä";
  const std::string told = InputError("unknown key '" + name + "' here").told();
  EXPECT_LT(told.size(), 2000U);
  EXPECT_EQ(told.find("unknown key 'ä"), 0U);
  EXPECT_NE(told.find("ä ... (998220 bytes more) ... ä"), std::string::npos) << told;
  EXPECT_TRUE(told.ends_with("ä' here"));
  // Of bytes that are shown by four characters each as many fewer.
  EXPECT_LT(InputError("wrong", std::string(1800, '\0')).told().size(), 2000U);
}

}  // namespace
}  // namespace cuboct
