// SPDX-License-Identifier: MIT
// The page that `cuboct report` makes of a run's directory.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>

#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

// The page of a run that ends with `code`.
std::string page(const Bench& bench, std::vector<std::string> arguments, int code = 0) {
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), {"--out", bench.path("run")});
  const Answer ran = bench.cuboct(arguments);
  EXPECT_EQ(ran.code, code) << ran.out << ran.err;
  const Answer answer = bench.cuboct({"report", bench.path("run")});
  EXPECT_EQ(answer.code, 0) << answer.err;
  return contents(bench.path("run/report.html"));
}

TEST(Report, SetsFiguresBesideThoseOfTheDatasheet) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  const Answer run = bench.cuboct({"run", "scenes/acetal.toml", "--steps", "120", "--out", out});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.out.find("; datasheet: 7.2e+07 Pa)\n"), std::string::npos) << run.out;
  EXPECT_TRUE(std::regex_search(
      run.out, std::regex("tension.strain_at_break +not there \\([^\n]*; datasheet: 0.5\\)\n")))
      << run.out;  // it has not broken
  ASSERT_EQ(bench.cuboct({"report", out}).code, 0);
  const std::string html = contents(out + "/report.html");
  EXPECT_NE(html.find("<th>datasheet: acetal homopolymer, 23 C</th>"), std::string::npos);
  EXPECT_NE(html.find("<td>72 MPa</td>"), std::string::npos);
  EXPECT_TRUE(std::regex_search(
      html, std::regex("<tr><th>strain at break</th><td>not there</td><td>[^<]*</td><td>50 %</td></tr>")));
}

TEST(Report, IsOneFileWithoutOutsideResources) {
  const Bench bench(true);
  const std::string out = bench.path("run");
  ASSERT_EQ(
      bench.cuboct({"run", "scenes/coupon.toml", "--steps", "100", "--frame-every", "25", "--out", out}).code,
      0);
  ASSERT_EQ(bench
                .cuboct({"crosscheck", "scenes/coupon.toml", "--steps", "5", "--engines",
                         "golden,systemc,rtl", "--out", out + "/crosscheck"})
                .code,
            0);
  const Answer answer = bench.cuboct({"report", out});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(answer.out, out + "/report.html\n");
  const std::string html = contents(out + "/report.html");
  EXPECT_NE(html.find("data:image/png;base64,iVBORw0KGgo"), std::string::npos);
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_NE(html.find("<tr><th>strength</th><td>"), std::string::npos);
  EXPECT_EQ(html.find("href=\"http"), std::string::npos);
  EXPECT_EQ(html.find("src=\"http"), std::string::npos);
  std::smatch found;
  std::string rest = html;
  int equal = 0;
  while (std::regex_search(rest, found, std::regex("bits equal"))) {
    ++equal;
    rest = found.suffix();
  }
  EXPECT_EQ(equal, 3);  // golden, systemc, rtl
}

TEST(Report, HoldsEveryWarning) {
  for (const char* engine : {"lattice", "golden", "reference"}) {
    const std::string html = page(Bench(false), {"scenes/failures/tunnelling.toml", "--engine", engine}, 1);
    EXPECT_TRUE(std::regex_search(html, std::regex("<li>warning: step [0-9]+: tunnelling: "))) << engine;
  }
  EXPECT_EQ(page(Bench(false), {"scenes/failures/tunnelling_healthy.toml"}).find("warning:"),
            std::string::npos);
}

// What check warns of stands in the summary and in the report too; nothing of it in a run of real numbers.
TEST(Report, HoldsTheWarningsOfThePlan) {
  const Bench bench(false);
  const std::string arch = bench.path("few.toml");
  std::ofstream(arch) << "name = \"few\"\n[widths]\ndifference_frac = 8\n";
  const std::string warning = "warning: a strain of ";
  EXPECT_EQ(count(bench.cuboct({"check", "scenes/coupon.toml", "--arch", arch}).out, warning), 1u);
  EXPECT_EQ(count(bench.cuboct({"run", "scenes/coupon.toml", "--arch", arch, "--steps", "20"}).out, warning),
            1u);
  EXPECT_EQ(count(page(bench, {"scenes/coupon.toml", "--arch", arch, "--steps", "20"}), "<li>" + warning),
            1u);
  EXPECT_EQ(
      count(page(bench, {"scenes/coupon.toml", "--arch", arch, "--steps", "20", "--engine", "reference"}),
            "warning:"),
      0u);
}

TEST(Report, PicturesARunInRealNumbersToo) {
  const Bench bench(false);
  const std::string html =
      page(bench, {"scenes/coupon.toml", "--steps", "40", "--frame-every", "20", "--engine", "reference"});
  EXPECT_EQ(count(html, "data:image/png;base64,iVBORw0KGgo"), 1u);
  EXPECT_EQ(html.find(" nodes, "), std::string::npos);  // it has none
  ASSERT_EQ(read_trace(bench.path("run/trace.h5")).bodies.size(), 3u);
}

TEST(Report, SaysWhyARunStopped) {
  const std::string html = page(
      Bench(false), {"scenes/failures/full_node.toml", "--arch", "scenes/failures/archs/full_node.toml"}, 1);
  EXPECT_NE(html.find("<b class=\"bad\">stopped after 33 of "), std::string::npos);
  EXPECT_NE(html.find("<li>stopped: step 33, cell "), std::string::npos);
}

// Of a scene of many more steps.
TEST(Report, CountsTheStepsOfTheRun) {
  const std::string html = page(Bench(false), {"scenes/lj_block.toml", "--steps", "50"});
  EXPECT_NE(html.find(" 50 steps of "), std::string::npos);
  EXPECT_NE(html.find("<tr><th>steps</th><td>50 "), std::string::npos);
  EXPECT_EQ(html.find("<tr><th>steps</th><td>1000 "), std::string::npos);
}

TEST(Report, HasTheCyclesOfEachPhaseWhereTheyWereCounted) {
  const Bench bench(false);
  const std::string html = page(bench, {"scenes/lj_block.toml", "--steps", "20", "--cycles"});
  const Trace trace = read_trace(bench.path("run") + "/trace.h5");
  uint64_t sum = 0, most = 0, spans = 0;
  for (size_t k = static_cast<size_t>(Phase::force); k < trace.cycles.size(); k += kPhases, ++spans) {
    const uint64_t length = trace.cycles[k].end - trace.cycles[k].start + 1;
    sum += length, most = std::max(most, length);
  }
  ASSERT_EQ(spans, 20 * trace.nodes);
  EXPECT_EQ(count(html, fmt::format("<tr><th>force</th><td>{:.1f}</td><td>{}</td></tr>",
                                    static_cast<double>(sum) / static_cast<double>(spans), most)),
            1u);
  EXPECT_EQ(page(Bench(false), {"scenes/lj_block.toml", "--steps", "20"}).find("Cycles per phase"),
            std::string::npos);
}

// A scene with a probe of each kind: a figure and the last values of each, and of the energies.
TEST(Report, DrawsTheCurvesOfEveryProbe) {
  const Bench bench(false);
  std::string scene = contents(CUBOCT_SOURCE_DIR "/scenes/coupon.toml");
  scene +=
      "\n[[probe]]\nname = \"pull\"\nkind = \"force\"\nregion = { shape = \"half_space\", normal = [1, 0, 0] "
      "}\n"
      "[[probe]]\nname = \"tip\"\nkind = \"displacement\"\nregion = { shape = \"half_space\", normal = [1, "
      "0, 0] }\n";
  std::ofstream(bench.path("scene.toml")) << scene;
  const std::string html = page(bench, {bench.path("scene.toml"), "--steps", "100"});
  for (const char* title :
       {"Stress and strain: tension", "Force: pull", "Displacement: tip", "Energy, since the start"})
    EXPECT_EQ(count(html, std::string("<h2>") + title + "</h2>\n<figure><svg"), 1u) << title;
  for (const char* curve :
       {"tension.strain", "tension.stress", "pull.force_x", "pull.force_z", "tip.x", "tip.y"})
    EXPECT_EQ(count(html, std::string("<tr><th>") + curve + "</th><td>"), 1u) << curve;
  EXPECT_EQ(count(html, "<h2>Temperature</h2>"), 0u);  // the coupon damps
}

TEST(Report, DrawsTemperatureAndPressure) {
  const std::string html = page(Bench(false), {"scenes/lj_block.toml", "--steps", "20"});
  for (const char* title : {"Temperature", "Pressure"})
    EXPECT_EQ(count(html, std::string("<h2>") + title + "</h2>\n<figure><svg"), 1u) << title;
  EXPECT_EQ(count(html, "<tr><th>temperature</th><td>"), 1u);
}

// Beside a potential energy of 2 mJ, 1e-18 J are the rounding of a sum of doubles. 1e-12 J are not.
TEST(Report, PrintsRoundingAsZero) {
  const Bench bench(false);
  page(bench, {"scenes/coupon.toml", "--steps", "100"});
  const std::string path = bench.path("run/trace.h5");
  Trace trace = read_trace(path);
  for (const double change : {1.301e-18, 1e-12}) {
    for (Curve& curve : trace.curves) {
      if (curve.name.starts_with("energy.")) std::fill(curve.value.begin(), curve.value.end(), 0);
      if (curve.name == "energy.potential") curve.value.back() = 2e-3;
      if (curve.name == "energy.total") curve.value.back() = change;
    }
    write_trace(path, trace);
    ASSERT_EQ(bench.cuboct({"report", bench.path("run")}).code, 0);
    const std::string html = contents(bench.path("run/report.html"));
    const std::string shown = change < 1e-15 ? "0 J" : "1e-12 J";
    for (const char* name : {"energy", "energy change"})
      EXPECT_NE(html.find("<tr><th>" + std::string(name) + "</th><td>" + shown), std::string::npos)
          << name << change;
  }
}

// A trace of another scene in the folder crosscheck is no row beside others.
TEST(Report, ComparesNoTraceOfAnotherScene) {
  const Bench bench(true);
  const std::string out = bench.path("run");
  ASSERT_EQ(bench
                .cuboct({"crosscheck", "scenes/coupon.toml", "--steps", "3", "--engines", "golden,systemc",
                         "--out", out + "/crosscheck"})
                .code,
            0);
  ASSERT_EQ(bench
                .cuboct({"crosscheck", "scenes/lj_block.toml", "--steps", "3", "--engines", "golden,rtl",
                         "--out", bench.path("other")})
                .code,
            0);
  fs::copy(bench.path("other/rtl.h5"), out + "/crosscheck/rtl.h5");
  const std::string html = page(bench, {"scenes/coupon.toml", "--steps", "5"});
  EXPECT_EQ(count(html, "bits equal"), 2u);
  EXPECT_EQ(count(html, "not compared: rtl.h5 is of another scene or arch, plan "), 1u);
}

}  // namespace
}  // namespace cuboct::test
