// SPDX-License-Identifier: MIT
// rtl_random_study --seeds A-B --out FILE --cache DIR [--minutes N] [--changed DIR] [--draw]
// Random scenes, machines and stalls (random_scene.h), each judged in bits and cycles. A line per seed goes
// to
// --out; seeds that stand there already are not run again. The sum of all that the file holds is printed at
// the end. Exit status: 0, 1 where a seed failed, 2 where the command line is wrong.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "tests/verify/random_scene.h"

namespace {

using namespace cuboct;
using namespace cuboct::test;

struct Request {
  std::string seeds, out, cache;
  double minutes = 0;
  bool draw = false;
  NodeBuild build{.changed = {}, .optimise = "-O0", .coverage = false};
};

// "seed<TAB>verdict<TAB>text<TAB>name=count;..."
struct Row {
  std::string verdict, text;
  std::map<std::string, uint64_t> counts;
};

std::map<uint64_t, Row> read_rows(const std::string& path) {
  std::map<uint64_t, Row> rows;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string seed, counts;
    Row row;
    std::getline(fields, seed, '\t');
    std::getline(fields, row.verdict, '\t');
    std::getline(fields, row.text, '\t');
    std::getline(fields, counts, '\t');
    std::istringstream parts(counts);
    for (std::string part; std::getline(parts, part, ';');)
      row.counts[part.substr(0, part.find('='))] = std::stoull(part.substr(part.find('=') + 1));
    rows[std::stoull(seed)] = row;
  }
  return rows;
}

Row judge_seed(uint64_t seed, const Request& r) {
  Row row;
  try {
    RandomScene scene = random_scene(seed);
    const Judge judge(scene.c, scene.runs);
    row.counts = stimuli_of(scene, judge);
    if (r.draw) {
      row.verdict = "drawn";
      return row;
    }
    const std::string path = build_node(scene.c.setup.plan, r.build, r.cache);
    const Judgement j = judge.judge(std::make_shared<const emu::Library>(path));
    std::filesystem::remove(path);  // no other seed needs it
    row.verdict = to_string(j.verdict);
    row.text = j.text;
    row.counts["steps compared"] = j.steps;
    row.counts["particles compared"] = j.particles;
    row.counts["phases compared"] = j.spans;
    row.counts["cycles of nodes compared"] = j.cycles;
    row.counts["runs"] = judge.runs();
  } catch (const InputError& e) {
    row.verdict = "refused";
    row.text = e.what();
  }
  for (char& c : row.text)
    if (c == '\n' || c == '\t') c = ' ';
  return row;
}

int run(const Request& r) {
  const size_t dash = r.seeds.find('-');
  const uint64_t first = std::stoull(r.seeds),
                 last = dash == std::string::npos ? first : std::stoull(r.seeds.substr(dash + 1));
  auto rows = read_rows(r.out);
  std::ofstream file(r.out, std::ios::app);
  if (!file) throw InputError(fmt::format("cannot write {}", r.out));
  const auto begin = std::chrono::steady_clock::now();
  for (uint64_t seed = first; seed <= last; ++seed) {
    if (rows.count(seed) != 0) continue;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (r.minutes > 0 && spent > 60 * r.minutes) break;
    const Row row = rows[seed] = judge_seed(seed, r);
    file << seed << '\t' << row.verdict << '\t' << row.text << '\t';
    for (const auto& [name, count] : row.counts) file << name << '=' << count << ';';
    file << std::endl;
    if (row.verdict != "passed" && row.verdict != "refused" && !r.draw)
      fmt::print("seed {} fails: {}: {}\n  again: rtl_random_study --seeds {} --out NEW_FILE --cache {}\n",
                 seed, row.verdict, row.text, seed, r.cache);
  }

  uint64_t passed = 0, failed = 0, refused = 0;
  std::map<std::string, std::pair<uint64_t, uint64_t>> sums;  // seeds with some, and how many in all
  for (const auto& [seed, row] : rows) {
    (row.verdict == "passed" || row.verdict == "drawn" ? passed
     : row.verdict == "refused"                        ? refused
                                                       : failed) += 1;
    for (const auto& [name, count] : row.counts) {
      sums[name].first += count > 0;
      sums[name].second += count;
    }
  }
  fmt::print("| stimulus | seeds | count |\n|---|---|---|\n");
  for (const auto& [name, sum] : sums) fmt::print("| {} | {} | {} |\n", name, sum.first, sum.second);
  fmt::print("{} seeds passed, {} failed, {} refused by the planner\n", passed, failed, refused);
  return failed > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request r;
  Command app("rtl_random_study", "Random scenes, machines and stalls for the RTL");
  app.option("--seeds", r.seeds, "A-B, or one", "A-B").required().check([](const std::string& text) {
    const bool fine = !text.empty() && text.find_first_not_of("0123456789-") == std::string::npos &&
                      text.front() != '-' && text.back() != '-';
    return fine ? std::string() : "expected A-B, two numbers, got " + text;
  });
  app.option("--out", r.out, "A line per seed is added to this file").required();
  app.option("--cache", r.cache, "Where nodes are compiled").required();
  app.option("--minutes", r.minutes, "No further seed is begun after these");
  app.flag("--draw", r.draw, "Golden and the native node only: what the seeds are stimuli of");
  app.option("--changed", r.build.changed, "Modules in place of the library's");
  if (const auto ended = parse_command_line(app, argc, argv)) return *ended;
  try {
    return run(r);
  } catch (const std::exception& e) {
    fmt::print(stderr, "rtl_random_study: {}\n", e.what());
    return 2;
  }
}
