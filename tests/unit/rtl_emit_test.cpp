// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_emit.h"
#include "hw/rtl/rtl_prefix.h"
#include "hw/rtl/rtl_template.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "model/base/output.h"
#include "tests/support/block.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

// A second emission clears what the first one left, and nothing outside its directory, whatever the list
// says.
TEST(RtlEmit, ClearsItsOwnFilesAlone) {
  const test::Folder folder;
  const fs::path& root = folder.path();
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
}

// One who reads a library's file reads what every project holds, whatever the project is made for.
TEST(RtlEmit, CopiesTheLibraryByteForByte) {
  Arch bricks;
  bricks.brick = {2, 1, 1};
  const Scene held = test::block_scene({.size = {2, 1, 1}, .held = true});
  const test::Folder folder;
  const fs::path library = fs::path(CUBOCT_SOURCE_DIR) / "rtl", root = folder.path("project");
  for (const Arch& arch : {Arch{}, bricks})
    for (const BoardChoice& board :
         {BoardChoice{}, BoardChoice{.name = "ulx3s"}, BoardChoice{.name = "icebreaker", .velocities = false},
          BoardChoice{.name = "", .bus = "axi4lite"},
          BoardChoice{.name = "", .velocities = false, .bus = "wishbone"}}) {
      const auto setup = make_setup(held, arch);
      emit_rtl(setup.plan, setup.initial, root.string(), {.board = board});
      std::vector<fs::path> folders{library / "lattice", library / "pipeline", library / "board",
                                    library / "bus", library / "board" / board.name};
      for (const auto& room : fs::directory_iterator(library / "lib")) folders.push_back(room);
      size_t copies = 0;
      for (const auto& entry : fs::recursive_directory_iterator(root)) {
        const fs::path name = entry.path().filename();
        for (const fs::path& folder : folders)
          if (!name.empty() && fs::is_regular_file(folder / name)) {
            EXPECT_EQ(read_text(entry.path()), read_text(folder / name)) << name;
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
      EXPECT_EQ(read_text(root / "rtl/cuboct_node.sv").find(".MovedTypes(0)") == std::string::npos, settable);
      fs::remove_all(root);
    }
}

// A prefix is in front of every name and of nothing else: taken off, it leaves what was emitted without.
TEST(RtlEmit, PrefixesEveryName) {
  const Scene held = test::block_scene({.size = {2, 1, 1}, .held = true});
  const auto setup = make_setup(held, Arch{});
  const test::Folder folder;
  const fs::path& root = folder.path();
  for (const BoardChoice& board :
       {BoardChoice{.name = "ulx3s"}, BoardChoice{.name = "", .bus = "axi4lite"}}) {
    emit_rtl(setup.plan, setup.initial, root / "plain", {.board = board, .arch = "name = \"cuboct_x\"\n"});
    emit_rtl(setup.plan, setup.initial, root / "left",
             {.board = board, .prefix = "left", .arch = "name = \"cuboct_x\"\n"});
    size_t modules = 0, memories = 0, files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root / "left")) {
      if (!entry.is_regular_file() || entry.path().filename() == ".cuboct-emit") continue;
      ++files;
      const fs::path path = fs::relative(entry.path(), root / "left");
      const std::string name = path.filename(), text = read_text(entry.path());
      const bool memory = path.extension() == ".hex";
      const std::string plain =
          memory ? name.substr(std::string("left_").size()) : without_prefix(name, "left_");
      EXPECT_TRUE((path.extension() != ".sv" && !memory) || name.starts_with("left_")) << path;
      modules += path.extension() == ".sv";
      memories += memory;
      std::string same = without_prefix(text, "left_");
      if (name == "left_cuboct_bench.sv")
        for (size_t at; (at = same.find("\"left_")) != std::string::npos;) same.erase(at + 1, 5);
      EXPECT_EQ(same, read_text(root / "plain" / path.parent_path() / plain)) << path;
      // No name is left without; "cuboct_" in a longer word is part of a name with the prefix.
      if (name == "arch.toml") continue;
      for (size_t at = text.find("cuboct_"); at != std::string::npos; at = text.find("cuboct_", at + 1))
        EXPECT_TRUE(at >= 5 && text.compare(at - 5, 5, "left_") == 0) << path << ": " << text.substr(at, 30);
    }
    EXPECT_GE(modules, 40u);
    EXPECT_EQ(memories, 3u);
    size_t others = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root / "plain"))
      others += entry.is_regular_file();
    EXPECT_EQ(files + 1, others);
    fs::remove_all(root);
  }
  for (const char* name : {"", "2x", "a-b", "a b", "a.b", "_a", "\xc3\xa4",
                           "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyzabcdefghijklm"})
    EXPECT_THROW(check_prefix(name), InputError) << name;
  for (const char* name : {"a", "Left_2", "cuboct"}) EXPECT_NO_THROW(check_prefix(name)) << name;
  EXPECT_EQ(prefix_of({"rtl/left_cuboct_pkg.sv", "rtl/left_cuboct_lattice.sv"}), "left_");
  EXPECT_EQ(prefix_of({"rtl/cuboct_lattice.sv"}), "");
}

// A place of a template that nothing fills would reach a user's project.
TEST(RtlTemplate, LeavesNoPlaceUnfilled) {
  EXPECT_EQ(fill("@A@ always_ff @(posedge clk_i) a@b @B_C@@A@", {{"A", "1"}, {"B_C", "@A@"}, {"D", "4"}}),
            "1 always_ff @(posedge clk_i) a@b @A@1");
  EXPECT_EQ(fill("", {}), "");
  EXPECT_EQ(refused_with<std::logic_error>([&] {
              fill("x @NODES@", {{"NODE", "1"}});
            }),
            "nothing fills @NODES@");
}

}  // namespace
}  // namespace cuboct
