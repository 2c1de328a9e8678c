// SPDX-License-Identifier: MIT
// What the command line says of itself, and errors for scripts.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

using Strings = std::vector<std::string>;

Strings lines_of(const std::string& text) {
  std::istringstream in(text);
  Strings lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// From the list that 'cuboct' alone refuses with.
Strings commands(const Bench& bench) {
  const std::string err = bench.cuboct({}).err;
  const std::regex word("[a-z]+");
  const std::string list = err.substr(err.find("one of ") + 7, err.find("; see") - err.find("one of ") - 7);
  Strings names;
  for (std::sregex_iterator at(list.begin(), list.end(), word), end; at != end; ++at)
    if (at->str() != "or") names.push_back(at->str());
  return names;
}

TEST(Help, OfAllIsInGroupsWithAnExampleEach) {
  const Bench bench(false);
  const Answer answer = bench.cuboct({"--help"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(bench.cuboct({"help"}).out, answer.out);
  for (const std::string& line : lines_of(answer.out)) EXPECT_LE(line.size(), 80u) << line;
  for (const char* group : {"make a scene", "run it", "compare", "make the hardware", "study settings"})
    EXPECT_NE(answer.out.find(std::string("\n") + group + ":\n"), std::string::npos) << group;
  const Strings names = commands(bench);
  ASSERT_EQ(names.size(), 22u);
  for (const std::string& name : names) {
    EXPECT_NE(answer.out.find("\n  " + name + " "), std::string::npos) << name;
    EXPECT_NE(answer.out.find("\n                cuboct " + name + " "), std::string::npos) << name;
  }
}

TEST(Help, OfEachCommandHasAnExampleAndFits80Columns) {
  const Bench bench(false);
  for (const std::string& name : commands(bench)) {
    const Answer answer = bench.cuboct({name, "--help"});
    EXPECT_EQ(answer.code, 0);
    if (answer.out.empty()) continue;  // left out of this build
    EXPECT_EQ(bench.cuboct({"help", name}).out, answer.out);
    const Strings lines = lines_of(answer.out);
    EXPECT_EQ(lines[1].find("usage: cuboct " + name + " [OPTIONS]"), 0u) << answer.out;
    for (const std::string& line : lines) EXPECT_LE(line.size(), 80u) << line;
    ASSERT_EQ(lines[lines.size() - 2], "example:") << answer.out;
    const std::string& example = lines.back();
    EXPECT_EQ(example.find("  cuboct " + name + " "), 0u) << example;
    // A file that it reads is there, an option that it gives is one of this command.
    std::istringstream words(example);
    for (std::string word; words >> word;) {
      if (word.ends_with(".toml")) {
        EXPECT_TRUE(std::filesystem::exists(CUBOCT_SOURCE_DIR "/" + word)) << word;
      }
      if (word.starts_with("--")) {
        EXPECT_NE(answer.out.find("\n  " + word), std::string::npos) << word;
      }
    }
  }
  EXPECT_EQ(bench.cuboct({"help", "rnu"}).err, "unknown command 'rnu'\n  hint: did you mean 'run'?\n");
}

TEST(Json, ErrorsHaveTheirPlace) {
  const Bench bench(false);
  const std::string path = bench.path("a \"scene\".toml");
  std::ofstream(path) << "[run]\nsteps = 10\n  stepz = 3\n";
  const auto error_of = [&](const Strings& arguments) {
    const Answer answer = bench.cuboct(arguments);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    EXPECT_EQ(lines_of(answer.err).size(), 1u) << answer.err;
    return nlohmann::json::parse(answer.err).at("error");
  };
  const std::string plain = bench.cuboct({"check", path}).err;
  nlohmann::json error = error_of({"check", path, "--json"});
  EXPECT_EQ(error.size(), 5u);
  EXPECT_EQ(error["file"], path);
  EXPECT_EQ(plain.find(path + ":" + error["line"].dump() + ":" + error["column"].dump() + ": " +
                       error["message"].get<std::string>() + "\n"),
            0u)
      << plain << error;
  error = error_of({"run", "scenes/lj_block.toml", "--json", "--engine", "goldn"});
  EXPECT_EQ(error["message"], "unknown engine 'goldn'");
  EXPECT_EQ(error["hint"], "did you mean 'golden'?");
  EXPECT_TRUE(error["file"].is_null() && error["line"].is_null() && error["column"].is_null());
  error = error_of({"run", "scenes/lj_block.toml", "--json", "--steps", "many"});  // of the parser
  EXPECT_NE(error["message"].get<std::string>().find("'many'"), std::string::npos) << error;
  EXPECT_TRUE(error["hint"].is_null());
}

TEST(Json, ListsAreJsonWhereAsked) {
  const Bench bench(false);
  for (const auto& [command, list] : {std::pair{"new", "templates"}, {"bench", "benchmarks"}}) {
    const Strings lines = lines_of(bench.cuboct({command, "--list"}).out);
    const nlohmann::json all =
        nlohmann::json::parse(bench.cuboct({command, "--list", "--json"}).out).at(list).at("value");
    ASSERT_EQ(all.size(), lines.size());
    ASSERT_GT(lines.size(), 3u);
    for (size_t k = 0; k < lines.size(); ++k) {
      EXPECT_EQ(lines[k].find(all[k].at("name").get<std::string>() + " "), 0u) << lines[k];
      EXPECT_TRUE(lines[k].ends_with(all[k].at("what").get<std::string>())) << lines[k];
    }
  }
}

}  // namespace
}  // namespace cuboct::test
