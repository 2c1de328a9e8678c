// SPDX-License-Identifier: MIT
// What is kept of a flow, and what its stages say.
#include <gtest/gtest.h>

#include <filesystem>

#include "model/base/output.h"
#include "model/base/process.h"
#include "synth/kept_files.h"
#include "synth/stages.h"

namespace cuboct::synth {
namespace {

namespace fs = std::filesystem;

class Kept : public ::testing::Test {
 protected:
  // An entry of one file with this text.
  void keep(const KeptFiles& kept, const std::string& key, const std::string& text) const {
    write_text(from_ + "/netlist", text);
    kept.keep(key, from_, {"netlist"});
  }
  // What comes back under a key; "none" where nothing does.
  std::string taken(const KeptFiles& kept, const std::string& key) const {
    fs::remove(to_ + "/netlist");
    if (kept.take(key, to_)) return read_text(to_ + "/netlist");
    EXPECT_FALSE(fs::exists(to_ + "/netlist"));
    return "none";
  }

  Scratch scratch_;
  std::string from_ = scratch_.path("from"), to_ = scratch_.path("to"), store_ = scratch_.path("store");

  void SetUp() override {
    make_directory(from_);
    make_directory(to_);
  }
};

TEST_F(Kept, FilesComeBackUnderTheirKeyAlone) {
  const KeptFiles kept(store_);
  EXPECT_EQ(taken(kept, "a"), "none");
  keep(kept, "a", "gates");
  keep(kept, "b", "");
  EXPECT_EQ(taken(kept, "a"), "gates");
  EXPECT_EQ(taken(kept, "b"), "");
  EXPECT_EQ(taken(kept, "c"), "none");
  keep(kept, "a", "other");
  EXPECT_EQ(taken(kept, "a"), "other");
}

// A disk that was full, a machine that lost its power.
TEST_F(Kept, AnEntryThatIsNotWholeIsNone) {
  const KeptFiles kept(store_);
  keep(kept, "a", "gates");
  fs::resize_file(store_ + "/a/netlist", 3);
  EXPECT_EQ(taken(kept, "a"), "none");
  keep(kept, "a", "gates");
  EXPECT_EQ(taken(kept, "a"), "gates");
  fs::remove(store_ + "/a/netlist");
  EXPECT_EQ(taken(kept, "a"), "none");
  keep(kept, "a", "gates");
  write_text(store_ + "/a/kept.json", "{");
  EXPECT_EQ(taken(kept, "a"), "none");
}

TEST_F(Kept, WhatCannotBeKeptIsNone) {
  const KeptFiles nowhere("");
  keep(nowhere, "a", "gates");
  EXPECT_EQ(taken(nowhere, "a"), "none");
  write_text(store_, "a file");
  const KeptFiles kept(store_);
  keep(kept, "a", "gates");
  EXPECT_EQ(taken(kept, "a"), "none");
  const KeptFiles good(scratch_.path("good"));
  good.keep("a", from_, {"netlist", "not there"});
  EXPECT_EQ(taken(good, "a"), "none");
  EXPECT_TRUE(fs::is_empty(good.directory()));
}

// Three entries of a thousand bytes where two have room: the one goes that was asked for the longest ago.
TEST_F(Kept, TheLeastUsedGoesFirst) {
  const KeptFiles kept(store_, 2500);
  const std::string text(1000, 'x');
  keep(kept, "a", text);
  keep(kept, "b", text);
  const auto hours_ago = [&](const std::string& key, int hours) {
    const std::string list = store_ + "/" + key + "/kept.json";
    fs::last_write_time(list, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  hours_ago("a", 2);
  hours_ago("b", 1);
  EXPECT_EQ(taken(kept, "a"), text);
  keep(kept, "c", text);
  EXPECT_EQ(taken(kept, "b"), "none");
  EXPECT_EQ(taken(kept, "a"), text);
  EXPECT_EQ(taken(kept, "c"), text);
  // One that is larger than all the room is kept alone.
  keep(kept, "d", std::string(3000, 'x'));
  EXPECT_EQ(taken(kept, "d").size(), 3000u);
  EXPECT_EQ(taken(kept, "a"), "none");
  EXPECT_EQ(taken(kept, "c"), "none");
}

TEST(InputKey, HasTextsApart) {
  const auto of = [](const auto&... texts) {
    InputKey key;
    (key.add(texts), ...);
    return key.text();
  };
  EXPECT_EQ(of("ab", "c"), of("ab", "c"));
  EXPECT_NE(of("ab", "c"), of("a", "bc"));
  EXPECT_NE(of("a", "b"), of("b", "a"));
  EXPECT_EQ(InputKey().add_code("// plan 1\nwire a;\n").text(),
            InputKey().add_code("// plan 2\n// more\nwire a;\n").text());
  EXPECT_NE(InputKey().add_code("wire a;\n").text(), InputKey().add_code("wire b;\n").text());
}

// The numbers of a stage's seconds are left out: they are the machine's.
std::string without_seconds(const std::string& line) {
  const size_t number = line.find(": ") + 2, end = line.find(" s,");
  return end == line.npos ? line : line.substr(0, number) + "N" + line.substr(end);
}

TEST_F(Kept, StagesSayWhatComesAndWhatTheyFound) {
  std::vector<std::string> lines;
  int made = 0;
  const auto flow = [&](const std::string& seed) {
    const std::string out = scratch_.path("out");
    fs::remove_all(out);
    make_directory(out);
    lines.clear();
    made = 0;
    Stages stages(out, KeptFiles(store_), {"netlist", "placement", "bitstream"},
                  [&](const std::string& line) { lines.push_back(without_seconds(line)); });
    stages.expect("netlist", "seconds");
    stages.expect("bitstream", "seconds");
    InputKey key;
    key.add("rtl");
    const auto leave = [&](const std::string& file) {
      ++made;
      write_text(out + "/" + file, file);
    };
    stages.make("netlist", key, [&] { leave("gates"); });
    stages.expect("placement", "1 to 2 min");
    stages.found("5 LUT");
    EXPECT_EQ(read_text(out + "/gates"), "gates");
    key.add(seed);
    stages.make("placement", key, [&] {
      EXPECT_EQ(stages.expected(), "1 to 2 min");
      leave("placed");
    });
    stages.found("50 MHz");
    EXPECT_EQ(read_text(out + "/placed"), "placed");
    stages.make_again("bitstream", [&] { leave("bits"); });
    stages.found("unit.bin");
    return stages.kept();
  };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(flow("1"), store_);
  EXPECT_EQ(made, 3);
  EXPECT_EQ(lines, (Lines{"netlist (seconds), placement, bitstream (seconds)",
                          "netlist: N s, 5 LUT; placement: 1 to 2 min", "placement: N s, 50 MHz",
                          "bitstream: N s, unit.bin"}));
  EXPECT_EQ(flow("2"), store_);
  EXPECT_EQ(made, 2);
  EXPECT_EQ(lines, (Lines{"placement (1 to 2 min), bitstream (seconds); known from before: netlist",
                          "placement: N s, 50 MHz", "bitstream: N s, unit.bin"}));
  EXPECT_EQ(flow("1"), "");
  EXPECT_EQ(made, 1);
  EXPECT_EQ(lines, Lines{});
}

// As of a tool that ends well on a full disk: its files turn out to be cut when they are read.
TEST_F(Kept, AStageIsKeptOnceItsFilesHaveBeenRead) {
  const std::string out = scratch_.path("out");
  make_directory(out);
  int made = 0;
  InputKey key;
  key.add("rtl");
  const auto flow = [&](const std::string& store, bool reads) {
    fs::remove_all(out + "/gates");
    Stages stages(out, KeptFiles(store), {"netlist"}, [](const std::string&) {});
    stages.make("netlist", key, [&] { ++made, write_text(out + "/gates", "gates"); });
    if (reads) stages.found("5 LUT");
    return stages.kept();
  };
  EXPECT_EQ(flow(store_, false), "");
  EXPECT_EQ(flow(store_, true), store_);
  EXPECT_EQ(made, 2);
  EXPECT_EQ(flow(store_, true), "");
  EXPECT_EQ(made, 2);
  write_text(scratch_.path("file"), "");
  EXPECT_EQ(flow(scratch_.path("file") + "/below", true), "");
  EXPECT_EQ(made, 3);
}

}  // namespace
}  // namespace cuboct::synth
