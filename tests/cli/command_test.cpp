// SPDX-License-Identifier: MIT
// What the command line refuses, word for word.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>

#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

TEST(Command, RefusesUnknownWordsWithTheNearestSpelling) {
  expect_refusal(
      {},
      "no command\n  hint: one of new, check, run, crosscheck, emit, synth, energy, boards, elastic, "
      "multiscale, explore, "
      "fit, learn, pitch, stability, bench, "
      "curves, measure, state, picture, view or report; see 'cuboct --help'\n");
  expect_refusal({"chek"}, "unknown command 'chek'\n  hint: did you mean 'check'?\n");
  expect_refusal({"simulate"},
                 "unknown command 'simulate'\n  hint: one of new, check, run, crosscheck, emit, synth, "
                 "energy, boards, elastic, multiscale, explore, "
                 "fit, learn, pitch, stability, bench, curves, measure, state, picture, view or report\n");
  expect_refusal({"--verbose"}, "unknown option '--verbose'\n  hint: see 'cuboct --help'\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--stepz", "3"},
                 "unknown option '--stepz' of 'cuboct run'\n  hint: did you mean '--steps'?\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--quux=3"},
                 "unknown option '--quux' of 'cuboct run'\n  hint: see 'cuboct run --help'\n");
  expect_refusal({"run", "scenes/lj_block.toml", "-z"},
                 "unknown option '-z' of 'cuboct run'\n  hint: see 'cuboct run --help'\n");
}

TEST(Command, TellsItsVersionAndTheEnginesBesideIt) {
  const Bench bench(true);
  std::filesystem::copy(CUBOCT_LATTICE, bench.path("bin/cuboct-lattice"));
  const Answer answer = bench.cuboct({"--version"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.err, "");
  EXPECT_TRUE(std::regex_match(answer.out, std::regex("cuboct " CUBOCT_VERSION "\n"
                                                      "commit     (unknown|[-.0-9A-Za-z]+)\n"
                                                      "golden     built in\n"
                                                      "lattice    built in(, without MPI|; ranks over MPI: "
                                                      "cuboct-lattice)\n"
                                                      "systemc    cuboct-systemc\n"
                                                      "rtl        cuboct-rtl\n"
                                                      "fpga       no program cuboct-fpga beside cuboct\n"
                                                      "gpu        no program cuboct-gpu beside cuboct\n"
                                                      "reference  built in\n"
                                                      "studies    (built in|left out)\n"
                                                      "fits       (built in|left out)\n"
                                                      "synthesis  (built in|left out)\n"
                                                      "view       (built in|left out)\n")))
      << answer.out;
}

// A line of the file stands between message and hint.
TEST(Command, ShowsTheLineThatIsWrong) {
  const Bench bench(false);
  const std::string path = bench.path("a.toml");
  std::ofstream(path) << "units = \"reduced\"\n\tmas\x1b = 1\n";
  const Answer broken = bench.cuboct({"check", path});
  EXPECT_EQ(broken.code, 2);
  EXPECT_TRUE(std::regex_search(broken.err, std::regex("^[^\n]*a.toml:2:5: [^\n]*\n"
                                                       "   2 |  mas\\\\x1b = 1\n"
                                                       "     \\|     \\^\n$")))
      << broken.err;
  std::ofstream(path) << "units = \"reduced\"\nmass = 1\n[run]\n  dt = 0.1\n[law]\nkind = \"lk\"\n";
  const Answer wrong = bench.cuboct({"check", path});
  EXPECT_EQ(wrong.err, path +
                           ":6:8: unknown law 'lk'\n"
                           "   6 | kind = \"lk\"\n"
                           "     |        ^\n"
                           "  hint: did you mean 'lj'?\n");
}

TEST(Command, RefusesWrongValues) {
  const std::string usage = "  hint: usage: cuboct run [OPTIONS] SCENE\n";
  expect_refusal({"run"}, "no scene is given\n" + usage);
  expect_refusal({"run", "scenes/lj_block.toml", "--steps"}, "the option '--steps' has no value\n" + usage);
  expect_refusal({"run", "scenes/lj_block.toml", "--steps", "1", "--steps", "2"},
                 "the option '--steps' is given twice\n" + usage);
  expect_refusal({"run", "scenes/lj_block.toml", "scenes/coupon.toml"},
                 "one word too many: 'scenes/coupon.toml'\n" + usage);
  expect_refusal({"elastic", "scenes/lj_block.toml", "--strain", "abc"},
                 "the option '--strain' takes a number, not 'abc'\n"
                 "  hint: usage: cuboct elastic [OPTIONS] [SCENE]\n");
  expect_refusal(
      {"measure", "out/melt"},
      "no measure is given\n"
      "  hint: usage: cuboct measure [OPTIONS] DIR WHAT; WHAT: rdf, msd, coordination, cna or stress\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--steps", "-3"},
                 "--steps: '-3' is not a whole number below 2^63\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--steps", "many"},
                 "--steps: 'many' is not a whole number below 2^63\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--steps", "a\nb"},
                 "--steps: 'a\\nb' is not a whole number below 2^63\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--steps", "99999999999999999999"},
                 "--steps: '99999999999999999999' is not a whole number below 2^63\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--engine", "goldn"},
                 "unknown engine 'goldn'\n  hint: did you mean 'golden'?\n");
  expect_refusal(
      {"run", "scenes/lj_block.toml", "--engine", "quantum"},
      "unknown engine 'quantum'\n  hint: one of golden, lattice, systemc, rtl, fpga, gpu or reference\n");
  expect_refusal(
      {"crosscheck", "scenes/lj_block.toml", "--engines", "golden"},
      "a crosscheck needs two or more different engines\n  hint: --engines golden,lattice,systemc,rtl\n");
  expect_refusal(
      {"crosscheck", "scenes/lj_block.toml", "--engines", "golden,golden"},
      "a crosscheck needs two or more different engines\n  hint: --engines golden,lattice,systemc,rtl\n");
  expect_refusal(
      {"crosscheck", "scenes/lj_block.toml", "--engines", "golden,reference"},
      "engine 'reference' computes in doubles and has no bits to compare\n  hint: one of golden, lattice, "
      "systemc, rtl, fpga or gpu\n");
}

TEST(Command, RefusesOptionsOfAnotherEngine) {
  const std::vector<std::string> systemc{"run", "scenes/lj_block.toml", "--engine", "systemc"};
  for (const auto& [option, owners] :
       std::vector<std::pair<std::vector<std::string>, std::string>>{{{"--ranks", "2"}, "the lattice"},
                                                                     {{"--cycles"}, "the lattice"},
                                                                     {{"--gpus", "2"}, "the gpu"},
                                                                     {{"--joules"}, "the gpu"},
                                                                     {{"--port", "/dev/null"}, "the fpga"}}) {
    std::vector<std::string> arguments = systemc;
    arguments.insert(arguments.end(), option.begin(), option.end());
    expect_refusal(arguments, option[0] + " is an option of " + owners + " engine, not of systemc\n");
  }
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--resume"}, {"--checkpoint-every", "5 min"}}) {
    std::vector<std::string> arguments = systemc;
    arguments.insert(arguments.end(), option.begin(), option.end());
    expect_refusal(arguments,
                   option[0] +
                       " is an option of the golden, the lattice, the fpga, the gpu and the "
                       "reference engine, not of systemc\n  hint: its nodes are never all at the same "
                       "step: a node begins one while others end the last\n");
  }
  expect_refusal({"run", "scenes/lj_block.toml", "--engine", "golden", "--threads", "2"},
                 "--threads is an option of the lattice, the systemc, the rtl and the reference engine, not "
                 "of golden\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--engine", "reference", "--ranks", "2"},
                 "--ranks is an option of the lattice engine, not of reference\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--precision", "float"},
                 "--precision is an option of the gpu and the reference engine, not of lattice\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--engine", "golden", "--integrator", "verlet"},
                 "--integrator is an option of the reference engine, not of golden\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--engine", "reference", "--precision", "half"},
                 "--precision: half not in {fixed,float,double}\n");
  expect_refusal(
      {"run", "scenes/rules/heat.toml", "--rule-code", "interpreted"},
      "--rule-code interpreted is an option of the lattice and the gpu engine, not of reference\n");
  expect_refusal(
      {"crosscheck", "scenes/rules/heat.toml", "--engines", "golden,gpu", "--rule-code", "compiled"},
      "--rule-code compiled is an option of the lattice engine, not of golden,gpu\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--rule-code", "compiled"},
                 "--rule-code is of a [rule] of text with rounds of its own\n  hint: the pair law is "
                 "compiled already\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--stall-rate", "0.2"},
                 "--stall-rate is an option of the systemc and the rtl engine, not of lattice\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--resume"},
                 "--resume needs --out DIR, where the checkpoint lies\n");
  expect_refusal({"run", "scenes/lj_block.toml", "--checkpoint-every", "5 min"},
                 "--checkpoint-every needs --out DIR, where the checkpoint lies\n");
}

// A script's variable that was never set.
TEST(Command, RefusesAnEmptyValue) {
  const std::string hint = "  hint: leave it out, or see 'cuboct run --help'\n";
  expect_refusal({"run", "scenes/lj_block.toml", "--out", ""}, "the value of '--out' is empty\n" + hint);
  expect_refusal({"run", "scenes/lj_block.toml", "--out="}, "the value of '--out' is empty\n" + hint);
  expect_refusal({"run", "scenes/lj_block.toml", "--arch", ""}, "the value of '--arch' is empty\n" + hint);
  expect_refusal({"run", ""}, "argument 1 of 'cuboct run' is empty\n" + hint);
  expect_refusal(
      {"picture", ""},
      "argument 1 of 'cuboct picture' is empty\n  hint: leave it out, or see 'cuboct picture --help'\n");
}

TEST(Command, RefusesOptionsOfWhatIsNotKept) {
  for (const std::vector<std::string>& option :
       std::vector<std::vector<std::string>>{{"--frame-every", "5"}, {"--raster", "100"}, {"--no-states"}}) {
    std::vector<std::string> arguments{"run", "scenes/lj_block.toml"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    expect_refusal(arguments, option[0] + " needs --out DIR: without it nothing of the run is kept\n");
  }
}

TEST(Command, RefusesALimitThatIsNoLength) {
  for (const char* limit : {"0", "nan", "-1", "inf", "1x"})
    expect_refusal({"picture", "scenes", "--limit", limit},
                   std::string("--limit: '") + limit + "' is not a number above 0\n");
}

TEST(Command, RefusesRanksThatItCannotStart) {
  expect_refusal({"run", "scenes/lj_block.toml", "--ranks", "2"},
                 "--ranks 2: no program cuboct-lattice beside cuboct\n");
}

TEST(Command, NamesAFileThatIsNotThere) {
  for (const char* command : {"check", "run", "crosscheck"})
    expect_refusal({command, "scenes/none.toml"}, "scenes/none.toml: cannot read this file\n");
}

// One line says what a file is and who takes it, in place of the first key that it lacks.
TEST(Command, CallsAFileOfAnotherKindWhatItIs) {
  struct Mistaken {
    std::vector<std::string> words;
    std::string is;    // "FILE:LINE: this is ..."
    std::string hint;  // who takes it
  };
  const std::vector<Mistaken> all{
      {{"run", "scenes/studies/coupon.toml"},
       "scenes/studies/coupon.toml:4:9: this is a study of settings, not a scene",
       "'cuboct explore scenes/studies/coupon.toml' takes it"},
      {{"check", "scenes/studies/machines_coupon.toml"},
       "this is a study of machines, not a scene",
       "'cuboct explore scenes/studies/machines_coupon.toml' takes it"},
      {{"check", "scenes/studies/fit_bar.toml"},
       "this is a fit of a law to a curve, not a scene",
       "'cuboct fit scenes/studies/fit_bar.toml' takes it"},
      {{"check", "scenes/studies/silicon_fit.toml"},
       "this is a fit of a potential, not a scene",
       "'cuboct fit scenes/studies/silicon_fit.toml' takes it"},
      {{"check", "scenes/studies/silicon_rod.toml"},
       "this is a study of elements, not a scene",
       "'cuboct multiscale scenes/studies/silicon_rod.toml' takes it"},
      {{"check", "scenes/studies/graphene.toml"},
       "this is a study of a learned kernel, not a scene",
       "'cuboct learn scenes/studies/graphene.toml' takes it"},
      {{"check", "technologies/cmos7.toml"},
       "this is a technology, not a scene",
       "'cuboct energy SCENE --technology technologies/cmos7.toml' takes it"},
      {{"check", "scenes/lj_block.toml", "--arch", "scenes/coupon.toml"},
       "this is a scene, not an arch file",
       "'cuboct run scenes/coupon.toml' takes it"},
      {{"check", "scenes/lj_block.toml", "--arch", "technologies/cmos7.toml"},
       "this is a technology, not an arch file",
       "'cuboct energy SCENE --technology technologies/cmos7.toml' takes it"},
      {{"energy", "scenes/lj_block.toml", "--technology", "scenes/archs/small.toml"},
       "this is an arch file, not a technology",
       "--arch scenes/archs/small.toml gives it to a scene"},
      {{"multiscale", "scenes/lj_block.toml"},
       "this is a scene, not a study of elements",
       "'cuboct run scenes/lj_block.toml' takes it"},
#ifdef CUBOCT_HAS_STUDIES
      {{"explore", "scenes/lj_block.toml"},
       "this is a scene, not a study of settings",
       "'cuboct run scenes/lj_block.toml' takes it"},
      {{"explore", "scenes/studies/fit_bar.toml"},
       "this is a fit of a law to a curve, not a study of settings",
       "'cuboct fit scenes/studies/fit_bar.toml' takes it"},
      {{"pitch", "scenes/studies/coupon.toml"},
       "this is a study of settings, not a scene",
       "'cuboct explore scenes/studies/coupon.toml' takes it"},
#endif
#ifdef CUBOCT_HAS_FITS
      {{"fit", "scenes/studies/coupon.toml"},
       "this is a study of settings, not a fit of a law to a curve",
       "'cuboct explore scenes/studies/coupon.toml' takes it"},
#endif
  };
  for (const Mistaken& one : all) {
    const Answer answer = Bench(false).cuboct(one.words);
    EXPECT_EQ(answer.code, 2) << one.is;
    EXPECT_EQ(answer.out, "") << one.is;
    const std::string err = without_excerpt(answer.err), end = one.is + "\n  hint: " + one.hint + "\n";
    EXPECT_TRUE(err.ends_with(end)) << err;
    EXPECT_TRUE(err.starts_with(one.words.back() + ":")) << err;
  }
}

// What is wrong in a file of the right kind is told as before, whatever other keys it has.
TEST(Command, TellsAFileOfTheRightKindWhatItLacks) {
  const Bench bench(false);
  const std::string path = bench.path("scene.toml");
  std::ofstream(path) << "mass = \"1 g\"\n[sweep]\n[law]\nkind = \"elastic\"\n";
  EXPECT_NE(bench.cuboct({"check", path}).err.find("the law 'elastic' needs the pitch"), std::string::npos);
  std::ofstream(path) << "title = \"nothing\"\n";
  EXPECT_NE(bench.cuboct({"check", path}).err.find("missing key 'law'"), std::string::npos);
}

// The error of a library, told at the place of the key: its hint stays a line of its own.
TEST(Command, HintsOfAnErrorWithinAFileAreLines) {
  const Bench bench(false);  // without the module that reads meshes
  std::ofstream(bench.path("a.stl")) << "solid\n";
  const std::string path = bench.path("scene.toml");
  std::ofstream(path)
      << "density = \"1 g/cm^3\"\n[packing]\npitch = \"1 mm\"\n[geometry]\nshape = \"mesh\"\n"
         "file = \"a.stl\"\nunit = \"mm\"\n[law]\nkind = \"elastic\"\nstiffness = \"1 kN/m\"\n"
         "[run]\nduration = \"1 ms\"\n";
  const Answer answer = bench.cuboct({"check", path});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err.find("\\n"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find("\n  hint: "), std::string::npos) << answer.err;
}

TEST(Command, SaysHowToGetAnEngineThatIsNotBuilt) {
  expect_refusal({"run", "scenes/lj_block.toml", "--engine", "systemc"},
                 "the systemc engine is not built: no program cuboct-systemc beside cuboct\n"
                 "  hint: install libsystemc-dev and build again; a directory of 'cmake --install' has no "
                 "such engine\n");
  expect_refusal({"crosscheck", "scenes/lj_block.toml", "--engines", "golden,rtl", "--steps", "1"},
                 "the rtl engine is not built: no program cuboct-rtl beside cuboct\n"
                 "  hint: install verilator and libsystemc-dev and build again; a directory of 'cmake "
                 "--install' has no such engine\n");
}

TEST(Command, RefusesAnOutputThatCannotBeWrittenBeforeTheRun) {
  // The default of 1000 steps would take a second; the refusal comes at once and leaves the file as it is.
  expect_refusal({"run", "scenes/lj_block.toml", "--out", "LICENSE"},
                 "cannot make the directory LICENSE: Not a directory\n");
  expect_refusal({"report", "scenes"},
                 "scenes holds no run: no file run.toml\n  hint: 'cuboct run SCENE --out DIR' makes one\n");
}

}  // namespace
}  // namespace cuboct::test
