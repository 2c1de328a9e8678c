// SPDX-License-Identifier: MIT
// The checker takes what the builder proves, and refuses each line that was changed for the worse.
#include "model/graph/certificate.h"

#include <gtest/gtest.h>

#include <sstream>

#include "model/contract/pair_program.h"
#include "tests/graph/random_graph.h"
#include "tests/graph/random_rule.h"

namespace cuboct::graph {
namespace {

using test::Dice;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

bool has(const std::string& line, const std::string& word) { return line.find(word) != std::string::npos; }

// Whether the ends of a line's interval follow from others.
bool is_proven(const std::string& line) {
  return has(line, " in ") && !has(line, "format") && (!has(line, " input ") || has(line, " input sum ")) &&
         !has(line, " clamp ") && !has(line, " within ");
}

// The line with one end moved inwards; empty where it has but one value.
std::string shorter(const std::string& line, bool low_end) {
  const size_t at = line.find(" in ");
  std::istringstream words(line.substr(at + 4));
  int64_t low = 0, high = 0;
  words >> low >> high;
  if (low == high) return {};
  return line.substr(0, at) + " in " + std::to_string(low + low_end) + " " + std::to_string(high - !low_end);
}

TEST(Certificate, OfRandomGraphsIsTaken) {
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    FixedProgram program;
    program.fields.resize(10);
    program.rounds.resize(1);
    program.rounds[0].finish = test::random_graph(seed, 40).graph;
    for (const Node& node : program.rounds[0].finish.nodes)
      if (node.op == Op::input) program.fields[static_cast<size_t>(node.index)].range = node.range;
    const std::string text = certificate_of(program);
    const Refusal refusal = refusal_of(text);
    ASSERT_EQ(refusal.line, 0) << "seed " << seed << ": " << refusal.what << "\n"
                               << lines_of(text)[static_cast<size_t>(std::max(1, refusal.line) - 1)];
  }
}

TEST(Certificate, OfThePairLawIsTakenAndAnEndAUnitShortIsNot) {
  size_t shortened = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<std::string> lines = lines_of(certificate_of(pair_program(test::random_rule(seed), 4)));
    const Refusal refusal = refusal_of(joined(lines));
    ASSERT_EQ(refusal.line, 0) << "seed " << seed << ": " << refusal.what << "\n"
                               << lines[static_cast<size_t>(std::max(1, refusal.line) - 1)];
    for (size_t k = 0; k < lines.size(); ++k)
      for (const bool low : {false, true}) {
        if (!is_proven(lines[k]) || shorter(lines[k], low).empty()) continue;
        std::vector<std::string> changed = lines;
        changed[k] = shorter(lines[k], low);
        ASSERT_EQ(refusal_of(joined(changed)).line, static_cast<int>(k) + 1)
            << "seed " << seed << ": " << changed[k];
        ++shortened;
      }
  }
  EXPECT_GT(shortened, 150u);
}

// A small program of which each line matters.
FixedProgram small() {
  FixedProgram program;
  program.partners = 26;
  program.axes = 1;
  program.position_frac = 10;
  program.velocity = {-2048, 2047};
  program.fields = {{"p", 1, {0, 100}, 0}};
  Builder pair;
  const int d = read_apart(pair, program, 0);
  const int p = read_field(pair, program, Source::own_field, 0),
            q = read_field(pair, program, Source::other_field, 0);
  pair.counts(pair.lt(pair.mul(d, d), pair.constant(10001)));
  const int near = pair.within(d), term = pair.mul(pair.sub(p, pair.shl(q, 1)), near, 4);
  Round round{.name = "one", .when = pair.when(), .sums = {{"force", {term}}}};
  round.pair = pair.take();
  Builder finish;
  const int sum = read_sum(finish, program, round, 0);
  const int v =
      finish.check(finish.add(read_velocity(finish, program, Source::own_v, 0), sum), 12, Fault::velocity);
  round.writes = {{0, 0, finish.clamp(sum, {0, 100})}};
  round.finish = finish.take();
  program.rounds = {round};
  program.motion = {{v}, {}, {v}};
  program.guard = 1;
  return program;
}

TEST(Certificate, IsRefusedAtTheLineThatWasChanged) {
  check(small());
  const std::vector<std::string> lines = lines_of(certificate_of(small()));
  ASSERT_EQ(refusal_of(joined(lines)).line, 0);
  const auto refused_with = [&](const std::string& from, const std::string& to) {
    std::vector<std::string> changed = lines;
    for (size_t k = 0; k < lines.size(); ++k)
      if (const size_t at = lines[k].find(from); at != std::string::npos) {
        changed[k] = lines[k].substr(0, at) + to + lines[k].substr(at + from.size());
        const Refusal refusal = refusal_of(joined(changed));
        return refusal.line == 0 ? "taken: " + changed[k] : lines[static_cast<size_t>(refusal.line) - 1];
      }
    return "no line has " + from;
  };
  const auto line_with = [&](const std::string& part) {
    for (const std::string& line : lines)
      if (has(line, part)) return line;
    return std::string();
  };
  const std::string shl = line_with(" shl "), sub = line_with(" sub "), checked = line_with(" check ");
  const std::string product = line_with(" shift 4 ");
  EXPECT_EQ(refused_with(" shl 2 shift 1", " shl 2 shift 2"), shl);
  EXPECT_EQ(refused_with(" shift 4 ", " shift 3 "), product);
  EXPECT_EQ(refused_with(" sub 1 7", " sub 7 1"), sub);
  EXPECT_EQ(refused_with("partners 26", "partners 27"), line_with("input sum"));
  EXPECT_EQ(refused_with("format field 0 in 0 100", "format field 0 in 0 99"), line_with("write field"));
  EXPECT_EQ(refused_with("format velocity 0 in -2048 2047", "format velocity 0 in -2048 2046"),
            line_with("write velocity"));
  EXPECT_EQ(refused_with(" check 2 3 width 12", " max 2 2"), checked);
  EXPECT_EQ(refused_with(" width 12", " width 13"), checked);
  for (const char* places : {"-1", "64", "1000000000000"}) {
    EXPECT_EQ(refused_with(" shl 2 shift 1", std::string(" shl 2 shift ") + places), shl);
    EXPECT_EQ(refused_with(" shift 4 ", std::string(" shift ") + places + " "), product);
    EXPECT_EQ(refused_with(" width 12", std::string(" width ") + places), checked);
  }
}

}  // namespace
}  // namespace cuboct::graph
