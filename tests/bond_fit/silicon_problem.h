// SPDX-License-Identifier: MIT
// Silicon as scenes/studies/silicon_fit.toml has it, small.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "study/potential_fit/bond_fit.h"
#include "tests/support/folder.h"

namespace cuboct::bond_fit::test {

inline const std::string kTarget =
    "[target]\nedge = \"5.429 angstrom\"\nenergy = \"-4.63 eV\"\nB = \"99 GPa\"\nCprime = \"51 GPa\"\n"
    "C11 = \"167 GPa\"\nC12 = \"65 GPa\"\nC44_clamped = \"106 GPa\"\nC44 = \"81 GPa\"\n";
inline const std::string kPotential = "[potential]\nR = \"2.85 angstrom\"\nD = \"0.15 angstrom\"\nm = 3\n";
// 216 atoms for a fifth of a picosecond.
inline const std::string kStability = "[stability]\nmass = \"28.0855 u\"\ncells = 3\ntime = \"0.2 ps\"\n";

class SiliconFit : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }
  std::string directory(const std::string& name) const {
    std::filesystem::create_directory(path(name));
    return path(name);
  }
  std::string file(const std::string& text) const {
    std::ofstream(path("study.toml")) << text;
    return path("study.toml");
  }
  // `fit`: of [fit]; `more`: further tables.
  std::string study(const std::string& fit, const std::string& more = {}) const {
    return file("[fit]\nkind = \"tersoff\"\n" + fit + kTarget + kPotential + kStability + more);
  }

 private:
  cuboct::test::Folder folder_;
};

}  // namespace cuboct::bond_fit::test
