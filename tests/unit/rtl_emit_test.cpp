// SPDX-License-Identifier: MIT
#include "hw/rtl_emit.h"
#include "hw/rtl_template.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/block.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

// A second emission clears what the first one left, and nothing outside its directory, whatever the list
// says.
TEST(RtlEmit, ClearsItsOwnFilesAlone) {
  const fs::path root = fs::temp_directory_path() / ("cuboct-emit-" + std::to_string(getpid()));
  const std::string project = (root / "project").string();
  const auto setup = test::block({.size = {1, 1, 1}});
  emit_node(setup.plan, project);
  const fs::path marker = root / "project" / ".cuboct-emit", stale = root / "project" / "rtl" / "stale.sv",
                 precious = root / "precious";
  ASSERT_TRUE(fs::exists(marker));
  for (const fs::path& path : {stale, precious}) std::ofstream(path) << "kept?";
  std::ofstream(marker, std::ios::app) << "rtl/stale.sv\n../precious\n" << precious.string() << "\n";
  emit_node(setup.plan, project);
  EXPECT_FALSE(fs::exists(stale));
  EXPECT_TRUE(fs::exists(precious));
  fs::remove_all(root);
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// One who reads a library's file reads what every project holds, whatever the project is made for.
TEST(RtlEmit, CopiesTheLibraryByteForByte) {
  Arch bricks;
  bricks.brick = {2, 1, 1};
  const Scene held = test::block_scene({.size = {2, 1, 1}, .held = true});
  const fs::path library = fs::path(CUBOCT_SOURCE_DIR) / "rtl",
                 root = fs::temp_directory_path() / ("cuboct-emit-copies-" + std::to_string(getpid()));
  for (const Arch& arch : {Arch{}, bricks})
    for (const BoardChoice& board :
         {BoardChoice{}, BoardChoice{.name = "ulx3s"}, BoardChoice{.name = "icebreaker", .velocities = false},
          BoardChoice{.name = "", .bus = "axi4lite"},
          BoardChoice{.name = "", .velocities = false, .bus = "wishbone"}}) {
      const auto setup = make_setup(held, arch);
      emit_rtl(setup.plan, setup.initial, root.string(), 1, board);
      size_t copies = 0;
      for (const auto& entry : fs::recursive_directory_iterator(root)) {
        const fs::path name = entry.path().filename();
        for (const fs::path& folder : {library / "lib", library / "lattice", library / "board",
                                       library / "bus", library / "board" / board.name})
          if (!name.empty() && fs::is_regular_file(folder / name)) {
            EXPECT_EQ(text_of(entry.path()), text_of(folder / name)) << name;
            ++copies;
          }
      }
      const bool host = !board.name.empty() || !board.bus.empty();
      EXPECT_GE(copies, host ? 38u : 30u);
      EXPECT_EQ(fs::exists(root / "bus/cuboct_axi4lite.sv"), board.bus == "axi4lite");
      EXPECT_EQ(fs::exists(root / "bus/cuboct_wishbone.sv"), board.bus == "wishbone");
      const bool brick = arch.brick[0] > 1, settable = host && board.velocities;
      EXPECT_EQ(fs::exists(root / "rtl/cuboct_brick_core.sv"), brick);
      EXPECT_EQ(fs::exists(root / "rtl/cuboct_node_core.sv"), !brick);
      EXPECT_EQ(text_of(root / "rtl/cuboct_node.sv").find(".MovedTypes(0)") == std::string::npos, settable);
      fs::remove_all(root);
    }
}

// A place of a template that nothing fills would reach a user's project.
TEST(RtlTemplate, LeavesNoPlaceUnfilled) {
  EXPECT_EQ(fill("@A@ always_ff @(posedge clk_i) a@b @B_C@@A@", {{"A", "1"}, {"B_C", "@A@"}, {"D", "4"}}),
            "1 always_ff @(posedge clk_i) a@b @A@1");
  EXPECT_EQ(fill("", {}), "");
  try {
    fill("x @NODES@", {{"NODE", "1"}});
    FAIL();
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "nothing fills @NODES@");
  }
}

}  // namespace
}  // namespace cuboct
