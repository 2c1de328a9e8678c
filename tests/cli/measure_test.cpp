// SPDX-License-Identifier: MIT
// What `cuboct measure` writes of a run, and what it refuses. The figures themselves:
// tests/unit/measurement_test.cpp and tests/peer/measure_test.cpp.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "model/base/output.h"
#include "model/trace/trace.h"
#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

using Strings = std::vector<std::string>;

// A table by its columns' names.
std::map<std::string, std::vector<double>> table_of(const std::string& csv) {
  std::map<std::string, std::vector<double>> table;
  Strings names;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::string cell;
    for (size_t k = 0; std::getline(cells, cell, ','); ++k)
      if (names.size() <= k)
        names.push_back(cell);
      else if (!table[names[k]].empty() || line[0] != names[0][0])
        table[names[k]].push_back(std::stod(cell));
  }
  return table;
}

class MeasureCommand : public testing::Test {
 protected:
  // A warm crystal that repeats: 256 particles, frames at 0, 20, ..., 60, energies read at each.
  void run(const Strings& more = {}) {
    Strings words{"run",   "scenes/lj_block.toml", "--steps", "60", "--frame-every", "20", "--frames", "none",
                  "--out", bench_.path("run")};
    words.insert(words.end(), more.begin(), more.end());
    const test::Answer answer = bench_.cuboct(words);
    ASSERT_EQ(answer.code, 0) << answer.err;
  }
  test::Answer measure(const Strings& more) const {
    Strings words{"measure", bench_.path("run")};
    words.insert(words.end(), more.begin(), more.end());
    return bench_.cuboct(words);
  }
  std::map<std::string, std::vector<double>> table(const Strings& more) const {
    const test::Answer answer = measure(more);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return table_of(answer.out);
  }
  const Bench bench_{false};
};

TEST_F(MeasureCommand, WritesTablesWithNotesBesideThem) {
  run();
  const test::Answer answer = measure({"rdf", "--cutoff", "2.2", "--bins", "11", "--frames", "0"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.err.substr(0, answer.err.find("density")),
            "frames        1 of 4, step 0\ncutoff        2.2 in 11 bins\n");
  const auto rdf = table_of(answer.out);
  EXPECT_EQ(answer.out.substr(0, answer.out.find('\n')), "r,g,within,pairs");
  // The crystal's shells: its pitch is near 1.09.
  EXPECT_EQ(rdf.at("within")[6], 12);
  EXPECT_EQ(rdf.at("within")[7], 18);
  EXPECT_EQ(rdf.at("within")[9], 42);
  EXPECT_EQ(rdf.at("pairs")[5], 256 * 12);

  const auto msd = table({"msd"});
  EXPECT_EQ(msd.at("step"), (std::vector<double>{0, 20, 40, 60}));
  EXPECT_EQ(msd.at("msd")[0], 0);
  // Free flight at first: v^2 t^2 with 3 kT/m = 0.6, slowed by the neighbours.
  EXPECT_GT(msd.at("msd")[1], 0.5 * 0.6 * 0.08 * 0.08);
  EXPECT_LT(msd.at("msd")[1], 1.1 * 0.6 * 0.08 * 0.08);
  EXPECT_EQ(table({"msd", "--frames", "20:40"}).at("msd")[0], 0);

  const auto coordination = table({"coordination"});
  EXPECT_EQ(coordination.at("12")[0], 256);
  EXPECT_EQ(coordination.at("mean")[0], 12);
  const auto cna = table({"cna"});
  EXPECT_EQ(cna.at("fcc")[0], 256);
  EXPECT_EQ(cna.at("fcc").size(), 4u);
  EXPECT_EQ(table({"cna", "--cutoff", "1.3", "--frames", "last"}).at("fcc").size(), 1u);

  const test::Answer file = measure({"cna", "--out", bench_.path("cna.csv")});
  EXPECT_EQ(read_text(bench_.path("cna.csv")), measure({"cna"}).out);
  EXPECT_EQ(file.out.substr(0, 28), "frames        4 of 4, steps ");
  const auto json = nlohmann::json::parse(measure({"cna", "--json"}).out);
  EXPECT_EQ(json["measure"], "cna");
  EXPECT_EQ(json["columns"]["fcc"]["values"].get<std::vector<double>>(), cna.at("fcc"));
  EXPECT_EQ(json["columns"]["time"]["unit"], "1");
  EXPECT_EQ(json["notes"]["structure"], "0 other, 1 fcc, 2 hcp, 3 bcc, 4 icosahedral");
}

// The run's own pressure is by the kicks of integers; this one by the law in doubles at the same positions.
TEST_F(MeasureCommand, PressureIsThatOfTheRun) {
  run();
  const Trace trace = read_trace(bench_.path("run/trace.h5"));
  const auto curve = std::ranges::find(trace.curves, "pressure", &Curve::name);
  ASSERT_NE(curve, trace.curves.end());
  const auto stress = table({"stress"});
  ASSERT_EQ(stress.at("step").back(), static_cast<double>(curve->step.back()));
  const double scale =
      std::abs(table({"stress", "--virial"}).at("pressure").back() - stress.at("pressure").back());
  ASSERT_GT(scale, 0.1);  // the kinetic part, n kT
  EXPECT_NEAR(stress.at("pressure").back(), curve->value.back(), 5e-3 * scale);
  // Half of the volume, twice the stress.
  const auto half = table({"stress", "--volume", "1"}), whole = table({"stress", "--volume", "2"});
  EXPECT_DOUBLE_EQ(half.at("xx")[0], 2 * whole.at("xx")[0]);
  // In doubles, unwrapped, by the reference.
  run({"--engine", "reference"});
  const Trace real = read_trace(bench_.path("run/trace.h5"));
  const auto of = std::ranges::find(real.curves, "pressure", &Curve::name);
  EXPECT_NEAR(table({"stress"}).at("pressure").back(), of->value.back(), 1e-12 * std::abs(of->value.back()));
  run({"--engine", "reference", "--integrator", "verlet"});
  const Trace verlet = read_trace(bench_.path("run/trace.h5"));
  const auto full = std::ranges::find(verlet.curves, "pressure", &Curve::name);
  EXPECT_NEAR(table({"stress"}).at("pressure").back(), full->value.back(),
              1e-12 * std::abs(full->value.back()));
}

TEST_F(MeasureCommand, WritesWhatEachParticleHas) {
  run();
  ASSERT_EQ(measure({"coordination", "--particles", bench_.path("c.csv"), "--frames", "last"}).code, 0);
  const auto each = table_of(read_text(bench_.path("c.csv")));
  ASSERT_EQ(each.at("coordination").size(), 256u);
  double sum = 0;
  for (const double one : each.at("coordination")) sum += one;
  EXPECT_DOUBLE_EQ(sum / 256, table({"coordination", "--frames", "last"}).at("mean")[0]);

  ASSERT_EQ(
      measure({"stress", "--particles", bench_.path("s.csv"), "--frames", "last", "--volume", "1"}).code, 0);
  const auto stress = table_of(read_text(bench_.path("s.csv")));
  sum = 0;
  for (const double one : stress.at("stress_volume_xy")) sum += one;
  EXPECT_NEAR(sum, table({"stress", "--frames", "last", "--volume", "1"}).at("xy")[0], 1e-9);

  ASSERT_EQ(measure({"cna", "--particles", bench_.path("c.xyz")}).code, 0);
  std::istringstream lines(read_text(bench_.path("c.xyz")));
  std::string line;
  std::getline(lines, line), std::getline(lines, line);
  EXPECT_NE(line.find(":broken_bonds:I:1:structure:I:1 units="), std::string::npos) << line;
  std::getline(lines, line);
  EXPECT_EQ(line.substr(line.rfind(' ')), " 1") << line;  // fcc
  ASSERT_EQ(measure({"msd", "--particles", bench_.path("d.pvd")}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(bench_.path("d_000003.vtp")));
  ASSERT_EQ(measure({"stress", "--particles", bench_.path("d.dump.gz")}).code, 0);
  EXPECT_GT(std::filesystem::file_size(bench_.path("d.dump.gz")), 1000u);
}

TEST_F(MeasureCommand, RefusesInALine) {
  run();
  const auto expect = [&](const Strings& words, const std::string& err) {
    const test::Answer answer = measure(words);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    EXPECT_EQ(answer.err, err);
  };
  expect({"rfd"}, "no measure 'rfd'\n  hint: did you mean 'rdf'?\n");
  expect({"rdf", "--cutoff", "3 mm"},
         "--cutoff: '3 mm' is not a number: the scene has reduced units\n  hint: --cutoff '1.5'\n");
  expect({"rdf", "--cutoff", "-3"}, "--cutoff: '-3' is not above 0\n  hint: --cutoff '1.5'\n");
  expect({"cna", "--com"}, "--com is not an option of cna\n  hint: it is one of msd\n");
  expect({"cna", "--frames", "7"},
         "no frames '7'\n  hint: all, half, last, steps as 0,500 or from one step to another as 100:900; "
         "kept are 0, 20, 40, 60\n");
  expect({"rdf", "--particles", bench_.path("x.csv")},
         "rdf has nothing of each particle\n  hint: msd, coordination, cna and stress have\n");
  EXPECT_FALSE(std::filesystem::exists(bench_.path("x.csv")));
  expect({"cna", "--particles", bench_.path("x.txt")},
         "--particles: '" + bench_.path("x.txt") +
             "' names no format\n  hint: by its ending: .csv, .xyz, .xyz.gz, .dump.gz (LAMMPS) or .pvd "
             "(ParaView)\n");
  run({"--no-states"});
  expect({"cna"},
         "the run kept no frames\n  hint: 'cuboct run' keeps the first and the last, and without --no-states "
         "in the trace\n");
}

// A file of that name that was there before stays as it was, and nothing half-written is beside it.
TEST_F(MeasureCommand, ThatIsRefusedLeavesTheFile) {
  run();
  const auto count = [&] { return std::distance(std::filesystem::directory_iterator(bench_.path("")), {}); };
  const auto refused = [&](const std::string& ending, const Strings& words, const std::string& err) {
    const std::string file = bench_.path("before" + ending);
    write_text(file, std::string("mine\n"));
    const auto before = count();
    Strings all = words;
    all.insert(all.end(), {"--particles", file});
    const test::Answer answer = measure(all);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.err.substr(0, answer.err.find('\n')), err);
    EXPECT_EQ(read_text(file), "mine\n") << ending;
    EXPECT_EQ(count(), before) << ending;
  };
  for (const char* ending : {".csv", ".xyz", ".xyz.gz", ".dump.gz", ".pvd"})
    refused(ending, {"cna", "--frames", "7"}, "no frames '7'");
  refused(".csv", {"rdf"}, "rdf has nothing of each particle");
  const std::string same = bench_.path("before.csv");
  refused(".csv", {"cna", "--out", bench_.path("./before.csv")},
          "--out and --particles name one file: '" + same + "'");
  // The whole goes round the box between two frames, and the first was written already.
  write_text(bench_.path("round.toml"),
             std::string("units = \"reduced\"\nmass = 1\n[law]\nkind = \"lj\"\nepsilon = 1\nsigma = 1\n"
                         "cutoff = 2.5\n[box]\nsize = [10, 10, 10]\nperiodic = \"xyz\"\n"
                         "[[particle]]\nposition = [1, 1, 1]\nvelocity = [4, 0, 0]\n"
                         "[[particle]]\nposition = [6, 6, 6]\nvelocity = [4, 0, 0]\n"
                         "[run]\ndt = 0.005\nsteps = 500\n"));
  const test::Answer round = bench_.cuboct({"run", bench_.path("round.toml"), "--engine", "golden",
                                            "--frames", "none", "--out", bench_.path("run")});
  ASSERT_EQ(round.code, 0) << round.err;
  for (const char* ending : {".csv", ".xyz", ".xyz.gz", ".dump.gz"})
    refused(
        ending, {"msd"},
        "between steps 0 and 500 the whole moves 10 m along x, more than a quarter of the box (10 m): its "
        "way is not known");
}

// Integers keep positions in the box, of a rule of text too: nobody goes a whole period in a quarter of a
// unit of time.
TEST_F(MeasureCommand, WaysOfARuleOfTextGoThroughTheBox) {
  std::map<std::string, double> msd;
  for (const char* engine : {"golden", "reference"}) {
    const test::Answer answer =
        bench_.cuboct({"run", "scenes/rules/langevin.toml", "--engine", engine, "--steps", "20",
                       "--frame-every", "20", "--frames", "none", "--out", bench_.path("run")});
    ASSERT_EQ(answer.code, 0) << answer.err;
    msd[engine] = table({"msd"}).at("msd").back();
  }
  EXPECT_GT(msd["reference"], 0.01);
  EXPECT_NEAR(msd["golden"], msd["reference"], 1e-3 * msd["reference"]);
}

// A body with free surfaces: g(r) and stress are over the packing's volume, and say so; its units are in the
// first line.
TEST_F(MeasureCommand, OfABodyWithSurfaces) {
  const std::string out = bench_.path("run");
  ASSERT_EQ(
      bench_.cuboct({"run", "scenes/undamped_block.toml", "--steps", "2", "--frames", "none", "--out", out})
          .code,
      0);
  const test::Answer rdf = measure({"rdf"});
  EXPECT_EQ(rdf.out.substr(0, rdf.out.find('\n')), "r (m),g,within,pairs");
  EXPECT_NE(
      rdf.err.find(
          "particles over the volume of the particles as packed\nsurfaces      g(r) falls below 1 with r"),
      std::string::npos)
      << rdf.err;
  const test::Answer given = measure({"rdf", "--volume", "1 m^3", "--cutoff", "1 cm"});
  EXPECT_NE(given.err.find("over the volume of --volume"), std::string::npos) << given.err;
  EXPECT_EQ(measure({"msd"}).out.substr(0, 42), "step,time (s),msd (m^2),x (m^2),y (m^2),z ");
  // Rules of rounds have no stress of pairs.
  ASSERT_EQ(
      bench_.cuboct({"run", "scenes/rules/heat.toml", "--steps", "2", "--frames", "none", "--out", out}).code,
      0);
  EXPECT_EQ(
      measure({"stress"}).err,
      "stress is that of pairs, and the scene's rule has rounds: frames lack what its bonds and fields hold\n"
      "  hint: probes of kind stress and stress_strain read it while the run goes\n");
  EXPECT_EQ(measure({"cna"}).code, 0);
}

}  // namespace
}  // namespace cuboct::test
