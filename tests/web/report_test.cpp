// SPDX-License-Identifier: MIT
// What a report finds in results: the settings that were varied, the orders that are expected, series and
// their looks; and that its page and pictures are the same bytes for the same results.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/text.h"
#include "study/report/chart.h"
#include "study/report/page.h"
#include "study/sweep/parameters.h"
#include "study/sweep/series.h"
#include "tests/support/hostile.h"
#include "tests/web/made_up_results.h"

namespace cuboct::test {
namespace {

using study::Arithmetic, study::Outcome, study::Parameter, study::Results;

Outcome& add(Results& results, std::vector<Change> scene, std::vector<Change> arch, double dt, double error) {
  Outcome outcome;
  outcome.settings.scene = std::move(scene);
  outcome.settings.arch = std::move(arch);
  outcome.dt = dt;
  outcome.errors.trajectory = outcome.errors.force_max = error;
  outcome.speed.simulated_seconds = 1 / dt;
  results.outcomes.push_back(outcome);
  return results.outcomes.back();
}

std::vector<std::string> ids(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.id);
  return names;
}

std::vector<std::vector<size_t>> sweeps(const Parameter& parameter) {
  std::vector<std::vector<size_t>> all;
  for (const study::Sweep& sweep : parameter.sweeps) all.push_back(sweep.points);
  return all;
}

const study::Measure& measure(const std::vector<study::Measure>& all, const std::string& id) {
  return *std::find_if(all.begin(), all.end(), [&](const study::Measure& m) { return m.id == id; });
}

TEST(Parameters, SweepsJoinWhatDiffersInNothingElse) {
  Results results;
  for (const char* guard : {"4", "8"})
    for (const double dt : {4e-8, 1e-8, 2e-8})
      add(results, {{"run.dt", fmt::format("\"{} s\"", dt)}}, {{"widths.guard", guard}}, dt, 1);
  results.outcomes[4].status = study::Status::unstable;
  const auto found = study::swept_parameters(results);
  // run.dt is told by the time step that results.
  ASSERT_EQ(ids(found), (std::vector<std::string>{"dt", "arch.widths.guard"}));
  EXPECT_EQ(sweeps(found[0]), (std::vector<std::vector<size_t>>{{1, 2, 0}, {5, 3}}));
  EXPECT_TRUE(found[0].logarithmic);
  EXPECT_EQ(sweeps(found[1]), (std::vector<std::vector<size_t>>{{0, 3}, {2, 5}}));
  EXPECT_EQ(found[1].x, (std::vector<double>{4, 4, 4, 8, 8, 8}));
}

TEST(Parameters, WhatAPresetSetsTogetherFollows) {
  Results results;
  for (const int p : {14, 17, 20})
    add(results, {},
        {{"widths.position_frac", std::to_string(p)}, {"widths.difference_frac", std::to_string(p - 4)}},
        1e-8, 1);
  const auto found = study::swept_parameters(results);
  ASSERT_EQ(ids(found),
            (std::vector<std::string>{"arch.widths.position_frac", "arch.widths.difference_frac"}));
  EXPECT_EQ(sweeps(found[0]), (std::vector<std::vector<size_t>>{{0, 1, 2}}));
  EXPECT_EQ(found[1].x, (std::vector<double>{10, 13, 16}));
}

TEST(Parameters, NumbersWithUnitsAndNames) {
  Results results;
  const char* const points[][3] = {{"0.5 mm", "uniform", "18"},
                                   {"0.25 mm", "uniform", "18"},
                                   {"0.25 mm", "octaves", "18"},
                                   {"0.25 mm", "uniform", "22"},
                                   {"0.25 mm", "uniform", "\"auto\""}};
  for (const auto& [pitch, shape, strength] : points)
    add(results, {{"packing.pitch", fmt::format("\"{}\"", pitch)}},
        {{"table.shape", fmt::format("\"{}\"", shape)}, {"widths.strength_bits", strength}}, 1, 1);
  const auto found = study::swept_parameters(results);
  ASSERT_EQ(ids(found), (std::vector<std::string>{"scene.packing.pitch", "arch.table.shape",
                                                  "arch.widths.strength_bits"}));
  EXPECT_EQ(found[0].label, "packing.pitch, mm");
  EXPECT_EQ(found[0].x, (std::vector<double>{0.5, 0.25, 0.25, 0.25, 0.25}));
  EXPECT_EQ(sweeps(found[0]), (std::vector<std::vector<size_t>>{{1, 0}}));
  EXPECT_EQ(found[1].names, (std::vector<std::string>{"uniform", "octaves"}));
  EXPECT_EQ(sweeps(found[1]), (std::vector<std::vector<size_t>>{{1, 2}}));
  EXPECT_EQ(sweeps(found[2]), (std::vector<std::vector<size_t>>{{1, 3}}));
  EXPECT_FALSE(found[2].logarithmic);
  EXPECT_TRUE(std::isnan(found[2].x[4]));  // "auto" is no number
}

// Each pitch has time steps of its own; they are still two sweeps.
TEST(Parameters, APitchDoesNotFollowFromTimeSteps) {
  Results results;
  for (const double pitch : {0.5, 0.3})
    for (const double safety : {0.1, 0.2, 0.4})
      add(results,
          {{"packing.pitch", fmt::format("\"{} mm\"", pitch)}, {"run.dt_safety", fmt::format("{}", safety)}},
          {}, safety * pitch, 1);
  const auto found = study::swept_parameters(results);
  ASSERT_EQ(ids(found), (std::vector<std::string>{"dt", "scene.packing.pitch"}));
  EXPECT_EQ(sweeps(found[0]), (std::vector<std::vector<size_t>>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(sweeps(found[1]), (std::vector<std::vector<size_t>>{{3, 0}, {4, 1}, {5, 2}}));
}

// What changes only together with several others has no sweep, and so no chart.
TEST(Parameters, NoChartWithoutASweep) {
  Results results;
  for (const int p : {14, 20})
    for (const int g : {2, 5})
      add(results, {},
          {{"widths.position_frac", std::to_string(p)},
           {"widths.guard", std::to_string(g)},
           {"widths.velocity_bits", std::to_string(p + g + 1)}},
          1, 1);
  EXPECT_TRUE(ids(study::swept_parameters(results)).empty());
}

// error = 5 dt^2 + a rest of other settings: the line goes through the purest points.
TEST(Orders, OfTheTimeStep) {
  Results results;
  for (const double rest : {0.3, 0.0})
    for (const double dt : {0.01, 0.04, 0.16})
      add(results, {{"run.dt_safety", fmt::format("{}", dt)}}, {{"widths.guard", rest > 0 ? "2" : "8"}}, dt,
          5 * dt * dt + rest);
  const auto errors = study::error_measures(results);
  const Parameter dt = study::swept_parameters(results)[0];
  const auto orders = study::expected_orders(results, dt, measure(errors, "trajectory"));
  ASSERT_EQ(orders.size(), 2U);
  EXPECT_EQ(orders[0].label, "dt, where something damps");
  EXPECT_EQ(orders[1].label, "dt²");
  const auto line = study::order_line(results, dt, measure(errors, "trajectory"), orders[1]);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->first, (std::pair{0.16, 5 * 0.16 * 0.16}));
  EXPECT_EQ(line->second.first, 0.01);
  EXPECT_NEAR(line->second.second, 5e-4, 1e-15);  // rounding of a power
  EXPECT_TRUE(study::expected_orders(results, dt, measure(errors, "force_max")).empty());
}

TEST(Orders, OfTablesByTheirDegree) {
  Results results;
  for (const int degree : {1, 2})
    for (const int bits : {4, 6, 8})
      add(results, {}, {{"table.degree", std::to_string(degree)}, {"table.index_bits", std::to_string(bits)}},
          1, std::exp2(-(degree + 1) * bits));
  const auto errors = study::error_measures(results);
  const auto found = study::swept_parameters(results);
  ASSERT_EQ(ids(found), (std::vector<std::string>{"arch.table.degree", "arch.table.index_bits"}));
  const study::Measure& force = measure(errors, "force_max");
  const auto orders = study::expected_orders(results, found[1], force);
  ASSERT_EQ(orders.size(), 2U);
  EXPECT_EQ(orders[0].label, "bins⁻², degree 1");
  EXPECT_EQ(orders[1].label, "bins⁻³, degree 2");
  for (const int degree : {1, 2}) {
    const auto line = study::order_line(results, found[1], force, orders[static_cast<size_t>(degree - 1)]);
    ASSERT_TRUE(line);
    EXPECT_EQ(line->first, (std::pair{4.0, std::exp2(-(degree + 1) * 4)}));
    EXPECT_EQ(line->second, (std::pair{8.0, std::exp2(-(degree + 1) * 8)}));
  }
}

TEST(Measures, TheTruthsOwnErrorAndWhatWasMeasured) {
  Results results = made_up_results();
  const auto errors = study::error_measures(results);
  EXPECT_EQ(measure(errors, "trajectory").floor, 3e-5);
  // The figure's error is 0.7 * 4e-3 / 4^k at rung k; the last two rungs are k = 4 and 5.
  EXPECT_NEAR(measure(errors, "figure0_young_s_modulus").floor, 0.7 * 4e-3 * (1.0 / 256 - 1.0 / 1024), 1e-9);
  EXPECT_EQ(errors.size(), 10U);
  Outcome outcome;
  outcome.errors.figures = {1e-3, 4e-3};
  EXPECT_EQ(measure(errors, "figures_worst").value(outcome), 4e-3);
  EXPECT_GE(measure(errors, "figures_worst").floor, measure(errors, "figure0_young_s_modulus").floor);
  outcome.errors.figures[1] = study::kNotMeasured;
  EXPECT_TRUE(std::isnan(measure(errors, "figures_worst").value(outcome)));
  for (Outcome& outcome : results.outcomes) outcome.errors.momentum = study::kNotMeasured;
  EXPECT_EQ(study::error_measures(results).size(), 9U);
}

// WCAG 2.2: relative luminance and contrast; graphics need 3:1.
TEST(Series, EveryEngineHasALookOfItsOwnThatCanBeSeen) {
  Results results = made_up_results();
  for (int n = 0; n < 12; ++n) add(results, {}, {}, 1, 1).settings.engine = fmt::format("engine{}", n);
  const auto gpu = [&](Arithmetic arithmetic, const std::string& machine) {
    Outcome& outcome = add(results, {}, {}, 1, 1);
    outcome.settings.engine = "gpu", outcome.settings.arithmetic = arithmetic,
    outcome.speed.machine = machine;
  };
  gpu(Arithmetic::fixed, "a <made-up> GPU"), gpu(Arithmetic::fixed, "another"), gpu(Arithmetic::float64, "");
  add(results, {}, {}, 1, 1).speed.machine = "another";
  const auto all = study::series_of(results);
  std::vector<std::string> names;
  size_t points = 0;
  for (const auto& series : all) names.push_back(series.name), points += series.points.size();
  EXPECT_EQ(points, results.outcomes.size());
  EXPECT_EQ(names[0], "lattice, fixed");
  EXPECT_EQ(names[3], "gpu, fixed (a <made-up> GPU)");
  EXPECT_EQ(names[4], "gpu, double");
  EXPECT_EQ(names[5], "gpu, float (a <made-up> GPU)");
  EXPECT_EQ(names[6], "fpga, fixed");
  ASSERT_EQ(names.size(), 21U);
  EXPECT_EQ(names[19], "gpu, fixed (another)");
  EXPECT_EQ(names[20], "lattice, fixed (another)");
  for (size_t a = 0; a < all.size(); ++a) {
    const auto channel = [&](size_t at) {
      const double c = std::stoi(all[a].colour.substr(at, 2), nullptr, 16) / 255.0;
      return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    const double luminance = 0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5);
    EXPECT_GE(1.05 / (luminance + 0.05), 3) << all[a].colour;
    for (size_t b = 0; b < a; ++b)
      EXPECT_FALSE(all[a].colour == all[b].colour && all[a].symbol == all[b].symbol) << names[a] << names[b];
  }
}

TEST(Json, TextThatCannotEndItsElement) {
  EXPECT_EQ(json(std::string("a\"b\\c</script>\n")), R"("a\"b\\c\u003c/script>\u000a")");
  EXPECT_EQ(json(0.1), "0.1");
  EXPECT_EQ(json(std::vector<double>{1e-300, NAN, -INFINITY}), "[1e-300,null,null]");
}

TEST(Page, SameResultsSameBytes) {
  const std::string page = study::page_of(made_up_results());
  EXPECT_EQ(page, study::page_of(made_up_results()));
  EXPECT_NE(page.find("Licensed to the Apache Software Foundation"), std::string::npos);
  EXPECT_NE(page.find("Apache ECharts\nCopyright"), std::string::npos);
  EXPECT_EQ(page.find("@data@"), std::string::npos);
  EXPECT_NE(page.find(R"("notes":["strength changes by 2.3 %)"), std::string::npos);
  Results other = made_up_results();
  other.outcomes[3].why = "changed";
  EXPECT_NE(page, study::page_of(other));
}

const study::Plotted& plotted(const study::Chart& chart, const std::string& name) {
  return *std::ranges::find(chart.plotted, name, &study::Plotted::name);
}

TEST(Charts, RunFromLeftToRightAndHoldWhatTheyDraw) {
  const Results results = made_up_results();
  const auto charts = study::charts_of(results);
  size_t places = 0, marks = 0;
  for (const study::Chart& chart : charts) {
    for (const study::ChartAxis* axis : {&chart.x, &chart.y}) {
      EXPECT_LT(axis->low, axis->high) << chart.id;
      ASSERT_FALSE(axis->ticks.empty()) << chart.id;
      for (size_t k = 0; k < axis->ticks.size(); ++k) {
        EXPECT_GE(axis->ticks[k].at, axis->low * (1 - 1e-9)) << chart.id;
        EXPECT_LE(axis->ticks[k].at, axis->high * (1 + 1e-9)) << chart.id;
        EXPECT_TRUE(k == 0 || axis->ticks[k - 1].at < axis->ticks[k].at) << chart.id;
      }
    }
    const auto inside = [&](double x, double y) {
      return x >= chart.x.low && x <= chart.x.high && y >= chart.y.low * (1 - 1e-9) && y <= chart.y.high;
    };
    for (const study::Plotted& one : chart.plotted) {
      for (const auto& [x, y] : one.places) {
        ++places;
        EXPECT_TRUE(inside(x, y)) << chart.id << one.name;
      }
      for (const study::Rows& rows : one.rows)
        for (const size_t row : rows) {
          ++marks;
          EXPECT_TRUE(inside(chart.x.place(chart.x.values[row]), chart.y.place(chart.y.values[row])))
              << chart.id << row;
        }
    }
    EXPECT_EQ(chart.corner, chart.id.ends_with("cost")       ? "↙ better"
                            : chart.section == "error-speed" ? "better ↘"
                                                             : "")
        << chart.id;
  }
  EXPECT_EQ(charts.size(), 91U);  // 10 errors against 3 speeds and 6 settings, and the truth
  EXPECT_GT(places, 500U);
  EXPECT_GT(marks, 15000U);
}

// Errors 4e-4 and 0 at dt 0.02 and 0.01: the least, 0, stands a decade below the others; no order goes
// through it.
TEST(Charts, AnErrorOfNothingHasAPlace) {
  Results results;
  add(results, {}, {}, 0.02, 4e-4), add(results, {}, {}, 0.01, 0);
  const auto charts = study::charts_of(results);
  const auto chart = std::ranges::find(charts, "trajectory_simulated_seconds", &study::Chart::id);
  ASSERT_NE(chart, charts.end());
  std::vector<std::string> labels;
  for (const study::Tick& tick : chart->y.ticks) labels.push_back(tick.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"0", "10⁻⁴", "10⁻³"}));
  EXPECT_NEAR(chart->y.place(0), 1e-5, 1e-18);
  EXPECT_EQ(chart->best, (study::Rows{1}));  // 100 simulated seconds per second, and exact
  EXPECT_EQ(plotted(*chart, "lattice, fixed").rows, (std::vector<study::Rows>{{0, 1}}));
}

TEST(Charts, AnOrderIsCutWhereItLeavesTheChart) {
  Results results;  // an error that stays, where theory expects it to fall by a million
  for (const int bits : {4, 14, 24}) add(results, {}, {{"widths.guard", std::to_string(bits)}}, 1, 0.5);
  const auto charts = study::charts_of(results);
  const auto chart = std::ranges::find(charts, "trajectory_by_arch-widths-guard", &study::Chart::id);
  ASSERT_NE(chart, charts.end());
  const auto& places = plotted(*chart, "2^-bits").places;
  ASSERT_EQ(places.size(), 3U);
  EXPECT_EQ(places[0], (study::Place{4, 0.5}));
  // 0.5 * 2^-b = 0.1 at b = log2(5).
  EXPECT_NEAR(places[2].first, 4 + std::log2(5), 1e-9);
  EXPECT_NEAR(places[2].second, 0.1, 1e-12);
}

TEST(Charts, PicturesOfEachChartTwiceTheSame) {
  Results results;
  for (const double dt : {0.01, 0.04}) add(results, {}, {}, dt, dt * dt);
  add(results, {}, {}, 0.08, 0).settings.engine = "it's new";
  const Scratch scratch;
  const auto names = study::write_charts(results, scratch.path("a"));
  EXPECT_EQ(names,
            (std::vector<std::string>{"force_max_simulated_seconds.png", "force_max_simulated_seconds.svg",
                                      "trajectory_simulated_seconds.png", "trajectory_simulated_seconds.svg",
                                      "force_max_by_dt.png", "force_max_by_dt.svg", "trajectory_by_dt.png",
                                      "trajectory_by_dt.svg"}));
  EXPECT_EQ(study::write_charts(results, scratch.path("b")), names);
  for (const std::string& name : names) {
    const std::string picture = read_text(scratch.path("a/" + name));
    EXPECT_EQ(picture, read_text(scratch.path("b/" + name))) << name;
    EXPECT_EQ(picture.substr(0, 5), name.ends_with(".png") ? "\x89PNG\r" : "<?xml");
  }
  const std::string svg = read_text(scratch.path("a/trajectory_by_dt.svg"));
  EXPECT_NE(svg.find("it's new, fixed"), std::string::npos);
  EXPECT_NE(svg.find("dt²"), std::string::npos);
}

// Titles, settings and directories are data: nothing is run, no name leaves the directory.
TEST(Charts, HostileTextIsDrawn) {
  const Scratch scratch;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(scratch.path(""));
  const std::string directory = std::string("| touch ") + kLoot + "; #";
  const auto names = study::write_charts(hostile_results(), directory);
  EXPECT_FALSE(take_loot());
  std::filesystem::current_path(before);
  EXPECT_FALSE(take_loot());
  // An axis' name in one piece, as gnuplot writes XML; markup would cut it.
  std::string label;
  for (const char c : "relative error of " + line_text(hostile_text()))
    label += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  size_t drawn = 0, hostile_keys = 0;
  for (const std::string& name : names) {
    EXPECT_EQ(name.find('/'), std::string::npos) << name;
    hostile_keys += name.find("regions") != std::string::npos;
    const std::string picture = read_text(scratch.path(directory + "/" + name));
    EXPECT_GT(picture.size(), 1000U) << name;
    if (!name.ends_with(".svg")) continue;
    EXPECT_EQ(picture.find("<script"), std::string::npos) << name;
    if (!name.starts_with("figure0")) continue;
    EXPECT_NE(picture.find(">" + label + "<"), std::string::npos) << name;
    ++drawn;
  }
  EXPECT_GT(hostile_keys, 0U);
  EXPECT_GT(drawn, 0U);
}

// The chart keeps its width, of which its axis' name tells the middle: beside short names and above long
// ones.
TEST(Charts, LongNamesStandBelow) {
  const auto middle = [](const std::string& machine) {
    Results results;
    for (const double dt : {0.01, 0.04}) add(results, {}, {}, dt, dt * dt).speed.machine = machine;
    const Scratch scratch;
    study::write_charts(results, scratch.path("charts"));
    const std::string svg = read_text(scratch.path("charts/trajectory_simulated_seconds.svg"));
    const size_t name = svg.find(">simulated seconds per second<"), at = svg.rfind("translate(", name);
    return name == std::string::npos ? 0.0 : std::stod(svg.substr(at + 10));
  };
  EXPECT_GT(middle(""), 450);  // of 1100
  EXPECT_GT(middle("a processor of which the name alone is as wide as a chart"), 550);
}

}  // namespace
}  // namespace cuboct::test
