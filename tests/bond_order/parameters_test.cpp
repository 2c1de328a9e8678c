// SPDX-License-Identifier: MIT
// Files of LAMMPS and sets by name, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "model/atoms/bond_order/tersoff_parameters.h"
#include "model/base/error.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

TEST(Tersoff, KnowsItsSets) {
  for (const std::string& name : tersoff_set_names()) EXPECT_GT(tersoff_set(name).cutoff(), 2) << name;
  EXPECT_EQ(refused_with([&] { tersoff_set("si_1898"); }),
            "no set of Tersoff parameters is called 'si_1898'\n  hint: did you mean 'si_1988'?");
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

// LAMMPS's tag. 1 kcal/mol is 4184 J over Avogadro's number: 75286.4 of them are 3264.72 eV.
TEST(Tersoff, ObeysTheUnitsThatAFileStates) {
  const std::string path = testing::TempDir() + "cuboct_tersoff_units.tersoff";
  const auto with = [&](const std::string& before, const std::string& b = "95.373",
                        const std::string& a = "3264.7") {
    std::ofstream(path) << before
                        << "Si Si Si 3.0 1.0 1.3258 4.8381 2.0417 0.0 22.956 0.33675 1.3258 " + b +
                               " 3.0 0.2 3.2394 " + a + "\n";
    return read_tersoff(path, {"Si"}).terms[0];
  };
  const TersoffTerm<double> metal = with("");
  for (const char* said :
       {"# DATE: 2007-10-25 UNITS: metal CONTRIBUTOR: none\n", "# of A\n# UNITS: metal\n"}) {
    EXPECT_EQ(with(said).A, metal.A) << said;
    EXPECT_EQ(with(said).B, metal.B) << said;
  }
  constexpr double kUnit = 4184 / 6.02214076e23 / 1.602176634e-19;
  for (const char* said :
       {"# DATE: 2007-10-25 UNITS: real CITATION: none\n", "# silicon\n\n# UNITS: real\n"}) {
    const TersoffTerm<double> real = with(said, "2199.35", "75286.4");
    EXPECT_NEAR(real.A, 75286.4 * kUnit, 1e-9) << said;
    EXPECT_NEAR(real.B, 2199.35 * kUnit, 1e-11) << said;
    EXPECT_NEAR(real.A, metal.A, 0.03) << said;
    EXPECT_EQ(real.R, metal.R);
    EXPECT_EQ(real.D, metal.D);
    EXPECT_EQ(real.lambda1, metal.lambda1);
    EXPECT_EQ(real.lambda2, metal.lambda2);
    EXPECT_EQ(real.lambda3, metal.lambda3);
  }
  const auto refused = [&](const std::string& before, const std::string& place, const std::string& what) {
    try {
      with(before);
      ADD_FAILURE() << before;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(path + place + what)) << error.what();
    }
  };
  refused("# UNITS: electron\n",
          ":1:10: ", "parameters in units 'electron' are not read\n  hint: 'UNITS: metal'");
  refused("# UNITS:\n", ":1:3: ", "'UNITS:' names no units\n");
  refused("# UNITS: metal\n# UNITS: real\n", ":2:10: ", "units 'real', but line 1 says 'metal'");
  std::remove(path.c_str());
}

}  // namespace
}  // namespace cuboct
