// SPDX-License-Identifier: MIT
#include "model/config/changes.h"

#include <gtest/gtest.h>

#include "model/base/error.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const std::string kText =
    "# Größe: a comment with more bytes than characters\n"
    "title = \"a = b # c\"  # said so\n"
    "list = [1, 2,\n"
    "  3]  # over lines\n"
    "\n"
    "[run]  # time\n"
    "dt = \"0.5 µs\"   # short\n"
    "steps = 10\n"
    "regions = { top = { shape = \"box\", size = [1, 2, 3] }, none = {} }\n"
    "\n"
    "[[constraint]]\n"
    "name = \"a\"\n"
    "[[constraint]]\n"
    "name = \"b\"\n"
    "kp = 1.5";

std::string changed(const std::vector<Change>& changes) { return with_changes(kText, "a.toml", changes); }

// What `changes` turn the text into: the one place where `from` stands replaced by `to`.
void expect_replaced(const std::vector<Change>& changes, const std::string& from, const std::string& to) {
  std::string expected = kText;
  const size_t at = expected.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  ASSERT_EQ(expected.find(from, at + 1), std::string::npos) << from;
  expected.replace(at, from.size(), to);
  EXPECT_EQ(changed(changes), expected);
}

TEST(Changes, ReplaceAValueAndNothingElse) {
  expect_replaced({{"title", "\"x\""}}, "\"a = b # c\"", "\"x\"");
  expect_replaced({{"list", "[4]"}}, "[1, 2,\n  3]", "[4]");
  expect_replaced({{"list.1", "7"}}, "[1, 2,\n", "[1, 7,\n");
  expect_replaced({{"run.dt", "\"auto\""}}, "\"0.5 µs\"", "\"auto\"");
  expect_replaced({{"run.steps", "200"}}, "10", "200");
  expect_replaced({{"run.regions.top.shape", "\"ball\""}}, "\"box\"", "\"ball\"");
  expect_replaced({{"run.regions.top.size", "3"}}, "[1, 2, 3]", "3");
  expect_replaced({{"constraint.1.kp", "2"}}, "1.5", "2");
  expect_replaced({{"constraint.0.name", "\"c\""}}, "\"a\"\n", "\"c\"\n");
}

TEST(Changes, AddWhatIsMissing) {
  expect_replaced({{"units", "\"SI\""}}, "title =", "units = \"SI\"\ntitle =");
  expect_replaced({{"run.dt_safety", "0.1"}}, "[run]  # time\n", "[run]  # time\ndt_safety = 0.1\n");
  expect_replaced({{"run.regions.top.centre", "0"}}, "[1, 2, 3] }, none", "[1, 2, 3] , centre = 0 }, none");
  expect_replaced({{"run.regions.none.a", "1"}}, "none = {}", "none = { a = 1 }");
  expect_replaced({{"constraint.0.kp", "2"}}, "[[constraint]]\nname = \"a\"",
                  "[[constraint]]\nkp = 2\nname = \"a\"");
  EXPECT_EQ(changed({{"damping.ratio", "0.1"}}), kText + "\n\n[damping]\nratio = 0.1\n");
  EXPECT_EQ(with_changes("", "a.toml", {{"widths.guard", "6"}}), "\n[widths]\nguard = 6\n");
  EXPECT_EQ(with_changes("[run]", "a.toml", {{"run.steps", "6"}}), "[run]\nsteps = 6\n");
}

TEST(Changes, WholePathsAreOfTheFirstDirectory) {
  EXPECT_EQ(
      with_whole_paths(
          "[rule]\nfile = \"texts/heat.toml\"  # ours\n[[tie]]\nfile = \"/there/a.csv\"\n[[tie]]\n"
          "file = \"../b.csv\"\nname = \"file\"\n",
          "/scenes/rules/heat.toml"),
      "[rule]\nfile = \"/scenes/rules/texts/heat.toml\"  # ours\n[[tie]]\nfile = \"/there/a.csv\"\n[[tie]]\n"
      "file = \"/scenes/b.csv\"\nname = \"file\"\n");
}

TEST(Changes, TakeOut) {
  expect_replaced({{"run.dt", ""}}, "dt = \"0.5 µs\"   # short\n", "");
  EXPECT_EQ(changed({{"run.nothing", ""}, {"nowhere.at", ""}}), kText);
}

TEST(Changes, TakeOutOfInlineTables) {
  const auto taken = [](const std::string& text, const std::string& key) {
    return with_changes(text, "a.toml", {{key, ""}});
  };
  const std::string rule = "rule = { file = \"a\", start = { T = 1, q = \"{,\" }, start2.T = 3 } # x\n";
  EXPECT_EQ(taken(rule, "rule.start.T"),
            "rule = { file = \"a\", start = { q = \"{,\" }, start2.T = 3 } # x\n");
  EXPECT_EQ(taken(rule, "rule.start.q"), "rule = { file = \"a\", start = { T = 1 }, start2.T = 3 } # x\n");
  EXPECT_EQ(taken(rule, "rule.start2.T"), "rule = { file = \"a\", start = { T = 1, q = \"{,\" } } # x\n");
  EXPECT_EQ(taken(rule, "rule.file"), "rule = { start = { T = 1, q = \"{,\" }, start2.T = 3 } # x\n");
  EXPECT_EQ(taken("a = [{ b = 1 }, { b = 2 }]\n", "a.1.b"), "a = [{ b = 1 }, { }]\n");
}

TEST(Changes, ComeOneAfterTheOther) {
  EXPECT_EQ(with_changes("a = 1\n", "a.toml", {{"b.c", "1"}, {"b.c", "22"}, {"b.d", "3"}, {"a", ""}}),
            "\n[b]\nd = 3\nc = 22\n");
}

void expect_error(const std::vector<Change>& changes, const std::string& text) {
  EXPECT_EQ(refused_with([&] { changed(changes); }), text);
}

TEST(Changes, RefuseWhatMakesNoSense) {
  expect_error({{"run.dt", "1 2"}}, "a.toml: 'run.dt' cannot become 1 2: that is no TOML value");
  expect_error({{"run.dt", "1\nsteps = 2"}},
               "a.toml: 'run.dt' cannot become 1\\nsteps = 2: that is no TOML value");
  expect_error({{"run.dt.x", "1"}}, "a.toml: 'run.dt.x' runs through a value that is no table");
  expect_error({{"constraint.2.kp", "1"}},
               "a.toml: 'constraint.2.kp': there are 2 of these, counted from 0, and no '2'");
  EXPECT_THROW(with_changes("a = ", "a.toml", {}), InputError);
}

}  // namespace
}  // namespace cuboct
