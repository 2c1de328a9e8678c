// SPDX-License-Identifier: MIT
// What `cuboct check` says of what a plan leaves out, word for word.
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "model/base/output.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

std::string not_built(std::vector<std::string> arguments) {
  if (arguments.back() != "--json") arguments.push_back("--machine");
  const Answer answer = Bench(false).cuboct(arguments);
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.err, "");
  const size_t from = answer.out.find(arguments.back() == "--json" ? "  \"not_built\"" : "not built"),
               to = answer.out.find("plan hash");
  return answer.out.substr(from, (to == std::string::npos ? answer.out.find("  \"plan_hash\"") : to) - from);
}

TEST(Check, NamesWhatIsNotBuilt) {
  EXPECT_EQ(
      not_built({"check", "scenes/hot_cluster.toml"}),
      R"(not built                        damping, velocity in the halo record, pair scales, types, PD controllers, masses
not built damping                93 bit (of a halo record, 0 of a particle record; velocities, a table, 2 cycles of the pipe)
not built pair scales            1 bit (of a halo record, 1 of a particle record; types, a table, 2 cycles of the pipe)
not built types                  0 bit (of a halo record, 1 of a particle record; types)
not built PD controllers         0 bit (of a halo record, 93 of a particle record; displacements, 3 cycles of the update)
not built masses                 0 bit (of a halo record, 0 of a particle record; a product per axis, 2 cycles of the update)
halo record with everything      158 bit (64 as built)
particle record with everything  288 bit (194 as built)
)");
  EXPECT_EQ(not_built({"check", "scenes/sheet.toml"}),
            R"(not built                        pair scales, PD controllers, masses, third axis
not built pair scales            2 bit (of a halo record, 0 of a particle record; types, a table, 2 cycles of the pipe)
not built PD controllers         0 bit (of a halo record, 58 of a particle record; displacements, 3 cycles of the update)
not built masses                 0 bit (of a halo record, 0 of a particle record; a product per axis, 2 cycles of the update)
not built third axis             51 bit (of a halo record, 59 of a particle record; 2 of 8 phases, and all that works along z)
halo record with everything      153 bit (100 as built)
particle record with everything  276 bit (130 as built)
)");
  EXPECT_EQ(not_built({"check", "scenes/sheet.toml", "--arch", "scenes/archs/everything.toml"}),
            R"(not built                        nothing is left out
halo record with everything      153 bit (153 as built)
particle record with everything  276 bit (276 as built)
)");
}

// Two particles at the corners of a large box: 27 cells around each.
TEST(Check, CountsTheCellsThatTheLatticeLacks) {
  const Bench bench(false);
  std::ofstream(bench.path("two.toml")) << "units = \"reduced\"\nmass = 1.0\n"
                                           "[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n"
                                           "[[particle]]\nposition = [0.0, 0.0, 0.0]\n"
                                           "[[particle]]\nposition = [20.0, 20.0, 20.0]\n"
                                           "[run]\ndt = 0.001\nsteps = 20\n";
  const Answer answer = bench.cuboct({"check", bench.path("two.toml"), "--machine"});
  EXPECT_NE(answer.out.find("PD controllers, masses, empty nodes\n"), std::string::npos) << answer.out;
  EXPECT_NE(
      answer.out.find("not built empty nodes            1277 cells (of 1331 cells of the bounding box are "
                      "not in the lattice)\n"),
      std::string::npos)
      << answer.out;
}

// With --machine and without: a rule of text has one machine, whose records its rounds have.
TEST(Check, TellsTheMachineOfARuleOfText) {
  const auto told = [](std::vector<std::string> words) {
    const Answer answer = Bench(false).cuboct(words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    std::string lines;
    std::istringstream in(answer.out);
    for (std::string line; std::getline(in, line);)
      if (line.starts_with("machine")) lines += std::regex_replace(line, std::regex(" +"), " ") + "\n";
    return lines;
  };
  const std::string plain = told({"check", "scenes/rules/heat.toml"});
  EXPECT_TRUE(std::regex_match(plain, std::regex("machine \\d+ nodes of \\d+ slots of \\d+ bits\n"
                                                 "machine of conduct a record of [^\n]*\n")))
      << plain;
  EXPECT_EQ(told({"check", "scenes/rules/heat.toml", "--machine"}), plain);
}

// A field without a unit: what its resolution leaves is no share of the curve.
TEST(Check, TellsWhatAResolutionCosts) {
  const Bench bench(false);
  const std::string path = bench.path("dry.toml");
  write_text(path,
             "density = \"0.5 g/cm^3\"\npacking.pitch = \"0.5 mm\"\nbox.cells = [12, 4, 4]\n"
             "run = { dt = \"15 s\", steps = 400, probe_every = 50 }\nreach.margin = \"auto\"\n"
             "[[probe]]\nname = \"left\"\nkind = \"field\"\nfield = \"wet\"\n"
             "region = { shape = \"half_space\", point = \"[2.4, 0, 0] mm\", normal = \"x\" }\n"
             "[rule]\nreach = \"1.2 * pitch\"\nstill = true\n"
             "particle.wet = { range = [0, 1], start = \"x.x / (20 * pitch)\", resolution = 1e-5 }\n"
             "[[rule.round]]\nsum.flow = \"0.004 * (wet_j - wet_i)\"\nfinish.wet = \"wet + flow\"\n");
  const Answer answer = bench.cuboct({"check", path});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("wet within about 0.000153; the resolution of wet\n"), std::string::npos)
      << answer.out;
  const std::string json = bench.cuboct({"check", path, "--json"}).out;
  EXPECT_NE(json.find("\"unit\": \"number\""), std::string::npos) << json;
}

TEST(Check, SaysWhatSetsTheLimitOfDt) {
  const auto limit = [](const std::string& scene) {
    const std::string out = Bench(false).cuboct({"check", scene, "--machine"}).out;
    const size_t from = out.find("\ndt limit ");
    return out.substr(from, out.find('\n', from + 1) - from);
  };
  EXPECT_TRUE(limit("scenes/coupon.toml").ends_with(" s (largest stable step of the perfect packing)"));
  EXPECT_TRUE(limit("scenes/failures/stiff_hold.toml")
                  .ends_with(" s (largest stable step of the particles that are listed)"));
}

// Physics first, in units that people read: the bar of bonds k = 1 MN/m carries waves at pitch sqrt(k/m).
TEST(Check, TellsPhysics) {
  const Answer answer = Bench(false).cuboct({"check", "scenes/sheet.toml"});
  EXPECT_EQ(answer.err, "");
  EXPECT_TRUE(std::regex_match(
      answer.out,
      std::regex("scene       scenes/sheet.toml\n"
                 "title       Notched sheet of one layer, torn\n"
                 "body        30 mm x 19.9 mm, 2818 particles of 125 ug, 500 um apart\n"
                 "waves       1.42 km/s, 21.2 us from end to end\n"
                 "run         6226 steps of 48.2 ns = 300 us, 14.2 crossings\n"
                 "step        0.2 of 241 ns, the largest stable one of the perfect packing\n"
                 "strain      about 10 %, by the velocity imposed on 'matter/pulled'\n"
                 "layers      121 x 47 x 1 along x, y and z, 250 um, 433 um and 408 um apart\n"
                 "section     11.8 mm\\^2 across y at 7.14 mm, 101 % of the shape's; another place of the "
                 "packing makes 100 to 101 %, and 100 to 103 % of its bending stiffness\n"
                 "work        17.5 million particle-steps, about [0-9.]+ s on [0-9]+ threads?, [0-9.]+ MB of "
                 "memory\n"
                 "probes      one every 50 steps, (about [0-9]+|less than 1) % of the processor time\n"
                 "energy      one every 200 steps, (about [0-9]+|less than 1) % of the processor time: one "
                 "costs about "
                 "[0-9.]+ steps\n"
                 "probe pull  force within about 0.14 % until bonds break; the force table at 10 % strain\n"
                 "disk        [0-9.]+ MB with --out, 2 frames\n"
                 "machine     [0-9]+ nodes; --machine tells formats, records and cycles\n")))
      << answer.out;
  // A box that repeats, of plain numbers.
  const std::string gas = Bench(false).cuboct({"check", "scenes/lj_block.toml"}).out;
  EXPECT_NE(gas.find("repeats along xyz, 256 particles of mass 1, 1.11 apart\n"), std::string::npos) << gas;
}

// A rule of text takes the time of its operations: a pair's noise, a hash of many steps, more than all else
// of it.
TEST(Check, CountsTheOperationsOfARuleOfText) {
  const Bench bench(false);
  const auto seconds = [&](const std::string& more) {
    write_text(
        bench.path("rule.toml"),
        "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nrun = { dt = \"0.2 us\", steps = 1000 }\n"
        "[box]\nperiodic = \"xyz\"\ncells = [12, 12, 12]\n[rule]\nreach = \"1.3 * pitch\"\n"
        "[[rule.round]]\nsum.force = \"1 kN/m * (r - pitch)" +
            more + " * d / r\"\n");
    const std::string out = bench.cuboct({"check", bench.path("rule.toml")}).out;
    std::smatch work;
    if (!std::regex_search(out, work, std::regex("particle-steps, about ([0-9.]+) s on"))) {
      ADD_FAILURE() << out;
      return 0.0;
    }
    return std::stod(work[1]);
  };
  const double plain = seconds(""), noisy = seconds(" * (1 + noise(7))");
  EXPECT_GT(noisy, 5 * plain);
  EXPECT_LT(noisy, 40 * plain);
}

// With numbers for scripts, and the formats' reasons where a probe asks for its accuracy.
TEST(Check, TellsWhatProbesAreOffBy) {
  const Bench bench(false);
  const std::string path = bench.path("bar.toml");
  ASSERT_EQ(bench.cuboct({"new", path, "--like", "tension"}).code, 0);
  std::string text = contents(path);
  const auto with = [&](const std::string& accuracy) {
    std::string changed = text;
    changed.insert(changed.find("area = "), "accuracy = " + accuracy + "\n");
    std::ofstream(path) << changed;
  };
  EXPECT_NE(
      bench.cuboct({"check", path, "--json"})
          .out.find(
              "  \"probe_tension\": {\"value\": \"stress within about 0.2 %, strain 0.049 % until bonds "
              "break; the force table at 7.5 % strain\", \"errors\": [{\"quantity\": \"stress\", "
              "\"error\": 0.0019"),
      std::string::npos);
  with("0.001");
  const std::string machine = bench.cuboct({"check", path, "--machine"}).out;
  EXPECT_NE(machine.find("strength bits                    21 (by the accuracy of probe 'tension')\n"),
            std::string::npos)
      << machine;
  with("1e-6");
  const Answer refused = bench.cuboct({"check", path});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(
      refused.err.find("the stress of probe 'tension' cannot be had within 1e-06: the best that formats do"),
      std::string::npos)
      << refused.err;
}

// The bar of the template, whose waves travel at 1.46 km/s: `check`, the run and its report say it.
TEST(Check, WarnsOfGripsThatOutrunWaves) {
  const Bench bench(false);
  const std::string path = bench.path("bar.toml");
  ASSERT_EQ(bench.cuboct({"new", path, "--like", "tension"}).code, 0);
  std::string text = contents(path);
  const auto pulled_at = [&](const std::string& speed) {
    const size_t at = text.find("velocity = \"["), end = text.find(',', at);
    text.replace(at, end - at, "velocity = \"[" + speed);
    std::ofstream(path) << text;
    return bench.cuboct({"check", path}).out;
  };
  const std::string warning =
      "warning: 'matter/pulled' is moved at 4000 m/s, 2.7 times as fast as waves travel, 1459 m/s: it tears "
      "off, or through, as nothing can follow\n";
  EXPECT_NE(pulled_at("4000").find(warning), std::string::npos) << pulled_at("4000");
  for (const char* engine : {"lattice", "reference"}) {
    const Answer ran = bench.cuboct({"run", path, "--engine", engine, "--steps", "60", "--quiet"});
    EXPECT_NE(ran.out.find(warning), std::string::npos) << ran.out;
  }
  EXPECT_EQ(pulled_at("1400").find("warning"), std::string::npos);
}

TEST(Check, NamesItInJsonToo) {
  EXPECT_EQ(not_built({"check", "scenes/coupon.toml", "--json"}),
            R"(  "not_built": {"value": "pair scales, PD controllers, masses"},
  "not_built_pair_scales": {"value": 2, "unit": "bit", "note": "of a halo record, 0 of a particle record; types, a table, 2 cycles of the pipe"},
  "not_built_PD_controllers": {"value": 0, "unit": "bit", "note": "of a halo record, 87 of a particle record; displacements, 3 cycles of the update"},
  "not_built_masses": {"value": 0, "unit": "bit", "note": "of a halo record, 0 of a particle record; a product per axis, 2 cycles of the update"},
  "halo_record_with_everything": {"value": 153, "unit": "bit", "note": "151 as built"},
  "particle_record_with_everything": {"value": 276, "unit": "bit", "note": "189 as built"},
)");
}

}  // namespace
}  // namespace cuboct::test
