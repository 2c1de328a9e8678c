// SPDX-License-Identifier: MIT
// A scene and a result directory of a stranger, through each command: what they say is shown, and nothing of
// it is done.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "model/base/text.h"
#include "model/trace/plot.h"
#include "model/trace/raster_plot.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"
#include "tests/support/hostile.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

// A name that is allowed and breaks columns and markup where it is no data.
constexpr const char* kName =
    "so\xc2\xa0"
    "ft $(touch cuboct_was_here) <b>{a}_2^3";
std::string scene_text() {
  return hostile_block() + R"([[material]]
name = ")" +
         std::string(kName) + R"("
[[probe]]
kind = "force"
name = ")" +
         std::string(kName) + R"("
region = {shape = "half_space", normal = [1, 0, 0], point = [1, 0, 0]}
[[velocity]]
thermal_energy = 0.2
seed = 1
[run]
dt = 0.004
steps = 20
frame_every = 10
)";
}

class Hostile : public testing::Test {
 protected:
  Hostile() : bench_(false) { std::ofstream(scene()) << scene_text(); }
  ~Hostile() override {
    for (const std::string& place :
         {std::string("."), std::string(CUBOCT_SOURCE_DIR), bench_.path(""), out()}) {
      EXPECT_FALSE(take_loot(place)) << "something was run in " << place;
    }
  }
  std::string scene() const { return bench_.path("scene.toml"); }
  std::string out() const { return bench_.path("result"); }
  Answer expect(const std::vector<std::string>& words, int code = 0) const {
    Answer answer = bench_.cuboct(words);
    EXPECT_EQ(answer.code, code) << answer.err;
    EXPECT_TRUE(is_tame(answer.out)) << answer.out;
    EXPECT_TRUE(is_tame(answer.err)) << answer.err;
    return answer;
  }
  void run() const { expect({"run", scene(), "--out", out()}); }
  // Text of a file that a command wrote.
  std::string written(const std::string& name) const { return contents(out() + "/" + name); }

  const Bench bench_;
};

TEST_F(Hostile, CheckShowsATitleInOneLine) {
  const std::string text = expect({"check", scene()}).out;
  EXPECT_NE(text.find("\ntitle "), std::string::npos);
  EXPECT_NE(text.find(line_text(hostile_text()) + "\n"), std::string::npos);
  EXPECT_NE(expect({"check", scene(), "--json"}).out.find(json_text(hostile_text())), std::string::npos);
}

TEST_F(Hostile, ErrorsShowWhatASceneSays) {
  std::ofstream(scene(), std::ios::app)
      << "[[particle]]\nposition = [0, 0, 0]\nmaterial = \"a\\u001b[2J\\nb\"\n";
  const Answer answer = expect({"check", scene()}, 2);
  EXPECT_NE(answer.err.find("unknown material 'a\\x1b[2J\\nb'\n"), std::string::npos) << answer.err;
  expect({"check", bench_.path("none\x1b[2J\n.toml")}, 2);
}

TEST_F(Hostile, FramesKeepTheirColumns) {
  run();
  std::istringstream frames(written("frames.xyz"));
  size_t rows = 0;
  for (std::string line; std::getline(frames, line);) {
    if (line.find("Lattice=") != std::string::npos || line.find(' ') == std::string::npos) continue;
    std::istringstream columns(line);
    const std::vector<std::string> words{std::istream_iterator<std::string>(columns), {}};
    ASSERT_EQ(words.size(), 20U) << line;
    EXPECT_EQ(words[6], "so_ft_$(touch_cuboct_was_here)_<b>{a}_2^3");
    ++rows;
  }
  EXPECT_EQ(rows, 3 * 256U);
  EXPECT_TRUE(is_tame(written("summary.json")));
  EXPECT_TRUE(is_tame(written("plan.txt")));
  EXPECT_EQ(read_trace(out() + "/trace.h5").curves[0].name, kName + std::string(".force_x"));
}

TEST_F(Hostile, PictureOfATitleThatRunsCommands) {
  run();
  const Rasters rasters = read_rasters(out() + "/rasters.h5");
  EXPECT_EQ(rasters.title, hostile_text().substr(0, hostile_text().find('\0')));
  EXPECT_EQ(expect({"picture", out()}).out, out() + "/picture.png\n");
}

// Markup in a title would draw "{x}" as "x".
TEST_F(Hostile, ATitleIsNoMarkup) {
  Rasters rasters{"x", 0, 1e-3, {0, 1, 0, 0, 1e-4, 30, 20}, {}};
  Raster& frame = rasters.frames.emplace_back();
  frame.thickness = frame.strain = frame.speed = frame.broken = std::vector<float>(600, 1);
  const auto drawn = [&](const std::string& title) {
    rasters.title = title;
    return plot_rasters(rasters, {Field::speed, {0}, 0, 500});
  };
  EXPECT_EQ(drawn("x"), drawn("x"));
  EXPECT_NE(drawn("x"), drawn("{x}"));
  EXPECT_NE(drawn("x"), drawn("{/Symbol x}"));
  EXPECT_NE(drawn("a_b"), drawn("a_{b}"));
  drawn(std::string(200000, 'x'));
}

TEST_F(Hostile, LinesOfAReportAreDrawnAsTheyRead) {
  const std::string name = hostile_text();
  const std::string svg = plot_lines({{name, {0, 1}, {0, 1}, {{0, 0}}}}, name, name);
  EXPECT_TRUE(is_tame(svg.substr(svg.find("<text"))) || svg.find('\t') != std::string::npos);
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_EQ(svg.find("<img"), std::string::npos);
  size_t count = 0;
  for (size_t at = 0; (at = svg.find("{/Symbol s}_2^3&lt;/title", at)) != std::string::npos; ++at) ++count;
  // Both axes and the line's own title; gnuplot leaves a title out of the key where it has no room.
  EXPECT_GE(count, 3U) << svg;
}

TEST_F(Hostile, PicturesOfAReportHaveTheirLabels) {
  const Image image{300, 60, std::vector<Colour>(18000, Colour{100, 100, 100})};
  const auto drawn = [&](const std::string& label, const std::string& bar) {
    return plot_pictures({image}, {label}, bar, 1);
  };
  EXPECT_EQ(drawn("x", "x"), drawn("x", "x"));
  EXPECT_NE(drawn("x", "x"), drawn("{x}", "x"));
  EXPECT_NE(drawn("x", "x"), drawn("x", "{x}"));
  drawn(hostile_text(), hostile_text());
}

TEST_F(Hostile, ReportHoldsTextAlone) {
  run();
  EXPECT_EQ(expect({"report", out()}).out, out() + "/report.html\n");
  const std::string html = written("report.html");
  EXPECT_NE(html.find("<title>" + html_text(hostile_text()) + "</title>"), std::string::npos);
  // The data and the script of the picture that turns, which the policy names by its hash.
  size_t scripts = 0;
  for (size_t at = html.find("<script"); at != std::string::npos; at = html.find("<script", at + 1))
    ++scripts;
  EXPECT_EQ(scripts, 2U);
  EXPECT_NE(html.find("<script type=\"application/json\" id=\"turn-data\">{"), std::string::npos);
  EXPECT_NE(html.find("<script>\"use strict\";"), std::string::npos);
  EXPECT_EQ(html.find("onerror=alert(2)>"), std::string::npos);
  EXPECT_NE(html.find("content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src "
                      "'sha256-"),
            std::string::npos);
}

TEST_F(Hostile, EmittedProjectsHoldNothingOfIt) {
  expect({"emit", scene(), "--out", out(), "--board", "ulx3s", "--unchecked"});
  for (const auto& entry : fs::recursive_directory_iterator(out())) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(contents(entry.path().string()).find("cuboct_was_here"), std::string::npos) << entry.path();
  }
}

#ifdef CUBOCT_HAS_PAGE
TEST_F(Hostile, StudyPagesAndTablesHoldTextAlone) {
  std::ofstream(scene(), std::ios::app) << "";
  std::ofstream(bench_.path("study.toml"))
      << "title = " << hostile_toml()
      << "\nscene = \"scene.toml\"\nsamples = 4\n[[figure]]\nkind = \"final\"\nname = " << hostile_toml()
      << "\ncurve = \"energy.total\"\n[truth]\nrungs = 2\n"
      << "[[sweep]]\ndt_safety = [0.2, 0.4]\n";
  std::ofstream change(scene());
  std::string text = scene_text();
  text.replace(text.find("dt = 0.004"), 10, "dt = \"auto\"");
  change << text;
  change.close();
  const std::string shown = expect({"explore", bench_.path("study.toml"), "--out", out(), "--no-speed"}).out;
  EXPECT_NE(shown.find("2 points"), std::string::npos) << shown;
  EXPECT_NE(shown.find(line_text(hostile_text())), std::string::npos) << shown;
  const std::string page = written("page.html");
  EXPECT_NE(page.find("<title>" + html_text(hostile_text()) + "</title>"), std::string::npos);
  EXPECT_NE(page.find(json_text(hostile_text())), std::string::npos);
  EXPECT_EQ(page.find("<script>alert(1)"), std::string::npos);
  EXPECT_NE(page.find("Content-Security-Policy"), std::string::npos);
  size_t charts = 0;
  for (const auto& entry : fs::directory_iterator(out() + "/charts")) {
    ++charts;
    if (entry.path().extension() != ".svg") continue;
    EXPECT_EQ(contents(entry.path().string()).find("<script"), std::string::npos) << entry.path();
  }
  EXPECT_GT(charts, 0U);
}
#endif

TEST_F(Hostile, AStrangersTraceIsRefusedInOneLine) {
  run();
  const auto refused = [&](const std::function<void(Trace&)>& change) {
    Trace trace = read_trace(out() + "/trace.h5");
    const Trace whole = trace;
    change(trace);
    write_trace(out() + "/trace.h5", trace);
    const Answer answer = expect({"report", out()}, 2);
    write_trace(out() + "/trace.h5", whole);
    return answer.err;
  };
  const std::string is_none = out() + "/trace.h5 is no trace of this scene: ";
  EXPECT_EQ(refused([](Trace& t) { t.frames[1].particles[3].cell = 1u << 31; }),
            is_none + "frame of step 10, particle 3: cell 2147483648 is not below 27\n");
  EXPECT_EQ(refused([](Trace& t) { t.frames[1].particles[3].type = 200; }),
            is_none + "frame of step 10, particle 3: type 200 is not below 1\n");
  EXPECT_EQ(refused([](Trace& t) { t.frames[1].particles.resize(2); }),
            is_none + "the frame of step 10 has 2 particles, the scene 256\n");
  // Curves that do not go together are no curve of stress and strain.
  Trace trace = read_trace(out() + "/trace.h5");
  trace.curves = {{"a.strain", "1", {0, 1, 2}, {0, 1, 2}}, {"a.stress", "Pa", {0, 1}, {NAN, INFINITY}}};
  write_trace(out() + "/trace.h5", trace);
  expect({"report", out()});
  EXPECT_EQ(written("report.html").find("Stress and strain"), std::string::npos);
}

TEST_F(Hostile, AStrangersRecordNamesFiles) {
  run();
  std::ofstream(out() + "/run.toml") << "scene = \"/dev/zero\"\n";
  EXPECT_EQ(expect({"report", out()}, 2).err, out() +
                                                  "/run.toml: 'scene' names no file: '/dev/zero'\n  hint: "
                                                  "paths count from the directory of run.toml\n");
  std::ofstream(out() + "/run.toml") << "arch = \"\"\n";
  EXPECT_EQ(
      expect({"report", out()}, 2).err,
      out() + "/run.toml: 'scene' names no file: ''\n  hint: paths count from the directory of run.toml\n");
}

TEST_F(Hostile, NamesOfDirectoriesAreShown) {
  const std::string odd = bench_.path("it's \"$(touch cuboct_was_here)\" \x1b[31m");
  expect({"run", scene(), "--out", odd});
  EXPECT_EQ(expect({"picture", odd}).out, line_text(odd) + "/picture.png\n");
  EXPECT_EQ(expect({"report", odd}).out, line_text(odd) + "/report.html\n");
}

}  // namespace
}  // namespace cuboct::test
