// SPDX-License-Identifier: MIT
// Results on disk: what was put comes back to the last bit, rows of other machines come in, those of other
// studies do not; a runner computes what lacks and nothing else.
#include "study/sweep/store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

#include "model/base/error.h"
#include "model/base/output.h"
#include "study/sweep/measure_errors.h"
#include "study/sweep/runner.h"
#include "study/sweep/truth_bytes.h"
#include "tests/study/rows.h"
#include "tests/study/small_study.h"
#include "tests/support/refused_with.h"

namespace cuboct::study {
namespace {

using test::rows;
using test::SmallStudy;

constexpr const char* kStudy =
    "[truth]\nrungs = 2\n[[figure]]\nkind = \"mean\"\ncurve = \"energy.potential\"\n"
    "[[sweep]]\ndt_safety = [0.2, 0.4]\nthreads = [1, 2]\n[[sweep]]\ncell_edge = \"0.6 mm\"\n";

const RunnerOptions kQuiet{.jobs = 2, .speed = false, .progress = false};

// Bit for bit, nan included.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
void expect_same_errors(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.settings, b.settings);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.why, b.why);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_TRUE(same(a.dt, b.dt) && same(a.cost, b.cost) && same(a.pitch, b.pitch));
  EXPECT_TRUE(same(a.errors.force_median, b.errors.force_median) &&
              same(a.errors.force_max, b.errors.force_max));
  EXPECT_TRUE(same(a.errors.trajectory, b.errors.trajectory) && same(a.errors.momentum, b.errors.momentum));
  EXPECT_TRUE(same(a.errors.drift_per_step, b.errors.drift_per_step));
  ASSERT_EQ(a.errors.figures.size(), b.errors.figures.size());
  for (size_t k = 0; k < a.errors.figures.size(); ++k)
    EXPECT_TRUE(same(a.errors.figures[k], b.errors.figures[k]) &&
                same(a.errors.values[k], b.errors.values[k]));
}

TEST(Store, KeepsEverythingToTheLastBit) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string path = files.path("results.db");
  std::vector<Outcome> first;
  Truth truth;
  {
    Store store(path, study);
    Runner runner(study, store, kQuiet);
    runner.run();
    truth = runner.truth();
    for (const Settings& settings : study.points)  // not by way of the store
      first.push_back(measure_errors(study, truth, truth, settings));
    store.put_speed(study.points[1], {1e6, 0.25, 0.03, 5});
  }
  EXPECT_EQ(rows(path, "select count(*) from points"), "3|\n");  // threads share their errors
  Store store(path, study);
  const Results results = store.results();
  ASSERT_EQ(results.outcomes.size(), 5U);
  for (size_t k = 0; k < 5; ++k) expect_same_errors(results.outcomes[k], first[k]);
  EXPECT_EQ(results.outcomes[4].status, Status::refused);
  EXPECT_EQ(results.outcomes[1].speed.particle_steps, 1e6);
  EXPECT_EQ(results.outcomes[1].speed.repeats, 5);
  EXPECT_TRUE(std::isnan(results.outcomes[0].speed.particle_steps));
  EXPECT_EQ(results.figure_names, std::vector<std::string>{"mean"});
  EXPECT_EQ(results.figure_units, std::vector<std::string>{"J"});
  const auto kept = store.truth("");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->horizon.body.x, truth.horizon.body.x);
  EXPECT_EQ(kept->states.size(), truth.states.size());
  EXPECT_EQ(kept->rungs.back().figures, truth.rungs.back().figures);
  EXPECT_EQ(kept->notes, truth.notes);
}

// Results of a stranger: what they keep must be of the study, as it is indexed by the study's.
TEST(Store, ATruthOfAnotherStudyIsRefused) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  Store store(files.path("results.db"), study);
  Truth truth;
  truth.grid = study.grid;
  truth.rungs = {{.dt = 1, .cutoff = 1, .figures = {1}}};
  truth.figures = {1};
  store.put_truth(truth);
  EXPECT_EQ(store.truth("")->figures, truth.figures);
  const auto refused = [&](const std::function<void(Truth&)>& change) {
    Truth other = truth;
    change(other);
    store.put_truth(other);
    EXPECT_THROW(store.truth(""), InputError);
  };
  refused([](Truth& t) { t.figures = {1, 2}; });
  refused([](Truth& t) { t.rungs.clear(); });
  refused([](Truth& t) { t.rungs[0].figures = {1, 2, 3}; });
  refused([](Truth& t) { t.grid.samples = uint64_t{1} << 60; });
  refused([](Truth& t) { t.grid.sample *= 2; });
  refused([](Truth& t) { t.grid.horizon = t.grid.samples + 1; });
  // Bodies of other particles.
  KeptState kept;
  kept.body.x = kept.body.v = {Vec3::Zero()};
  kept.body.type = {200};
  Truth other = truth;
  other.states = {kept};
  other.horizon = kept;
  EXPECT_EQ(measure_errors(study, other, other, study.points[0]).status, Status::refused);
  // Bytes that say more than there are.
  std::string bytes = bytes_of(truth);
  bytes[0] = 127;
  EXPECT_THROW(truth_of(bytes), InputError);
  bytes[7] = 127;
  EXPECT_THROW(truth_of(bytes), InputError);
}

TEST(Store, ARunnerComputesWhatLacks) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string path = files.path("results.db");
  std::vector<Outcome> first;
  {
    Store store(path, study);
    Runner runner(study, store, kQuiet);
    first = runner.errors_of(study.points);
  }
  rows(path, "delete from points where settings like '%0.4%'");
  rows(path,
       "update points set momentum = 7 where settings like '%0.2%'");  // what is there is not done again
  Store store(path, study);
  Runner runner(study, store, kQuiet);
  const std::vector<Outcome> again = runner.errors_of(study.points);
  EXPECT_EQ(again[0].errors.momentum, 7);
  expect_same_errors(again[2], first[2]);
}

// A truth whose refinement was cut off goes on with the next rung, and ends the same.
TEST(Store, ABegunTruthGoesOn) {
  const SmallStudy files;
  const Study study = read_study(files.study("[truth]\nrungs = 4\ntolerance = 1e-9\n[[sweep]]\n"));
  const Truth whole = make_truth(study, 1);
  std::vector<Truth> saved;
  make_truth(study, 1, {}, [&](const Truth& truth) { saved.push_back(truth); });
  ASSERT_EQ(saved.size(), 4U);
  int rungs = 0;
  const Truth resumed = make_truth(study, 1, saved[1], [&](const Truth&) { ++rungs; });
  EXPECT_EQ(rungs, 2);
  EXPECT_EQ(resumed.horizon.body.x, whole.horizon.body.x);
  EXPECT_EQ(resumed.floor, whole.floor);
  EXPECT_EQ(resumed.notes, whole.notes);
}

TEST(Store, RefusesAnotherStudyAndASecondProcess) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string path = files.path("results.db");
  const auto error_of = [&](const Study& other) -> std::string {
    return refused_with([&] { Store store(path, other); });
  };
  {
    const Store store(path, study);
    EXPECT_EQ(error_of(study), "another process is at work on " + path);
  }
  const Study other = read_study(files.study(std::string("[change.run]\nsteps = 80\n") + kStudy));
  EXPECT_EQ(error_of(other),
            path +
                ": these are results of another study: its scene, arch, figures or times were others\n"
                "  hint: take another directory, or remove this one's results.db");
  EXPECT_EQ(error_of(study), "accepted");
}

TEST(Store, TakesInRowsOfAnotherMachine) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string elsewhere = files.path("elsewhere.db");
  {
    Store store(elsewhere, study);
    Outcome outcome;
    outcome.settings.engine = "gpu";
    outcome.settings.scene = {{"run.dt_safety", "0.3"}};
    outcome.errors.trajectory = 0.125;
    outcome.errors.figures = outcome.errors.values = {0.5};
    store.put_errors(outcome);
    store.put_speed(outcome.settings, {2e9, 3, 0.01, 3});
  }
  rows(elsewhere, "update meta set value = 'a GPU' where name = 'machine'");
  Store store(files.path("results.db"), study);
  EXPECT_EQ(store.add(elsewhere), 2);
  EXPECT_EQ(store.add(elsewhere), 0);  // they are here
  const Results results = store.results();
  ASSERT_EQ(results.outcomes.size(), 1U);
  EXPECT_EQ(results.outcomes[0].settings.engine, "gpu");
  EXPECT_EQ(results.outcomes[0].settings.scene[0].value, "0.3");
  EXPECT_EQ(results.outcomes[0].errors.trajectory, 0.125);
  EXPECT_EQ(results.outcomes[0].errors.figures, std::vector<double>{0.5});
  EXPECT_EQ(results.outcomes[0].speed.particle_steps, 2e9);
  EXPECT_EQ(results.outcomes[0].measured_on(), "a GPU");
  EXPECT_EQ(results.machine, this_machine());
  const Study other = read_study(files.study(std::string("[change.run]\nsteps = 80\n") + kStudy));
  Store another(files.path("another.db"), other);
  EXPECT_THROW(another.add(elsewhere), InputError);
}

TEST(Store, SaysOfAFileThatItIsNone) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  Store store(files.path("results.db"), study);
  const auto refusal = [&](const std::string& text) {
    std::ofstream(files.path("other.db"), std::ios::binary) << text;
    return refused_with([&] { store.add(files.path("other.db")); });
  };
  const std::string hint =
      "\n  hint: 'cuboct explore' makes such a file: remove this one and begin again, or take another";
  const std::string name = files.path("other.db");
  EXPECT_EQ(refusal(std::string(10000, 'x')), name + " holds no results of a study" + hint);
  EXPECT_EQ(refusal(""), name + " holds no results of a study as cuboct keeps them" + hint);
  std::string whole = read_text(files.path("results.db"));
  ASSERT_GE(whole.size(), 4096U);
  whole.replace(100, 3000, 3000, '\xff');  // of the first page, behind its head
  EXPECT_EQ(refusal(whole), name + " is damaged" + hint);
}

TEST(Store, APointWithoutItsFiguresIsRefused) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string path = files.path("results.db");
  {
    Store store(path, study);
    Outcome outcome;
    outcome.settings = study.points[0];
    outcome.errors.values = outcome.errors.figures = {0.5};
    store.put_errors(outcome);
    EXPECT_EQ(store.errors(study.points[0])->errors.values, std::vector{0.5});
  }
  rows(path, "DELETE FROM figures");
  const std::string expected = path +
                               ": a point has 0 figures, the study 1\n  hint: it is damaged: take another "
                               "--out DIR, or remove the file and begin again";
  EXPECT_EQ(refused_with([&] { Store(path, study).errors(study.points[0]); }), expected);
  EXPECT_EQ(refused_with([&] { Store(path, study).results(); }), expected);
  rows(path, "DROP TABLE figures");
  EXPECT_EQ(
      refused_with([&] { Store(path, study); }),
      path +
          " holds no results of a study as cuboct keeps them\n  hint: 'cuboct explore' makes such a file: "
          "remove this one and begin again, or take another");
}

// What SQLite would run, or never come to the end of.
TEST(Store, RunsNothingThatAnothersFileSays) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string path = files.path("results.db"), other = files.path("other.db");
  { const Store store(other, study); }
  const std::string whole = read_text(other);
  const auto opened = [&](const std::function<void()>& change) {
    std::ofstream(other, std::ios::binary) << whole;
    change();
    std::string told[2];
    for (const bool added : {true, false}) {
      told[added] = refused_with([&] {
        Store store(added ? path : other, study);
        if (added) store.add(other);
      });
    }
    EXPECT_EQ(told[0], told[1]);
    std::filesystem::remove(other + "-journal");
    return told[0];
  };
  const std::string hint =
      "\n  hint: 'cuboct explore' makes such a file: remove this one and begin again, or take another";
  EXPECT_EQ(opened([] {}), "accepted");
  for (const char* schema :
       {"CREATE VIEW more AS SELECT 1", "CREATE TRIGGER t AFTER INSERT ON meta BEGIN DELETE FROM points; END",
        "CREATE INDEX i ON points(hex(zeroblob(length(numbers))))",
        "ALTER TABLE points ADD COLUMN more TEXT AS (hex(zeroblob(1000)))",
        "DROP TABLE figures; CREATE VIEW figures AS WITH RECURSIVE r(k) AS (SELECT 1 UNION ALL SELECT k + 1 "
        "FROM r) SELECT k AS numbers, k AS figure, 'a' AS name, k AS value, k AS error FROM r"})
    EXPECT_EQ(opened([&] { rows(other, schema); }),
              other + " holds no results of a study as cuboct keeps them" + hint)
        << schema;
  // Behind the root of `meta` eight levels of pages. Each is the child of the one before, sixty-one times:
  // 10^14 rows.
  EXPECT_EQ(opened([&] {
              const auto number = [&](const char* sql) {
                return static_cast<size_t>(std::stoul(rows(other, sql)));
              };
              const size_t root = number("SELECT rootpage FROM sqlite_schema WHERE name = 'meta'");
              const size_t size = number("PRAGMA page_size"), levels = 8;
              std::string bytes = read_text(other);
              const size_t pages = bytes.size() / size;
              const auto put = [](std::string& to, size_t at, size_t width, size_t value) {
                for (size_t k = 0; k < width; ++k)
                  to[at + k] = static_cast<char>(value >> 8 * (width - 1 - k));
              };
              const std::string leaf = bytes.substr((root - 1) * size, size);
              for (size_t level = 0; level < levels; ++level) {
                const size_t child = pages + level + 1;
                std::string page(size, '\0');
                page[0] = 5;  // of a table, with children
                put(page, 3, 2, 60), put(page, 5, 2, size - 300), put(page, 8, 4, child);
                for (size_t cell = 0; cell < 60; ++cell) {
                  const size_t at = size - 300 + 5 * cell;
                  put(page, 12 + 2 * cell, 2, at), put(page, at, 4, child), put(page, at + 4, 1, cell + 1);
                }
                if (level == 0)
                  bytes.replace((root - 1) * size, size, page);
                else
                  bytes += page;
              }
              bytes += leaf;
              put(bytes, 28, 4, pages + levels);
              std::ofstream(other, std::ios::binary) << bytes;
            }),
            other + " is damaged" + hint);
}

// Of a store to go on with: what its journal says would be undone, and a file that it names be removed.
TEST(Store, AStrangersJournalIsRefused) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string path = files.path("results.db");
  { const Store store(path, study); }
  std::ofstream(path + "-journal") << "journal";
  EXPECT_EQ(
      refused_with([&] { const Store store(path, study); }),
      path + "-journal is not of cuboct, and would change " + path + "\n  hint: remove it, or both files");
  EXPECT_EQ(read_text(path + "-journal"), "journal");
}

// Of a store that was killed: rows that stand in its log alone come too, and nothing is left beside it.
TEST(Store, TakesInRowsWithoutATrace) {
  namespace fs = std::filesystem;
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  fs::create_directory(files.path("killed"));
  const std::string killed = files.path("killed/results.db");
  {
    Store live(files.path("live.db"), study);
    Outcome outcome;
    outcome.settings = study.points[0];
    outcome.errors.figures = outcome.errors.values = {0.5};
    live.put_errors(outcome);
    fs::copy_file(files.path("live.db"), killed);
    fs::copy_file(files.path("live.db-wal"), killed + "-wal");
    Store store(files.path("results.db"), study);
    EXPECT_THROW(store.add(files.path("live.db")), InputError);  // at work
    EXPECT_THROW(store.add(files.path("results.db")), InputError);
  }
  const auto files_there = [&] {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::directory_iterator(files.path("killed")))
      found[entry.path().filename().string()] = read_text(entry.path().string());
    return found;
  };
  const auto before = files_there();
  Store store(files.path("results.db"), study);
  EXPECT_EQ(store.add(killed), 1);
  EXPECT_TRUE(store.has_errors(study.points[0]));
  EXPECT_EQ(files_there(), before);
}

// What this machine's errors and another machine's speed make is a point of the other: speeds tell machines
// apart. Rows that a store has from a third keep their machine.
TEST(Store, RowsKeepTheirMachine) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const auto outcome_of = [&](size_t point) {
    Outcome outcome;
    outcome.settings = study.points[point];
    outcome.errors.figures = outcome.errors.values = {0.5};
    return outcome;
  };
  const std::string elsewhere = files.path("elsewhere.db");
  {
    Store store(elsewhere, study);
    Outcome third = outcome_of(2);
    third.machine = "a third machine";
    store.put_errors(third);
    store.put_speed(study.points[0], {1e6, 1, 0.01, 3});
    store.put_speed(study.points[2], {2e6, 1, 0.01, 3, "a third machine"});
  }
  rows(elsewhere, "update meta set value = 'another machine' where name = 'machine'");
  const std::string beside = files.path("beside.db");
  Store(beside, study).put_speed(study.points[1], {1e6, 1, 0.01, 3});  // on this machine
  Store store(files.path("results.db"), study);
  store.put_errors(outcome_of(0));
  store.add(elsewhere);
  store.add(beside);
  const Results results = store.results();
  ASSERT_EQ(results.outcomes.size(), 4U);  // each with threads 1 and 2, which share their errors
  EXPECT_EQ(results.outcomes[0].measured_on(), "another machine");
  EXPECT_EQ(results.outcomes[1].speed.repeats, 3);
  EXPECT_EQ(results.outcomes[1].measured_on(), "");
  EXPECT_EQ(results.outcomes[2].measured_on(), "a third machine");
  EXPECT_EQ(results.outcomes[3].measured_on(), "a third machine");
}

// Results that another machine began, and that are gone on with here.
TEST(Store, WhoGoesOnElsewhereIsNamed) {
  const SmallStudy files;
  const Study study = read_study(files.study(kStudy));
  const std::string path = files.path("results.db");
  const auto put = [&](size_t point) {
    Store store(path, study);
    Outcome outcome;
    outcome.settings = study.points[point];
    outcome.errors.figures = outcome.errors.values = {0.5};
    store.put_errors(outcome);
    store.put_speed(outcome.settings, {1e6, 1, 0.01, 3});
  };
  put(0);
  rows(path, "update meta set value = 'another machine' where name = 'machine'");
  put(2);
  const Results results = Store(path, study).results();
  EXPECT_EQ(results.machine, "another machine");
  ASSERT_EQ(results.outcomes.size(), 4U);
  EXPECT_EQ(results.outcomes[0].measured_on(), "");
  EXPECT_EQ(results.outcomes[2].measured_on(), this_machine());
}

}  // namespace
}  // namespace cuboct::study
