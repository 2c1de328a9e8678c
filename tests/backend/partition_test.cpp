// SPDX-License-Identifier: MIT
// Ways to cut a machine into devices: kinds of link with their sources, lanes, latency; refusals word for
// word.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hw/plan/partition.h"
#include "model/base/error.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

// At 100 MHz a lane carries 4 data bits per cycle.
const std::string kLinks = R"([wires.lanes]
value = 96
unit = "1"
source = "a table"
[wires.pins]
value = 2
unit = "1"
source = "a table"
[wires.rate]
value = 500
unit = "Mbit/s"
source = "a table"
[wires.efficiency]
value = 0.8
unit = "1"
source = "8b10b"
[wires.delay]
value = 25
unit = "ns"
source = "assumed: a cable"
[wires.registers]
value = 2
unit = "cycles"
source = "a table"
)";
constexpr double kClock = 100e6;

DeviceLinkKind wires() { return parse_board_links(kLinks, "links.toml").at(0); }

// Its first line, without the hint.
template <typename Act>
std::string refusal(const Act& act) {
  try {
    act();
  } catch (const InputError& error) {
    return std::string(error.what()).substr(0, std::string(error.what()).find('\n'));
  }
  return "";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(BoardLinkKinds, AreReadWithTheirSources) {
  const DeviceLinkKind kind = wires();
  EXPECT_EQ(kind.name, "wires");
  EXPECT_EQ(kind.lanes(), 96u);
  EXPECT_DOUBLE_EQ(kind.bits_per_cycle(kClock), 4);
  // 25 ns are 2.5 cycles: 3; 2 of registers; a beat whose bits take 5 cycles ends 4 later.
  EXPECT_EQ(kind.latency(kClock, 1), 5);
  EXPECT_EQ(kind.latency(kClock, 5), 9);
  EXPECT_TRUE(kind.figures[static_cast<size_t>(LinkFigure::delay)].assumed());
  EXPECT_FALSE(kind.figures[static_cast<size_t>(LinkFigure::rate)].assumed());
}

TEST(BoardLinkKinds, RefusesWhatIsWrongWhereItStands) {
  const auto told = [](const std::string& text) {
    return refusal([&] { parse_board_links(text, "links.toml"); });
  };
  EXPECT_EQ(told(replaced(kLinks, "value = 500\nunit = \"Mbit/s\"\nsource = \"a table\"\n",
                          "value = 500\nunit = \"Mbit/s\"\n")),
            "links.toml:9:1: 'rate' has no source");
  EXPECT_EQ(told(replaced(kLinks, "source = \"8b10b\"", "source = \" \"")),
            "links.toml:16:10: the source of 'efficiency' is empty");
  EXPECT_EQ(told(replaced(kLinks, "\"Mbit/s\"", "\"Gbit/s\"")),
            "links.toml:11:8: 'rate' is in Mbit/s, not in 'Gbit/s'");
  EXPECT_EQ(told(replaced(kLinks, "[wires.pins]", "[wires.pin]")), "links.toml:5:1: unknown figure 'pin'");
}

TEST(Partition, HasTheShortestIntervalThatItsLanesAllow) {
  const Plan plan = make_case("hot_gas").setup.plan;
  const Cell grid = node_grid(plan);
  ASSERT_GE(std::min({grid[0], grid[1], grid[2]}), 4);
  const Partition p = partition_of(plan, wires(), kClock, {2, 2, 2});
  const auto beat = static_cast<double>(plan.words.link_bits + 2);
  uint64_t faces = 0;
  for (size_t a = 0; a < 3; ++a) {
    EXPECT_EQ(p.devices[a], (grid[a] + 1) / 2);
    EXPECT_EQ(p.links[a], 4);
    EXPECT_EQ(p.faces[a], p.devices[a] > 2 ? 2 : 1);
    faces += static_cast<uint64_t>(p.faces[a]);
  }
  const auto lanes = [&](int interval) {
    return 2 * faces * static_cast<uint64_t>(std::ceil(4 * beat / (4 * interval)));
  };
  EXPECT_EQ(p.lanes, lanes(p.boards.interval));
  EXPECT_LE(p.lanes, 96u);
  ASSERT_GT(p.boards.interval, 1);
  EXPECT_GT(lanes(p.boards.interval - 1), 96u);
  EXPECT_EQ(p.boards.latency, wires().latency(kClock, p.boards.interval));
}

TEST(Partition, FitsTheRoomAndComesByPowersOfTwo) {
  const Plan plan = make_case("hot_gas").setup.plan;
  const std::vector<Partition> found = partitions(plan, wires(), kClock, 20, 8);
  ASSERT_GT(found.size(), 2u);
  for (size_t k = 0; k < found.size(); ++k) {
    const Partition& p = found[k];
    EXPECT_LE(p.boards.nodes[0] * p.boards.nodes[1] * p.boards.nodes[2], 20);
    EXPECT_GE(p.count() * 20, plan.nodes());
    if (k > 0) {
      EXPECT_GT(p.count(), found[k - 1].count());
    }
  }
}

}  // namespace
}  // namespace cuboct::test
