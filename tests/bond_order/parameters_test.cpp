// SPDX-License-Identifier: MIT
// Files of LAMMPS and sets by name, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "model/base/error.h"
#include "model/bond_order/tersoff_parameters.h"

namespace cuboct {
namespace {

TEST(Tersoff, KnowsItsSets) {
  for (const std::string& name : tersoff_set_names()) EXPECT_GT(tersoff_set(name).cutoff(), 2) << name;
  try {
    tersoff_set("si_1898");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "no set of Tersoff parameters is called 'si_1898'\n  hint: did you mean 'si_1988'?");
  }
}

TEST(Tersoff, TakesOtherUnits) {
  const Tersoff set = tersoff_set("si_1988"), other = set.scaled(2, 10);
  EXPECT_EQ(other.terms[0].A, 2 * set.terms[0].A);
  EXPECT_DOUBLE_EQ(other.cutoff(), 10 * set.cutoff());
  EXPECT_DOUBLE_EQ(other.terms[0].lambda3, set.terms[0].lambda3 / 10);
}

TEST(Tersoff, ReadsFilesOfLammps) {
  const std::string path = testing::TempDir() + "cuboct_tersoff_test.tersoff";
  const auto with = [&](const std::string& text) {
    std::ofstream(path) << text;
    try {
      return fmt::format("{}", read_tersoff(path, {"Si"}).terms[0].A);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(error.place() ? path.size() : 0);
    }
  };
  const std::string entry = "Si Si Si 3.0 1.0 1.3258 4.8381 2.0417 0.0 22.956\n 0.33675 1.3258 95.373 3.0 ";
  EXPECT_EQ(with("# a comment\n" + entry + "0.2 3.2394 3264.7 # A\n"), "3264.7");
  EXPECT_EQ(with("C C C " + entry.substr(9) + "0.2 3.2394 1\n" + entry + "0.2 3.2394 3264.7"), "3264.7");
  EXPECT_EQ(with(entry + "0.2 3.2394"),
            ":1:1: the last entry has 16 words, not 17\n  hint: an entry has three elements and 14 numbers");
  EXPECT_EQ(with("\n" + entry + "-0.2 3.2394 3264.7"), ":2:1: D is -0.2, which must be positive");
  EXPECT_EQ(
      with(entry + "0.2 x 3264.7"),
      ":2:32: expected the number lambda1, got 'x'\n  hint: an entry has three elements and 14 numbers");
  EXPECT_EQ(with("# none\n"), path + " has no entry for Si Si Si");
}

}  // namespace
}  // namespace cuboct
