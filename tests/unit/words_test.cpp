// SPDX-License-Identifier: MIT
// docs/reference/node.md and links.md tell the words and the ports that the generator has.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "hw/arch/words.h"
#include "hw/rtl/rtl_ports.h"
#include "tests/support/block.h"

namespace cuboct {
namespace {

using Row = std::vector<std::string>;

// Of the table that follows `before` on a page: its rows, without the head; backticks are dropped.
std::vector<Row> table_after(const std::string& page, const std::string& before) {
  std::ifstream in(std::string(CUBOCT_SOURCE_DIR) + "/docs/reference/" + page);
  std::string line;
  while (std::getline(in, line) && !line.starts_with(before)) {
  }
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    if (!line.starts_with("|")) {
      if (!rows.empty()) break;
      continue;
    }
    std::istringstream cells(std::regex_replace(line.substr(1), std::regex("`"), ""));
    Row row;
    for (std::string cell; std::getline(cells, cell, '|');)
      row.push_back(std::regex_replace(cell, std::regex("^ +| +$"), ""));
    rows.push_back(row);
  }
  if (rows.size() < 3) throw std::runtime_error(page + ": no table after '" + before + "'");
  rows.erase(rows.begin(), rows.begin() + 2);
  return rows;
}

// "x_y 20+8 signed" for each field that the table says a plan has.
std::vector<std::string> told(const Plan& plan, const std::vector<Row>& rows) {
  const Widths& w = plan.rule.widths;
  const std::map<std::string, int> bits{{"P", w.position_frac},
                                        {"P + 2", w.position_frac + 2},
                                        {"2", 2},
                                        {"G", w.guard},
                                        {"velocity_bits", w.velocity_bits},
                                        {"displacement_bits", w.displacement_bits},
                                        {"type_bits", plan.rule.type_bits},
                                        {"id_bits", plan.words.id_bits},
                                        {"halo_cell_bits", plan.words.halo_cell_bits}};
  const std::map<std::string, bool> there{{"always", true},
                                          {"with more than one type", plan.rule.types.size() > 1},
                                          {"with types held by force", plan.rule.pd},
                                          {"with pair scales", plan.rule.scaled},
                                          {"with damping", plan.rule.damped},
                                          {"with bricks", !plan.bricks.one_cell()}};
  const int axes = plan.rule.axes;
  const std::map<std::string, std::pair<int, int>> range{{"", {-1, 0}},
                                                         {"all", {0, axes}},
                                                         {"all but the first", {1, axes}},
                                                         {"all but the last", {0, axes - 1}},
                                                         {"the last", {axes - 1, axes}}};
  std::vector<std::string> fields;
  int lsb = 0;
  for (const Row& row : rows) {
    const auto [first, end] = range.at(row.at(1));
    const int width = bits.at(row.at(2));
    for (int a = first; a < end && there.at(row.at(4)); ++a) {
      const std::string axis = a < 0 ? "" : std::string("_") + "xyz"[a];
      fields.push_back(
          fmt::format("{}{} {}+{}{}", row.at(0), axis, lsb, width, row.at(3) == "yes" ? " signed" : ""));
      lsb += width;
    }
  }
  return fields;
}

std::vector<std::string> held(const WordLayout& word) {
  std::vector<std::string> fields;
  for (const WordField& f : word)
    fields.push_back(fmt::format("{} {}+{}{}", name_of(f), f.lsb, f.bits, f.is_signed ? " signed" : ""));
  return fields;
}

TEST(Words, AreThoseOfThePage) {
  const std::vector<Row> particle = table_after("node.md", "The particle, of"),
                         cell = table_after("node.md", "The halo record of a node"),
                         brick = table_after("node.md", "The halo record of a brick");
  Arch bricks;
  bricks.brick = {2, 1, 1};
  for (const bool flat : {false, true})
    for (const bool rich : {false, true})
      for (const Arch& arch : {Arch{}, bricks}) {
        test::Features features{.size = {4, 3, flat ? 1 : 3}, .flat = flat};
        if (rich) features.damping = 0.1, features.two_materials = features.force_held = true;
        const Plan plan = make_setup(test::block_scene(features), arch).plan;
        const bool one = plan.bricks.one_cell();
        ASSERT_EQ(plan.rule.axes, flat ? 2 : 3);
        ASSERT_EQ(plan.rule.pd && plan.rule.damped && plan.rule.scaled, rich);
        EXPECT_EQ(held(plan.words.particle), told(plan, particle));
        EXPECT_EQ(held(plan.words.halo), told(plan, one ? cell : brick));
      }
}

std::set<std::string> names(const std::vector<RtlPort>& ports) {
  std::set<std::string> set;
  for (const RtlPort& p : ports) set.insert(p.name);
  return set;
}

std::set<std::string> names(const std::vector<Row>& rows) {
  std::set<std::string> set;
  for (const Row& row : rows) {
    std::istringstream cell(std::regex_replace(row.at(0), std::regex(","), ""));
    for (std::string name; cell >> name;) set.insert(name);
  }
  return set;
}

TEST(RtlPorts, AreThoseOfThePages) {
  const Scene scene = test::block_scene({.size = {2, 2, 2}});
  Arch arch;
  const std::set<std::string> plain = names(node_ports(decide(make_setup(scene, arch).plan), false));
  EXPECT_EQ(plain, names(table_after("node.md", "## Ports of a node")));
  arch.link_check = LinkCheck::retry;
  std::set<std::string> checked = plain;
  checked.merge(names(table_after("links.md", "## Ports")));
  EXPECT_EQ(names(node_ports(decide(make_setup(scene, arch).plan), false)), checked);
  EXPECT_EQ(names(node_ports(decide(make_setup(scene, arch).plan), true)), plain);
}

}  // namespace
}  // namespace cuboct
