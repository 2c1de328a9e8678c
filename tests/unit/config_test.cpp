// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "model/base/error.h"
#include "model/base/input_file.h"
#include "model/config/config.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

std::string error_of(const std::string& text, const std::function<void(const ConfigTable&)>& read) {
  return refused_with([&] { read(parse_config(text, "a.toml")); });
}

TEST(Config, PointsAtUnknownKeys) {
  const auto read = [](const ConfigTable& root) {
    const auto node = root.table_at("node");
    node->integer_or("capacity", 1, 100, 16);
    node->integer_or("filter_lanes", 1, 100, 8);
    root.done();
  };
  EXPECT_EQ(error_of("[node]\n  capcity = 3\n", read),
            "a.toml:2:3: unknown key 'capcity'\n  hint: did you mean 'capacity'?");
  // No key that the table already has is worth a hint.
  EXPECT_EQ(error_of("[node]\ncapacity = 1\ncapacty = 3\n", read), "a.toml:3:1: unknown key 'capacty'");
  EXPECT_EQ(error_of("[node]\ncapacity = 1\n\n[nodes]\n", read), "a.toml:4:2: unknown key 'nodes'");
  EXPECT_EQ(error_of("[node]\nx = 1\n", read), "a.toml:2:1: unknown key 'x'");
  EXPECT_EQ(error_of("[node]\ncapacity = 1\n", read), "accepted");
}

TEST(Config, AMisspeltRequiredKeyIsCalledSo) {
  const auto read = [](const ConfigTable& root) { root.number("pitch", quantity::length); };
  EXPECT_EQ(error_of("ptich = \"1 mm\"\n", read),
            "a.toml:1:1: unknown key 'ptich'\n  hint: did you mean 'pitch'?");
  EXPECT_EQ(error_of("size = 1\n", read), "a.toml:1:1: missing key 'pitch'");
  EXPECT_EQ(error_of("[p]\n[p.q]\n",
                     [](const ConfigTable& root) { root.at("p").table().at("q").table().at("pitch"); }),
            "a.toml:2:1: missing key 'pitch' in 'p.q'");
}

// What a table lacks may stand under a name of the user's own: the message tells both.
TEST(Config, NamesAMisspeltKeyBesideWhatIsMissing) {
  const auto read = [](const ConfigTable& root) {
    const ConfigTable law = root.at("law").table();
    if (!law.has("youngs_modulus")) law.at("stiffness");
  };
  EXPECT_EQ(error_of("[law]\nyoung_modulus = 3\n", read),
            "a.toml:1:1: missing key 'stiffness' in 'law'\n"
            "  hint: line 2 has the key 'young_modulus': did you mean 'youngs_modulus'?");
  EXPECT_EQ(error_of("[law]\nE = 3\n", read),
            "a.toml:1:1: missing key 'stiffness' in 'law'\n"
            "  hint: line 2 has the key 'E': the key is 'youngs_modulus'");
  EXPECT_EQ(error_of("[law]\nvalue = 3\n", read), "a.toml:1:1: missing key 'stiffness' in 'law'");
  // So may a table beside it. A message with a hint keeps it.
  const auto pack = [](const ConfigTable& root) {
    if (!root.has("geometry")) root.at("packing").fail("nothing says what to pack", "add [geometry]");
  };
  EXPECT_EQ(error_of("[packing]\n[geometri]\n", pack),
            "a.toml:1:1: nothing says what to pack\n"
            "  hint: add [geometry]; line 2 has the key 'geometri': did you mean 'geometry'?");
}

TEST(Config, WantsUnits) {
  const auto read = [](const ConfigTable& root) {
    root.number("pitch", quantity::length, Range::positive());
  };
  EXPECT_EQ(error_of("pitch = 0.5", read), "a.toml:1:9: 'pitch' needs a unit: a length such as \"0.5 mm\"");
  EXPECT_EQ(error_of("pitch = \"0.5\"", read),
            "a.toml:1:9: 'pitch' needs a unit: a length such as \"0.5 mm\"");
  EXPECT_EQ(error_of("pitch = \"3 GPa\"", read),
            "a.toml:1:9: 'pitch' must be a length such as \"0.5 mm\", but \"3 GPa\" is a pressure");
  EXPECT_EQ(error_of("pitch = \"[1, 2] mm\"", read),
            "a.toml:1:9: 'pitch' must be a length such as \"0.5 mm\", not a list");
  EXPECT_EQ(error_of("pitch = true", read),
            "a.toml:1:9: 'pitch' must be a length such as \"0.5 mm\", not true or false");
  EXPECT_EQ(error_of("pitch = \"-1 mm\"", read), "a.toml:1:9: 'pitch' must be greater than 0, not \"-1 mm\"");
  EXPECT_EQ(error_of("pitch = \"1 mn\"", read),
            "a.toml:1:9: unknown unit 'mn' in \"1 mn\"\n  hint: did you mean 'mN'?");
}

TEST(Config, ReducedUnitsArePlain) {
  const auto read = [](const ConfigTable& root) {
    EXPECT_EQ(root.number("pitch", quantity::length), 2.0);
    root.done();
  };
  EXPECT_EQ(error_of("units = \"reduced\"\npitch = 2\n", read), "accepted");
  EXPECT_EQ(error_of("units = \"reduced\"\npitch = \"2 m\"\n", read),
            "a.toml:2:9: 'pitch' must be a plain number, as units = \"reduced\"");
  EXPECT_EQ(error_of("units = \"reducd\"\n", read),
            "a.toml:1:9: unknown units 'reducd'\n  hint: did you mean 'reduced'?");
}

TEST(Config, ChecksRangesAndKinds) {
  const auto ratio = [](const ConfigTable& root) {
    root.number("ratio", quantity::number, Range::between(0, 1));
  };
  EXPECT_EQ(error_of("ratio = 2", ratio), "a.toml:1:9: 'ratio' must be between 0 and 1, not 2");
  EXPECT_EQ(error_of("ratio = nan", ratio), "a.toml:1:9: 'ratio' must be finite, not nan");
  EXPECT_EQ(error_of("ratio = \"1\"", ratio), "a.toml:1:9: 'ratio' must be a number, not a string");
  EXPECT_EQ(error_of("ratio = 1", ratio), "accepted");
  const auto safety = [](const ConfigTable& root) {
    root.number("safety", quantity::number, {.low = 0, .high = 1, .low_open = true});
  };
  EXPECT_EQ(error_of("safety = 0", safety), "a.toml:1:10: 'safety' must be above 0 and at most 1, not 0");
  const auto count = [](const ConfigTable& root) { root.integer_or("n", 1, 4, 1); };
  EXPECT_EQ(error_of("n = 5", count), "a.toml:1:5: 'n' must be between 1 and 4, not 5");
  EXPECT_EQ(error_of("n = 1.5", count), "a.toml:1:5: 'n' must be a whole number, not a number");
  EXPECT_EQ(error_of("n = 1e3", count),
            "a.toml:1:5: 'n' must be a whole number, not a decimal one\n"
            "  hint: write 1000: a point or an exponent makes a decimal number in TOML");
  const auto axes = [](const ConfigTable& root) { root.axes("axes"); };
  EXPECT_EQ(error_of("axes = \"xyx\"", axes),
            "a.toml:1:8: 'axes' must name axes, such as \"x\" or \"xyz\", not \"xyx\"");
  const auto vector = [](const ConfigTable& root) { root.vector_or("v", quantity::velocity, Vec3::Zero()); };
  EXPECT_EQ(error_of("v = \"[1, 2] m/s\"", vector),
            "a.toml:1:5: 'v' needs three components, not 2\n  hint: for instance \"[0, 0, 1] m/s\"");
  EXPECT_EQ(error_of("v = [\"1 m/s\", \"2 m/s\", \"3 m\"]", vector),
            "a.toml:1:24: 'v' must be a velocity such as \"2 m/s\", but \"3 m\" is a length");
  const auto tables = [](const ConfigTable& root) { root.tables("t"); };
  EXPECT_EQ(error_of("[t]\n", tables), "a.toml:1:1: 't' must be an array of tables\n  hint: write [[t]]");
}

TEST(Config, TextsAreNoLongerThanAPath) {
  const auto read = [](const ConfigTable& root) { root.string_or("title", ""); };
  EXPECT_EQ(error_of("title = \"" + std::string(4096, 'a') + "\"\n", read), "accepted");
  EXPECT_EQ(error_of("b = 1\ntitle = \"" + std::string(4097, 'a') + "\"\n", read),
            "a.toml:2:9: 'title' is a text of 4097 bytes: at most 4096 are read");
  // A list of numbers has its own limits.
  const auto numbers = [](const ConfigTable& root) { root.at("a").numbers(quantity::length); };
  std::string list = "1";
  for (int k = 0; k < 3000; ++k) list += ", 1";
  EXPECT_EQ(error_of("a = \"[" + list + "] mm\"\n", numbers), "accepted");
}

TEST(Config, TextsAreUtf8) {
  const auto read = [](const ConfigTable& root) { root.string_or("a", ""); };
  EXPECT_EQ(error_of("\xEF\xBB\xBF"
                     "a = \"\xC3\xBC\"\n",
                     read),
            "accepted");
  EXPECT_EQ(error_of("b = 1\na = \"\xC3\xBC\xFC\"\n", read),
            "a.toml:2:7: the byte 0xfc is not UTF-8 text\n  hint: save the file as UTF-8: it may be in "
            "Latin-1 now");
  EXPECT_EQ(error_of(std::string("a\0", 2), read),
            "a.toml:1:2: the byte 0x00 is not UTF-8 text\n  hint: save the file as UTF-8: it may be in "
            "UTF-16 now");
  EXPECT_EQ(error_of("a = 1 # \xED\xA0\x80", read).substr(0, 33), "a.toml:1:9: the byte 0xed is not ");
}

TEST(Config, PassesSyntaxErrorsOn) {
  const auto read = [](const ConfigTable&) {};
  EXPECT_EQ(error_of("a = 1\nb = = 2\n", read).substr(0, 12), "a.toml:2:5: ");
  EXPECT_EQ(error_of("a = 1\na = 2\n", read).substr(0, 9), "a.toml:2:");
  EXPECT_EQ(error_of("a = \"text\nb = 2\n", read),
            "a.toml:1:10: a line ends, or has a control character, within a text\n"
            "  hint: close the text by the quote that began it");
  EXPECT_EQ(error_of("[end]\na = 1\n[[end]]\na = 2\n", read),
            "a.toml:3:1: Error while parsing table header: cannot redefine existing table 'end' as "
            "array-of-tables\n"
            "  hint: write [[end]] for each of them");
  EXPECT_THROW(read_config("no/such/file.toml"), InputError);
  EXPECT_EQ(refused_with([&] { read_config("no/such/file.toml"); }),
            "no/such/file.toml: cannot read this file");
}

TEST(Config, ProposesTheNearestFile) {
  const test::Folder folder;
  const std::string there = folder.write("beam.toml", "a = 1\n"), path = folder.path("baem.toml");
  EXPECT_EQ(refused_with([&] { read_config(path); }),
            path + ": cannot read this file\n  hint: did you mean '" + there + "'?");
}

// What no scene is: a device without end, a directory, a pipe that no one writes into, more than is read.
TEST(Config, IsOfAFileOrAPipeThatEnds) {
  const auto refusal = [](const std::string& path, uint64_t most = kMostInput) -> std::string {
    try {
      return "read " + read_input(path, most);
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: cannot read this file: it is a device");
  EXPECT_EQ(refusal("/dev/urandom"), "/dev/urandom: cannot read this file: it is a device");
  EXPECT_EQ(refusal("/"), "/: cannot read this file: it is a directory");
  const std::string path = testing::TempDir() + fmt::format("input.{}", getpid());
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(refusal(path), "read ");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], "one two", 7), 7);
  close(ends[1]);
  EXPECT_EQ(refusal(fmt::format("/dev/fd/{}", ends[0])), "read one two");
  close(ends[0]);
  EXPECT_THROW(check_is_file(path), InputError);
  std::filesystem::remove(path);
  std::ofstream(path) << "eleven byte";
  EXPECT_EQ(refusal(path, 11), "read eleven byte");
  EXPECT_EQ(refusal(path, 10), path + ": cannot read this file: it holds 11 B, and at most 10 B are read");
  check_is_file(path);
  std::filesystem::remove(path);
  std::ofstream(path).close();
  std::filesystem::resize_file(path, uint64_t{1} << 40);  // of which the disk holds nothing
  EXPECT_EQ(refusal(path), path + ": cannot read this file: it holds 1.1 TB, and at most 268 MB are read");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace cuboct
