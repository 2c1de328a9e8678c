// SPDX-License-Identifier: MIT
// `cuboct bench` as scripts read it.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

// The "name value unit" lines; any other line must be a comment.
std::map<std::string, double> values_of(const std::string& out) {
  std::map<std::string, double> values;
  std::istringstream lines(out);
  const std::regex form("([a-z][a-z0-9_.]*) ([0-9.e+-]+) 1/s");
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (std::regex_match(line, found, form))
      EXPECT_TRUE(values.emplace(found[1], std::stod(found[2])).second) << line;
    else
      EXPECT_TRUE(line.starts_with("# ")) << line;
  }
  return values;
}

Answer bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "bench");
  return Bench(false).cuboct(arguments);
}

TEST(BenchCommand, TellsTheMedianOfItsRepeats) {
  const Answer answer = bench({"golden", "--seconds", "0.01", "--repeats", "3"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.err, "");
  const auto values = values_of(answer.out);
  ASSERT_EQ(values.size(), 1u) << answer.out;
  // 4000 particles meet some hundred candidates each: no machine does it a billion times a second, or less
  // than a thousand times.
  EXPECT_GT(values.at("golden.block_4k.particle_steps"), 1e3);
  EXPECT_LT(values.at("golden.block_4k.particle_steps"), 1e9);
  EXPECT_NE(answer.out.find("# golden.block_4k: 3 repeats of "), std::string::npos) << answer.out;
}

// A step moves every particle: steps and particles over the told length of a repeat make the rate. However
// busy the machine is, two of three repeats take at least the told median, and all of them pass while the
// test waits.
void expect_times_what_it_says(const std::string& name, const std::string& label) {
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer = bench({name, "--seconds", "0.05", "--repeats", "3"});
  const double waited = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(answer.code, 0) << answer.err;
  std::smatch found;
  ASSERT_TRUE(std::regex_search(answer.out, found, std::regex(label + ", (\\d+) steps per repeat\n")))
      << answer.out;
  const double steps = std::stod(found[1]);
  ASSERT_TRUE(std::regex_search(
      answer.out, found, std::regex("# " + name + ": 3 repeats of ([0-9.e-]+) s, standard deviation ")))
      << answer.out;
  const double seconds = std::stod(found[1]), rate = values_of(answer.out).at(name + ".particle_steps");
  EXPECT_NEAR(steps * 32000 / rate, seconds, 2e-3 * seconds);  // of four digits each
  EXPECT_LT(2 * seconds, waited);
}

TEST(BenchCommand, TimesWhatItSays) {
  expect_times_what_it_says("lattice.block_32k.1_thread", "32000 particles on \\d+ nodes, 1 thread, \\w+");
}

TEST(BenchCommand, TimesRealNumbers) {
  expect_times_what_it_says("real.float_block_32k.1_thread", "32000 particles, 1 thread, \\w+");
}

TEST(BenchCommand, SaysWhatItSkips) {
  const Answer answer = bench({"systemc", "--repeats", "2"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_TRUE(values_of(answer.out).empty());
  EXPECT_NE(answer.out.find("# systemc.block_2k: skipped: no program cuboct-systemc beside cuboct\n"),
            std::string::npos)
      << answer.out;
}

// A program beside cuboct that answers `--machine FILE` with one text and `--lines FILE` with the other, by
// the row's arithmetic.
void put_gpu_program(const Bench& bench, const std::string& machine, const std::string& floats,
                     const std::string& others) {
  const std::string path = bench.path("bin/cuboct-gpu");
  std::ofstream(path) << "#!/bin/sh\n"
                         "echo \"$*\" >>" +
                             bench.path("asked") +
                             "\n"
                             "[ \"$2\" = --machine ] && { printf '" +
                             machine +
                             "' >$3; exit 0; }\n"
                             "[ \"$2 $4 $6 $8\" = '--only --repeats --seconds --lines' ] || exit 2\n"
                             "case $3 in *.float) printf '" +
                             floats + "' >$9;; *) printf '" + others + "' >$9; esac\n";
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
}

TEST(BenchCommand, LetsTheGpuProgramMeasure) {
  const Bench bench(false);
  put_gpu_program(bench, "{}\\n",
                  "# 256000 particles on a GPU\\nparticle_steps 6.4e+08 1/s\\nrepeat 0.4 s\\n",
                  "# skipped: needs 9 GB of 8 GB\\n");
  const Answer answer = bench.cuboct({"bench", "gpu.melt_256k", "--repeats", "7", "--seconds", "0.2"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  const auto values = values_of(answer.out);
  ASSERT_EQ(values.size(), 1u) << answer.out;
  EXPECT_EQ(values.at("gpu.melt_256k.float.particle_steps"), 6.4e8);
  EXPECT_NE(answer.out.find("# gpu.melt_256k.float: 256000 particles on a GPU\n"), std::string::npos)
      << answer.out;
  EXPECT_NE(answer.out.find("# gpu.melt_256k.fixed: skipped: needs 9 GB of 8 GB\n"), std::string::npos)
      << answer.out;
  // It repeats by itself: each row is asked for once.
  const std::string asked = contents(bench.path("asked"));
  const std::string first = "\nbench --only melt_256k.float --repeats 7 --seconds 0.2 --lines ";
  EXPECT_NE(asked.find(first), std::string::npos) << asked;
  EXPECT_EQ(asked.find(first), asked.rfind(first)) << asked;
}

TEST(BenchCommand, SaysOnceThatThereIsNoGpu) {
  const auto but_the_machine = [](const Answer& answer) {
    EXPECT_EQ(answer.code, 0);
    EXPECT_EQ(answer.err, "");
    return answer.out.substr(answer.out.find('\n') + 1);
  };
  EXPECT_EQ(but_the_machine(bench({"gpu"})), "# gpu: skipped: no program cuboct-gpu beside cuboct\n");
  const Bench bench(false);
  put_gpu_program(bench, "none: no driver\\n", "", "");
  EXPECT_EQ(but_the_machine(bench.cuboct({"bench", "gpu"})), "# gpu: skipped: no GPU: no driver\n");
  // A device that fails is a failure.
  put_gpu_program(bench, "{}\\n", "# failed: CUDA says no\\n", "");
  const Answer failed = bench.cuboct({"bench", "gpu.block_2m.float"});
  EXPECT_EQ(failed.code, 1);
  EXPECT_NE(failed.out.find("# gpu.block_2m.float: failed: CUDA says no\n"), std::string::npos) << failed.out;
}

TEST(BenchCommand, NamesWhatItHas) {
  const Answer list = bench({"--list"});
  EXPECT_EQ(list.code, 0);
  for (const char* name :
       {"lattice.block_32k.1_thread ", "lattice.damped_2m.all_cores ", "lattice.cycles_32k.",
        "golden.block_4k ", "real.double_block_32k.1_thread ", "real.float_damped_256k.all_cores ",
        "systemc.block_2k ", "impact.quiescence_off ", "scaling.threads_1 ", "gpu.melt_2m.fixed "})
    EXPECT_NE(list.out.find(name), std::string::npos) << name;
  EXPECT_EQ(bench({"golden.block_4"}).err,
            "no benchmark 'golden.block_4'\n  hint: did you mean 'golden.block_4k'?\n");
  EXPECT_EQ(bench({"abacus"}).err, "no benchmark 'abacus'\n  hint: 'cuboct bench --list' names them\n");
  EXPECT_EQ(bench({"abacus"}).code, 2);
}

}  // namespace
}  // namespace cuboct::test
