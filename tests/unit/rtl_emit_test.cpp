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
