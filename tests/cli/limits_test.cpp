// SPDX-License-Identifier: MIT
// Input that asks for more than a machine has is refused before anything is made: within seconds of CPU time
// and little memory, which limits of the process hold.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>

#include "hw/program/bounds.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

constexpr Limits kSmall{.memory = uint64_t{3} << 30, .cpu_seconds = 20};

class LimitsTest : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(bench_.path(name)) << text;
    return bench_.path(name);
  }
  Answer check(const std::string& text) const {
    return bench_.cuboct({"check", file("scene.toml", text)}, {}, kSmall);
  }
  // The message of a refused scene, its path left out.
  std::string refusal(const std::string& text) const {
    const Answer answer = check(text);
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_EQ(answer.out, "");
    const std::string path = bench_.path("scene.toml");
    EXPECT_TRUE(answer.err.starts_with(path)) << answer.err;
    return without_excerpt(answer.err.substr(std::min(answer.err.size(), path.size())));
  }
  const Bench bench_{false};
};

const std::string kHead =
    "mass = 1.0\nunits = \"reduced\"\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n";
const std::string kPair = "[[particle]]\nposition = [0, 0, 0]\n[[particle]]\nposition = [1.1, 0, 0]\n";

TEST_F(LimitsTest, APathThatIsTooLong) {
  const std::string moved =
      "[[constraint]]\nname = \"pull\"\nkind = \"moved\"\nregion = { shape = \"sphere\", radius = 0.1 }\n";
  const std::string run = "[run]\ndt = 0.001\nsteps = 1000000000000\n";
  EXPECT_EQ(refusal(kHead + kPair + moved + "velocity = [1, 0, 0]\n" + run),
            ":19:9: a body moved at 1 m/s goes 1e+09 m in 1e+09 s, through 4e+08 cells of 2.5 m: more than "
            "can be built\n"
            "  hint: a shorter run, or one in which bodies are moved less far\n");
  EXPECT_EQ(refusal(kHead + kPair + moved + "velocity = [0.02, 0.01, 0]\n" + run).substr(0, 6), ":19:9:");
}

// Along a ring cells repeat: such a path is long and reaches little.
TEST_F(LimitsTest, APathAroundARingIsNotTooLong) {
  const Answer answer = check(kHead + kPair +
                              "[box]\nsize = [10, 10, 10]\nperiodic = \"xyz\"\n"
                              "[[constraint]]\nname = \"pull\"\nkind = \"moved\"\nvelocity = [1, 0, 0]\n"
                              "region = { shape = \"sphere\", radius = 0.1 }\n"
                              "[run]\ndt = 0.001\nsteps = 1000000000000\n");
  EXPECT_EQ(answer.code, 0) << answer.err;
}

std::string block(const std::string& cells, const std::string& rest = "") {
  return kHead + "[packing]\npitch = 1.1\n[box]\n" + cells +
         "\nperiodic = \"xyz\"\n[run]\ndt = 0.001\nsteps = 10\n" + rest;
}

TEST_F(LimitsTest, MoreParticlesThanMemory) {
  const std::string text = refusal(block("cells = [700, 700, 700]"));
  EXPECT_TRUE(std::regex_match(
      text, std::regex(":10:1: about 1.37e\\+09 particles, 87.8 GB to read them: [0-9.]+ [MG]B are "
                       "free\n  hint: 'cells' whose product is smaller by a factor of [0-9.]+\n")))
      << text;
}

// Commands that run the machine for a few steps, too: 570 bytes a particle.
TEST_F(LimitsTest, AMachineThatIsLargerThanMemory) {
  constexpr Limits kLittle{.memory = uint64_t{500} << 20, .cpu_seconds = 20};
  const std::string scene = file("scene.toml", block("cells = [60, 60, 60]"));
  const std::vector<std::vector<std::string>> commands{{"boards", scene, "--nodes", "8"},
                                                       {"energy", scene},
                                                       {"crosscheck", scene},
                                                       {"emit", scene, "--out", bench_.path("project")}};
  for (const std::vector<std::string>& command : commands) {
    const Answer answer = bench_.cuboct(command, {}, kLittle);
    EXPECT_EQ(answer.code, 2) << command[0] << answer.err;
    EXPECT_TRUE(
        std::regex_search(answer.err, std::regex(":9:9: the machine takes about [0-9.]+ [MG]B of memory: ")))
        << command[0] << answer.err;
  }
  EXPECT_FALSE(std::filesystem::exists(bench_.path("project")));
}

TEST_F(LimitsTest, ABeamOfTooFineAPitch) {
  const std::string text = refusal(
      "density = \"7800 kg/m^3\"\n[packing]\npitch = \"0.05 mm\"\n[geometry]\nshape = \"box\"\n"
      "size = \"[200, 20, 20] mm\"\n[law]\nkind = \"ductile\"\nyoungs_modulus = \"200 GPa\"\n"
      "direction = [1, 0, 0]\n[run]\nduration = \"1 ms\"\n");
  EXPECT_TRUE(std::regex_search(
      text, std::regex("^:4:1: about 9\\.[0-9]+e\\+08 particles, [0-9.]+ GB to read them: ")))
      << text;
}

TEST_F(LimitsTest, APolygonOfTooManyPoints) {
  std::string x, y;
  for (int k = 0; k < 100'000; ++k) {
    x += fmt::format("{}{:.6f}", k > 0 ? "," : "", 50 * std::cos(k * 2e-5 * 3.14159265));
    y += fmt::format("{}{:.6f}", k > 0 ? "," : "", 50 * std::sin(k * 2e-5 * 3.14159265));
  }
  const std::string text =
      refusal(kHead + "[packing]\npitch = 1.1\n[geometry]\nshape = \"extrude\"\nx = [" + x + "]\ny = [" + y +
              "]\nthickness = 100.0\n[run]\ndt = 0.001\nsteps = 10\n");
  EXPECT_NE(text.find("held against 100000 parts of the geometry: at most 4e+09 tests are made"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("or fewer points"), std::string::npos) << text;
}

TEST_F(LimitsTest, TooManyMaterials) {
  std::string many;
  for (int k = 0; k < 30'000; ++k) many += fmt::format("[[material]]\nname = \"m{}\"\n", k);
  EXPECT_EQ(refusal(kHead + many + kPair + "[run]\ndt = 0.001\nsteps = 10\n"),
            ":520:1: more than 256 materials\n");
}

TEST_F(LimitsTest, ManyRegionsAreFound) {
  std::string many = "[regions]\n";
  for (int k = 0; k < 20'000; ++k) many += fmt::format("r{} = {{ shape = \"sphere\", radius = 1.0 }}\n", k);
  const Answer answer = check(kHead + many + kPair + "[run]\ndt = 0.001\nsteps = 10\n");
  EXPECT_EQ(answer.code, 0) << answer.err;
}

TEST_F(LimitsTest, Parentheses) {
  const auto nested = [](size_t depth) {
    return "[packing]\npitch = \"1 " + std::string(depth, '(') + "m" + std::string(depth, ')') + "\"\n";
  };
  EXPECT_EQ(refusal(nested(200'000)), ":2:9: 'pitch' is a text of 400003 bytes: at most 4096 are read\n");
  EXPECT_EQ(refusal(nested(2'000)),
            ":2:9: more than 64 parentheses within one another in \"1 " + std::string(58, '(') + "...\"\n");
}

TEST_F(LimitsTest, TablesWithinTables) {
  const auto repeated = [](const std::string& part) {
    std::string text;
    for (int k = 0; k < 200'000; ++k) text += part;
    return text;
  };
  EXPECT_EQ(refusal("title = \"...........\"\n" + repeated("a.") + "a = 1\n"),
            ":2:128: a key of more than 64 parts\n");
  EXPECT_EQ(refusal(std::string("[") + repeated("a.") + "a]\n"), ":1:129: a key of more than 64 parts\n");
  for (const char* open : {"[", "{a="})
    EXPECT_NE(refusal("a = " + repeated(open)).find("exceeded maximum nested value depth"), std::string::npos)
        << open;
}

TEST_F(LimitsTest, ParticlesBeyondAllNumbers) {
  EXPECT_EQ(
      refusal(kHead + "[[particle]]\nposition = [0, 0, 0]\n[[particle]]\nposition = [1e300, 0, 0]\n"
                      "[run]\ndt = 0.001\nsteps = 10\n"),
      ":8:1: particle 1 is more than 1e+09 cells of 2.5 m away\n  hint: particles nearer to one another\n");
}

TEST_F(LimitsTest, ABoxOfTooManyCells) {
  EXPECT_EQ(refusal(kHead + kPair +
                    "[box]\nsize = [1e12, 10, 10]\nperiodic = \"x\"\n[run]\ndt = 0.001\nsteps = 10\n"),
            ":13:8: the periodic box is 4e+11 cells of 2.5 m long: at most 1e+07 can be built\n");
}

// Of 3375 nodes, 195 bits each.
TEST_F(LimitsTest, APortWiderThanRtlHas) {
  const std::string scene =
      file("scene.toml", kHead +
                             "[[particle]]\nposition = [0, 0, 0]\n[[particle]]\nposition = [28, 28, 28]\n"
                             "[run]\ndt = 0.001\nsteps = 10\n");
  const std::string arch = file("arch.toml", "name = \"a\"\n[plan]\ncarry = [\"empty_nodes\"]\n");
  const Answer answer =
      bench_.cuboct({"emit", scene, "--arch", arch, "--out", bench_.path("rtl")}, {}, kSmall);
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(std::regex_match(
      answer.err,
      std::regex(".*scene.toml:8:1: RTL: the width of the lattice's observation port is [0-9]+: at "
                 "most 524288 can be emitted\n   8 \\| \\[\\[particle\\]\\]\n     \\| \\^\n")))
      << answer.err;
  EXPECT_FALSE(std::filesystem::exists(bench_.path("rtl")));
}

TEST_F(LimitsTest, ListsOfSteps) {
  const std::string scene = kHead + kPair + "[run]\ndt = 0.001\nsteps = 1000000000000\n";
  const auto run = [&](const std::string& text, std::vector<std::string> more) {
    more.insert(more.begin(), {"run", file("scene.toml", text)});
    return bench_.cuboct(more, {}, kSmall);
  };
  const std::string path = bench_.path("scene.toml");
  Answer answer = run(scene + "frame_every = 1\n", {});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(
      without_excerpt(answer.err),
      path +
          ":15:15: frame_every: every 1 of 1000000000000 steps are 1000000000001: at most 10000000 can be "
          "kept\n"
          "  hint: frame_every = 300000\n");
  // What cannot be listed is refused whatever else is asked, at the key that says so.
  for (const char* key : {"probe_every", "energy_every"}) {
    answer = run(scene + key + " = 1\n", {"--anyway"});
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(
        without_excerpt(answer.err),
        fmt::format("{}:15:{}: {}: every 1 of 1000000000000 steps are 1000000000001: at most 10000000 can "
                    "be kept\n  hint: {} = 300000\n",
                    path, std::string(key).size() + 4, key, key));
  }
  answer = run(scene, {"--frame-every", "7", "--out", bench_.path("project")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err,
            "--frame-every: every 7 of 1000000000000 steps are 142857142859: at most 10000000 can be kept\n"
            "  hint: --frame-every 300000\n");
  answer = run(scene, {"--hash-every", "1"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("8 TB of it for a hash every 1 steps of 1000000000000\n  hint: --hash-every "),
            std::string::npos)
      << answer.err;
  answer = run(scene, {"--cycles", "--hash-every", "1000000000"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find(" of it for the cycles of 1000000000000 steps\n  hint: --steps "),
            std::string::npos)
      << answer.err;
}

TEST_F(LimitsTest, FramesBeyondTheDisk) {
  const std::string out = bench_.path("results");
  const Answer answer = bench_.cuboct(
      {"run", "scenes/plate.toml", "--steps", "1000000", "--frame-every", "1", "--out", out}, 0, kSmall);
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(std::regex_match(
      answer.err, std::regex("the run takes about [0-9.]+ TB of disk, 1e\\+06 frames of [0-9.]+ MB "
                             "each: [0-9.]+ .B are free in .*\n  hint: --frame-every [0-9]+; "
                             "--anyway runs it all the same\n")))
      << answer.err;
  EXPECT_FALSE(std::filesystem::exists(out + "/trace.h5"));
  const Answer more = bench_.cuboct({"run", "scenes/plate.toml", "--steps", "1000000", "--frame-every", "1",
                                     "--checkpoint-every", "1 h", "--out", out},
                                    0, kSmall);
  EXPECT_EQ(more.code, 2);
  EXPECT_NE(more.err.find(" TB for checkpoints: "), std::string::npos) << more.err;
}

TEST_F(LimitsTest, ThreadsAndRanksBeyondTheMachine) {
  const auto run = [&](const char* option, const char* count) {
    return bench_.cuboct({"run", "scenes/lj_block.toml", "--steps", "2", option, count}, {},
                         {.cpu_seconds = 20});
  };
  Answer answer = run("--ranks", "1000");
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(std::regex_match(
      answer.err, std::regex("--ranks 1000: this machine has [0-9]+ cores? to use, and the scene 27 "
                             "nodes\n  hint: --ranks [0-9]+\n")))
      << answer.err;
  answer = run("--threads", "4096");
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(std::regex_match(
      answer.err,
      std::regex("--threads 4096: this machine has [0-9]+ cores? to use\n  hint: --threads [0-9]+; "
                 "--anyway runs it all the same\n")))
      << answer.err;
  // What the scene has no nodes for no yes can give it.
  answer = bench_.cuboct({"run", "scenes/lj_block.toml", "--steps", "2", "--ranks", "1000", "--anyway"}, {},
                         {.cpu_seconds = 20});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("and the scene 27 nodes"), std::string::npos) << answer.err;
}

// A command says so before it reads a file or makes one.
TEST_F(LimitsTest, ThreadsAndJobsOfEveryCommand) {
  const std::string scene = file("scene.toml", block("cells = [6, 6, 6]"));
  const std::vector<std::vector<std::string>> commands{
      {"run", scene, "--threads"},
      {"run", scene, "--engine", "reference", "--threads"},
      {"crosscheck", scene, "--engines", "golden,lattice", "--threads"},
      {"measure", "none", "rdf", "--threads"},
      {"stability", "none", "--threads"},
      {"elastic", "none", "--threads"},
      {"pitch", "none", "--threads"},
      {"multiscale", "none", "--threads"},
      {"bench", "none", "--threads"},
      {"explore", "none", "--jobs"},
      {"fit", "none", "--jobs"},
      {"learn", "none", "--jobs"}};
  size_t refused = 0;
  for (std::vector<std::string> words : commands) {
    const std::string told = fmt::format("{} {}: {}\n", words.back(), most_workers() + 1, cores_text());
    words.push_back(std::to_string(most_workers() + 1));
    Answer answer = bench_.cuboct(words, {}, kSmall);
    if (answer.err.find("was built without") != std::string::npos) continue;
    ++refused;
    EXPECT_EQ(answer.code, 2) << words[0];
    EXPECT_EQ(answer.out, "") << words[0];
    EXPECT_TRUE(answer.err.starts_with(told)) << words[0] << answer.err;
    EXPECT_TRUE(answer.err.ends_with("; --anyway runs it all the same\n")) << words[0] << answer.err;
    words.emplace_back("--anyway");
    answer = bench_.cuboct(words, {}, kSmall);
    EXPECT_EQ(answer.err.find("cores to use"), std::string::npos) << words[0] << answer.err;
    words[words.size() - 2] = std::to_string(most_workers());
    words.pop_back();
    answer = bench_.cuboct(words, {}, kSmall);
    EXPECT_EQ(answer.err.find("cores to use"), std::string::npos) << words[0] << answer.err;
  }
  EXPECT_GE(refused, 6u);
}

TEST_F(LimitsTest, ARunOfYears) {
  const std::string scene =
      file("scene.toml", kHead + kPair + "[run]\ndt = 0.001\nsteps = 1000000000000000\n");
  Answer answer = bench_.cuboct({"run", scene, "--engine", "reference"}, {}, kSmall);
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(std::regex_match(
      without_excerpt(answer.err),
      std::regex(".*scene.toml:14:9: the run takes about [0-9.e+]+ (days|years): 2e\\+15 particle-steps on "
                 "1 thread\n  hint: [0-9]+ steps would take a day; --anyway runs it all the same\n")))
      << answer.err;
  // The yes: it begins, and ends by its limit.
  answer = bench_.cuboct({"run", scene, "--engine", "reference", "--anyway"}, {}, {.cpu_seconds = 2});
  EXPECT_NE(answer.code, 2) << answer.err;
  EXPECT_EQ(answer.err.find("would take a day"), std::string::npos) << answer.err;
  answer = bench_.cuboct({"crosscheck", scene, "--engines", "golden,lattice"}, {}, kSmall);
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("--anyway runs it all the same"), std::string::npos) << answer.err;
}

TEST_F(LimitsTest, CountsOfYears) {
  const std::string scene = file("scene.toml", block("cells = [6, 6, 6]"));
  const std::vector<std::pair<std::vector<std::string>, std::string>> commands{
      {{"energy", scene, "--steps", "100000000000000"}, "--steps 100000000000000: that takes about "},
      {{"boards", scene, "--nodes", "8", "--steps", "100000000000000"},
       "--steps 100000000000000: that takes about "},
      {{"emit", scene, "--vector-steps", "100000000000", "--out", bench_.path("project")},
       "--vector-steps 100000000000: that takes about "},
      {{"bench", "lattice", "--repeats", "1000", "--seconds", "10000"},
       " with --repeats 1000 --seconds 10000: that takes about "}};
  for (const auto& [words, told] : commands) {
    const Answer answer = bench_.cuboct(words, {}, kSmall);
    EXPECT_EQ(answer.code, 2) << words[0] << answer.err;
    EXPECT_NE(answer.err.find(told), std::string::npos) << words[0] << answer.err;
    EXPECT_TRUE(answer.err.ends_with("; --anyway runs it all the same\n")) << words[0] << answer.err;
  }
  EXPECT_FALSE(std::filesystem::exists(bench_.path("project")));
}

#ifdef CUBOCT_HAS_STUDIES
TEST_F(LimitsTest, AStudyBeyondTheMachine) {
  const std::string study = file("study.toml",
                                 "scene = \"scene.toml\"\n[[figure]]\nkind = \"mean\"\nname = \"p\"\n"
                                 "curve = \"energy.potential\"\n[[sweep]]\nstrength_bits = [18, 20]\n");
  const std::string out = bench_.path("results");
  const auto explore = [&](const std::string& scene, const Limits& limits) {
    file("scene.toml", scene);
    return bench_.cuboct({"explore", study, "--jobs", "2", "--out", out}, {}, limits);
  };
  std::string years = block("cells = [6, 6, 6]");
  years.replace(years.find("steps = 10"), 10, "steps = 10000000000000");
  Answer answer = explore(years, kSmall);
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(
      std::regex_match(answer.err, std::regex("2 points: that takes about [0-9.]+ (days|years)\n"
                                              "  hint: fewer points or a shorter run; --anyway runs it "
                                              "all the same\n")))
      << answer.err;
  answer = explore(block("cells = [40, 40, 40]"), {.memory = uint64_t{400} << 20, .cpu_seconds = 20});
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(std::regex_search(
      answer.err, std::regex("^2 points at once: that takes about [0-9.]+ MB of memory: [0-9.]+ MB are free\n"
                             "  hint: --jobs 1, a larger pitch or a smaller geometry; --anyway ")))
      << answer.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}
#endif

TEST_F(LimitsTest, MatricesAndPitchesBeyondMemory) {
  constexpr Limits kLittle{.memory = uint64_t{500} << 20, .cpu_seconds = 20};
  const std::string scene = file("scene.toml", block("cells = [40, 40, 40]"));
  const std::vector<std::pair<std::vector<std::string>, std::string>> commands{
      {{"stability", scene}, "256000 particles: that takes about 768 MB of memory: "},
      {{"elastic", file("small.toml", block("cells = [20, 20, 20]"))},
       "32000 particles: that takes about 640 MB of memory: "},
      {{"pitch", scene, "--particles", "2000000"}, "--particles 2000000: that takes about "}};
  for (const auto& [words, told] : commands) {
    const Answer answer = bench_.cuboct(words, {}, kLittle);
    if (answer.err.find("was built without") != std::string::npos) continue;
    EXPECT_EQ(answer.code, 2) << words[0] << answer.err;
    EXPECT_NE(answer.err.find(told), std::string::npos) << words[0] << answer.err;
    EXPECT_NE(answer.err.find("; --anyway runs it all the same\n"), std::string::npos) << answer.err;
  }
}

// The estimates of `check` against what a run takes.
class EstimateTest : public LimitsTest {
 protected:
  static double value(const std::string& json, const std::string& name) {
    std::smatch found;
    const std::regex item("\"" + name + "\": \\{\"value\": ([0-9.e+]+)");
    EXPECT_TRUE(std::regex_search(json, found, item)) << name << " in " << json;
    return found.empty() ? 0 : std::stod(found[1]);
  }
  static double size_of(const std::string& directory) {
    uintmax_t sum = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
      if (entry.is_regular_file()) sum += entry.file_size();
    return static_cast<double>(sum);
  }
};

TEST_F(EstimateTest, HoldWithinAFactorOfTwo) {
  for (const char* scene : {"scenes/coupon.toml", "scenes/sheet.toml", "scenes/bench/block_32k.toml"}) {
    std::string text =
        std::regex_replace(contents(CUBOCT_SOURCE_DIR "/" + std::string(scene)),
                           std::regex("\n(steps|duration|frame_every|probe_every) *=[^\n]*"), "");
    text = std::regex_replace(text, std::regex("\n\\[run\\]"),
                              "\n[run]\nsteps = 60\nframe_every = 10\nprobe_every = 5");
    const std::string path = file("scene.toml", text), out = bench_.path("results");
    const std::string told = bench_.cuboct({"check", path, "--json"}).out;
    const Answer ran = bench_.cuboct({"run", path, "--threads", "1", "--out", out, "--json"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(value(told, "particles"), value(ran.out, "particles")) << scene;
    EXPECT_EQ(value(told, "particle-steps"), 60 * value(ran.out, "particles")) << scene;
    const double disk = value(told, "disk") / size_of(out);
    EXPECT_GT(disk, 0.5) << scene;
    EXPECT_LT(disk, 2) << scene;
    // kB; smaller runs are all program.
    const double memory = value(told, "memory") / (1024 * static_cast<double>(ran.peak_kb));
    EXPECT_GT(memory, 0.5) << scene;
    EXPECT_LT(memory, 2) << scene;
    EXPECT_GT(value(told, "time"), 0) << scene;
    std::filesystem::remove_all(out);
  }
}

}  // namespace
}  // namespace cuboct::test
