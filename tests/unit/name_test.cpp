// SPDX-License-Identifier: MIT
// Names that would fail after a run, or break a frame, are refused where the scene is read.
#include <gtest/gtest.h>

#include "hw/arch/arch.h"
#include "model/base/error.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

std::string with_names(const std::string& material, const std::string& constraint, const std::string& probe) {
  return "density = \"1.41 g/cm^3\"\n[packing]\npitch = \"0.5 mm\"\n[box]\ncells = [3, 3, 3]\n[law]\nkind = "
         "\"elastic\"\n"
         "youngs_modulus = \"3 GPa\"\ndirection = [1, 0, 0]\n[run]\ndt = \"auto\"\nsteps = 1\n"
         "[regions.end]\nshape = \"half_space\"\nnormal = [1, 0, 0]\npoint = \"[0.1, 0, 0] mm\"\n"
         "[[material]]\nname = " +
         material + "\n[[constraint]]\nname = " + constraint +
         "\nkind = \"held\"\nregion = \"end\"\n[[probe]]\nname = " + probe +
         "\nkind = \"force\"\nregion = \"end\"\n";
}

std::string error_of(const std::string& material, const std::string& constraint, const std::string& probe) {
  return refused_with([&] { parse_scene(with_names(material, constraint, probe), "a.toml"); });
}

TEST(Name, OrdinaryOnesAreTaken) {
  EXPECT_EQ(error_of("\"soft steel, Typ 3µ\"", "\"grip_1\"", "\"pull (x)\""), "accepted");
}

TEST(Name, IsRefusedWhereItStands) {
  EXPECT_EQ(error_of("\"m\"", "\"c\"", "\"a/b\""),
            "a.toml:24:8: 'name' must not hold '/': 'a/b'\n  hint: such as 'a_b'");
  EXPECT_EQ(error_of("\"m\"", "\"a/b\"", "\"p\""),
            "a.toml:20:8: 'name' must not hold '/': 'a/b'\n  hint: such as 'a_b'");
  EXPECT_EQ(error_of("\"a/b\"", "\"c\"", "\"p\""),
            "a.toml:18:8: 'name' must not hold '/': 'a/b'\n  hint: such as 'a_b'");
  EXPECT_EQ(error_of("\"m\"", "\"c\"", "\"\""),
            "a.toml:24:8: 'name' must not be empty\n  hint: a name such as \"part_1\"");
  EXPECT_EQ(
      error_of("\"m\"", "\"c\"", "\".\""),
      "a.toml:24:8: 'name' must not be '.', which means a directory\n  hint: a name such as \"part_1\"");
  EXPECT_EQ(
      error_of("\"m\"", "\"..\"", "\"p\""),
      "a.toml:20:8: 'name' must not be '..', which means a directory\n  hint: a name such as \"part_1\"");
  EXPECT_EQ(error_of("\"soft\\nsteel\"", "\"c\"", "\"p\""),
            "a.toml:18:8: 'name' must hold visible characters alone: 'soft\\nsteel'\n"
            "  hint: no line ends, tabs or other control characters");
  EXPECT_EQ(error_of("\"m\"", "\"c\"", "\"p\\u001b[2J\""),
            "a.toml:24:8: 'name' must hold visible characters alone: 'p\\x1b[2J'\n"
            "  hint: no line ends, tabs or other control characters");
}

TEST(Name, OfAMachine) {
  EXPECT_EQ(parse_arch("name = \"small\"\n", "a.toml").name, "small");
  EXPECT_THROW(parse_arch("name = \"a\\nb\"\n", "a.toml"), InputError);
  EXPECT_THROW(parse_arch("name = \"\"\n", "a.toml"), InputError);
}

}  // namespace
}  // namespace cuboct
