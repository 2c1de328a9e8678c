// SPDX-License-Identifier: MIT
// --json: one document on stdout and nothing else, whatever the command; errors as JSON, of engines too.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "model/base/output.h"
#include "model/config/config.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

using Json = nlohmann::json;
using Strings = std::vector<std::string>;

const std::string kGrips = CUBOCT_SOURCE_DIR "/scenes/boards/grips.toml";

Json document(const Bench& bench, Strings arguments, int code = 0) {
  arguments.push_back("--json");
  const Answer answer = bench.cuboct(arguments);
  EXPECT_EQ(answer.code, code) << answer.out << answer.err;
  EXPECT_TRUE(Json::accept(answer.out)) << arguments[0] << ": " << answer.out;
  return Json::parse(answer.out, nullptr, false);
}

TEST(Json, ACrosscheckTellsItsVerdict) {
  const Bench bench(true);
  const Strings words{"crosscheck", "scenes/lj_block.toml", "--steps", "5",
                      "--engines",  "golden,systemc,rtl"};
  Json json = document(bench, words);
  EXPECT_EQ(json["verdict"]["value"], "matched");
  EXPECT_EQ(json["updates"]["value"], 1280);
  EXPECT_EQ(json["phase_times"]["value"], 1080);
  EXPECT_EQ(json["engines"]["value"].size(), 3u);
  EXPECT_EQ(json["engines"]["value"][2]["name"], "rtl");
  setenv("LIE", "state", 1);
  json = document(bench, words, 1);
  unsetenv("LIE");
  EXPECT_EQ(json["verdict"]["value"], "mismatch");
  EXPECT_EQ(json["mismatch"]["value"].get<std::string>().find("step 3, state hash: golden "), 0u);
  EXPECT_NE(json["first_difference"]["value"].get<std::string>().find("particle 17, v.y"), std::string::npos);
}

// The engine's program tells its error in a file; the command tells it in the form that is asked for.
TEST(Json, AnEnginesErrorIsTheCommands) {
  const Bench bench(true);
  Strings words{"crosscheck", "scenes/lj_block.toml", "--steps", "5", "--engines", "golden,rtl"};
  setenv("LIE", "refuse", 1);
  EXPECT_EQ(bench.cuboct(words).err, "refused by the fake engine\n");
  words.push_back("--json");
  Answer answer = bench.cuboct(words);
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.out, "");
  EXPECT_EQ(Json::parse(answer.err)["error"]["message"], "refused by the fake engine");
  setenv("LIE", "nothing", 1);
  answer = bench.cuboct(words);
  unsetenv("LIE");
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(Json::parse(answer.err)["error"]["message"], "cuboct-rtl ended with exit code 1");
}

TEST(Json, EveryOtherCommandHasADocument) {
  const Bench bench(false);
  const std::string scene = bench.path("made.toml");
  EXPECT_EQ(document(bench, {"new", scene, "--like", "gas"})["file"], scene);
  const std::string out = bench.path("run");
  ASSERT_EQ(bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "4", "--out", out}).code, 0);
  EXPECT_EQ(document(bench, {"picture", out})["file"], out + "/picture.png");
  EXPECT_EQ(document(bench, {"report", out})["file"], out + "/report.html");
  const Json emitted = document(bench, {"emit", "scenes/lj_block.toml", "--out", bench.path("rtl")});
  EXPECT_EQ(emitted["nodes"]["value"], 27);
  EXPECT_EQ(emitted["plan_hash"]["value"].get<std::string>().size(), 16u);
#ifdef CUBOCT_HAS_STUDIES
  const Json bench_json =
      document(bench, {"bench", "lattice.block_32k.1_thread", "--seconds", "0.01", "--repeats", "1"});
  ASSERT_GE(bench_json["results"].size(), 1u);
  EXPECT_GT(bench_json["results"][0]["value"].get<double>(), 0);
  EXPECT_EQ(bench_json["results"][0]["unit"], "1/s");
  const Json study =
      document(bench, {"explore", "scenes/studies/block.toml", "--no-speed", "--out", bench.path("block")});
  EXPECT_GT(study["points"].get<int>(), 0);
  ASSERT_FALSE(study["best"].empty());
  EXPECT_GT(study["best"][0]["cost"].get<double>(), 0);
#endif
}

// All stages, each from where the engines ended the one before: the same states as those of a run.
TEST(Crosscheck, TakesAllStages) {
  const Bench bench(false);
  const std::string scene = bench.path("stages.toml");
  write_text(scene,
             read_config_text(kGrips) +
                 "\n[[stage]]\nname = \"up\"\nsteps = 12\nparts = 3\n"
                 "until = { probe = \"grip.force_x\", beyond = 0.001 }\nprobe_every = 4\n"
                 "constraint = [{ name = \"right\", velocity = { from = [0, 0, 0], to = [0.04, 0, 0] } }]\n"
                 "\n[[stage]]\nname = \"hold\"\nsteps = 6\n");
  const std::string out = bench.path("crossed");
  const Strings words{"crosscheck", scene, "--engines", "golden,lattice", "--out", out};
  const Answer answer = bench.cuboct(words);
  ASSERT_EQ(answer.code, 0) << answer.out << answer.err;
  const Json json = document(bench, words);
  ASSERT_EQ(bench.cuboct({"run", scene, "--out", bench.path("run"), "--hash-every", "1"}).code, 0);
  size_t stages = 0;
  for (const std::string name : {"1-up-1", "2-up-2", "3-up-3", "4-hold"}) {
    EXPECT_EQ(std::filesystem::exists(out + "/" + name), std::filesystem::exists(bench.path("run/" + name)));
    if (!std::filesystem::exists(out + "/" + name)) continue;
    EXPECT_NE(answer.out.find("stage " + name + "\nmatched "), std::string::npos) << answer.out;
    EXPECT_EQ(json["stages"][stages]["result"]["verdict"]["value"], "matched");
    EXPECT_EQ(read_trace(out + "/" + name + "/golden.h5").state_hash,
              read_trace(bench.path("run/" + name + "/trace.h5")).state_hash)
        << name;
    ++stages;
  }
  EXPECT_EQ(json["stages"].size(), stages);
  EXPECT_LT(stages, 4u);  // `until` held in a part
  EXPECT_GT(stages, 1u);
  EXPECT_NE(bench.cuboct({"crosscheck", scene, "--engines", "golden,lattice", "--steps", "2"})
                .err.find("--steps goes with --stage NAME"),
            std::string::npos);
}

TEST(Emit, TakesAllStages) {
  const Bench bench(false);
  const std::string scene = bench.path("stages.toml");
  write_text(scene, read_config_text(kGrips) +
                        "\n[[stage]]\nname = \"pull\"\nsteps = 6\n\n[[stage]]\nname = \"hold\"\nsteps = 5\n"
                        "constraint = [{ name = \"right\", velocity = [0, 0, 0] }]\n");
  const std::string rtl = bench.path("rtl");
  EXPECT_NE(bench.cuboct({"emit", scene, "--out", rtl}).err.find("--from DIR says where"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(rtl));
  ASSERT_EQ(bench.cuboct({"run", scene, "--out", bench.path("run")}).code, 0);
  const Json json = document(bench, {"emit", scene, "--from", bench.path("run"), "--out", rtl});
  ASSERT_EQ(json["stages"].size(), 2u);
  EXPECT_NE(json["stages"][0]["result"]["plan_hash"], json["stages"][1]["result"]["plan_hash"]);
  ASSERT_EQ(bench
                .cuboct({"emit", scene, "--stage", "hold", "--from", bench.path("run/1-pull"), "--out",
                         bench.path("one")})
                .code,
            0);
  EXPECT_EQ(contents(rtl + "/2-hold/project.json"), contents(bench.path("one/project.json")));
}

}  // namespace
}  // namespace cuboct::test
