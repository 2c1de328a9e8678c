// SPDX-License-Identifier: MIT
#include "study/sweep/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "model/base/error_parts.h"
#include "model/base/process.h"
#include "model/base/text.h"
#include "study/sweep/sqlite.h"
#include "study/sweep/truth_bytes.h"

namespace cuboct::study {
namespace {

constexpr const char* kFormat = "cuboct study 1";

constexpr const char* kTables =
    "CREATE TABLE IF NOT EXISTS meta(name TEXT PRIMARY KEY, value TEXT);"
    "CREATE TABLE IF NOT EXISTS truths(physics TEXT PRIMARY KEY, truth BLOB);"
    "CREATE TABLE IF NOT EXISTS rungs(physics TEXT, rung INTEGER, dt REAL, cutoff REAL, trajectory REAL,"
    " change REAL, PRIMARY KEY(physics, rung));"
    "CREATE TABLE IF NOT EXISTS points(numbers TEXT PRIMARY KEY, settings TEXT, status TEXT, why TEXT, dt "
    "REAL,"
    " pitch REAL, particles INTEGER, steps INTEGER, cost REAL, halo_bits INTEGER, table_bits INTEGER,"
    " force_median REAL, force_999 REAL, force_max REAL, trajectory REAL, drift_per_step REAL,"
    " drift_per_oscillation REAL, momentum REAL, machine TEXT);"
    "CREATE TABLE IF NOT EXISTS figures(numbers TEXT, figure INTEGER, name TEXT, value REAL, error REAL,"
    " PRIMARY KEY(numbers, figure));"
    "CREATE TABLE IF NOT EXISTS speeds(point TEXT PRIMARY KEY, numbers TEXT, settings TEXT, particle_steps "
    "REAL,"
    " simulated_seconds REAL, spread REAL, repeats INTEGER, machine TEXT);";

constexpr const char* kPointColumns =
    "numbers, settings, status, why, dt, pitch, particles, steps, cost, halo_bits, table_bits, force_median,"
    " force_999, force_max, trajectory, drift_per_step, drift_per_oscillation, momentum, machine";
constexpr const char* kSpeedColumns =
    "point, numbers, settings, particle_steps, simulated_seconds, spread, repeats, machine";

constexpr const char* kDamaged = "it is damaged: take another --out DIR, or remove the file and begin again";

const std::vector<std::string> kStatuses{"done", "unstable", "refused"};
const std::vector<std::string> kIntegrators{"euler", "verlet"};

template <class Enum>
Enum named(const std::vector<std::string>& names, const std::string& name) {
  for (size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return static_cast<Enum>(k);
  throw InputError(fmt::format("results with an unknown word '{}'", name));
}

std::string insert(const char* how, const char* table, const std::string& columns) {
  std::string marks = "?";
  for (const char c : columns)
    if (c == ',') marks += ", ?";
  return fmt::format("{} INTO {}({}) VALUES({})", how, table, columns, marks);
}

// One setting per line.
std::string text_of(const Settings& settings) {
  std::string text = fmt::format("engine={}\narithmetic={}\nintegrator={}\nthreads={}\n", settings.engine,
                                 name_of(settings.arithmetic),
                                 kIntegrators[static_cast<size_t>(settings.integrator)], settings.threads);
  for (const Change& change : settings.scene) text += fmt::format("scene.{}={}\n", change.key, change.value);
  for (const Change& change : settings.arch) text += fmt::format("arch.{}={}\n", change.key, change.value);
  return text;
}

int whole_number(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw InputError(fmt::format("results with '{}' for a whole number", text));
  return value;
}

Settings settings_of(const std::string& text) {
  Settings settings;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const size_t at = line.find('=');
    const std::string key = line.substr(0, at), value = at == std::string::npos ? "" : line.substr(at + 1);
    if (key == "engine")
      settings.engine = value;
    else if (key == "arithmetic")
      settings.arithmetic = named<Arithmetic>(arithmetic_names(), value);
    else if (key == "integrator")
      settings.integrator = named<Integrator>(kIntegrators, value);
    else if (key == "threads")
      settings.threads = whole_number(value);
    else if (key.starts_with("scene."))
      settings.scene.push_back({key.substr(6), value});
    else if (key.starts_with("arch."))
      settings.arch.push_back({key.substr(5), value});
  }
  return settings;
}

Outcome read_point(Query& row) {
  Outcome outcome;
  row.text();  // numbers
  outcome.settings = settings_of(row.text());
  outcome.status = named<Status>(kStatuses, row.text());
  outcome.why = row.text();
  outcome.dt = row.real();
  outcome.pitch = row.real();
  outcome.particles = static_cast<uint32_t>(row.integer());
  outcome.steps = static_cast<uint64_t>(row.integer());
  outcome.cost = row.real();
  outcome.halo_bits = static_cast<int>(row.integer());
  outcome.table_bits = static_cast<int>(row.integer());
  Errors& e = outcome.errors;
  for (double* value : {&e.force_median, &e.force_999, &e.force_max, &e.trajectory, &e.drift_per_step,
                        &e.drift_per_oscillation, &e.momentum})
    *value = row.real();
  outcome.machine = row.text();
  return outcome;
}

Speed read_speed(Query& row) {
  Speed speed;
  speed.particle_steps = row.real();
  speed.simulated_seconds = row.real();
  speed.spread = row.real();
  speed.repeats = static_cast<int>(row.integer());
  speed.machine = row.text();
  return speed;
}

// Of a file that may be another's: what is kept must be of the study.
void check_truth(const Truth& truth, const Study& study) {
  const size_t figures = study.figures.size();
  const auto fits = [&](const std::vector<double>& values) {
    return values.empty() || values.size() == figures;
  };
  const bool whole = !truth.rungs.empty() && fits(truth.figures) &&
                     truth.grid.samples == study.grid.samples && truth.grid.sample == study.grid.sample &&
                     truth.grid.horizon <= truth.grid.samples &&
                     std::ranges::all_of(truth.rungs, [&](const Rung& rung) { return fits(rung.figures); });
  if (!whole)
    throw InputError("a truth in the results is not of this study", "remove the results and begin again");
}

// A copy of another's results, rows of its log included: SQLite leaves files beside a database that it reads,
// and needs a directory where it may.
class Copy {
 public:
  Copy(const std::string& from, const std::string& own) {
    namespace fs = std::filesystem;
    std::error_code error;
    if (fs::equivalent(from, own, error)) throw InputError(fmt::format("{} is this study's own", from));
    const int lock = open((from + ".lock").c_str(), O_RDONLY | O_CLOEXEC);
    const bool free = lock < 0 || flock(lock, LOCK_SH | LOCK_NB) == 0;
    if (free) fs::copy_file(from, path(), error);
    const std::string log = from + "-wal";
    if (std::error_code none; free && !error && fs::exists(log, none))
      fs::copy_file(log, path() + "-wal", error);
    if (lock >= 0) close(lock);
    if (!free) throw InputError(fmt::format("another process is at work on {}", from));
    if (error) throw InputError(fmt::format("cannot copy {}: {}", from, error.message()));
  }
  std::string path() const { return scratch_.path("results.db"); }

 private:
  Scratch scratch_;
};

}  // namespace

struct Store::Impl {
  Impl(const std::string& path, const Study& study) : study(study), path(path), database(path, true) {}

  void check();
  Outcome read_outcome(Query& point) const;  // with its figures
  std::string meta(const std::string& name) const {
    Query row(database, "SELECT value FROM meta WHERE name = ?");
    return row.bind(name).next() ? row.text() : "";
  }

  // Of rows that do not name theirs: empty where it is the one that began the results.
  std::string machine_of(const std::string& named) const {
    return named.empty() && here != meta("machine") ? here : named;
  }

  const Study& study;
  const std::string path;
  const std::string here = this_machine();
  Database database;
  int lock = -1;
  mutable std::mutex mutex;
};

// One process at a time: two would measure the same points, and one another's speed.
void Store::Impl::check() {
  const std::string hash = fmt::format("{:016x}", study.hash);
  if (const std::string format = meta("format"); !format.empty() && format != kFormat)
    throw InputError(fmt::format("results of the format '{}', not '{}'", format, kFormat));
  if (const std::string there = meta("study"); !there.empty() && there != hash)
    throw InputError("these are results of another study: its scene, arch, figures or times were others",
                     "take another directory, or remove this one's results.db");
  // A file that is refused later stays as it is.
  if (meta("study") == hash && meta("title") == study.title && meta("scene") == study.base.scene_path &&
      !meta("machine").empty())
    return;
  Query put(database,
            "INSERT OR REPLACE INTO meta VALUES('format', ?), ('study', ?), ('title', ?), ('scene', ?)");
  put.bind(kFormat).bind(hash).bind(study.title).bind(study.base.scene_path).done();
  Query machine(database, "INSERT OR IGNORE INTO meta VALUES('machine', ?)");
  machine.bind(here).done();
}

// A row of `points` has a row of `figures` for each of the study's, measured or not.
Outcome Store::Impl::read_outcome(Query& point) const {
  Outcome outcome = read_point(point);
  Query row(database, "SELECT value, error FROM figures WHERE numbers = ? ORDER BY figure");
  row.bind(outcome.settings.numbers_key());
  while (row.next()) {
    outcome.errors.values.push_back(row.real());
    outcome.errors.figures.push_back(row.real());
  }
  if (const size_t found = outcome.errors.figures.size(); found != study.figures.size())
    throw InputError(
        fmt::format("{}: a point has {} figures, the study {}", path, found, study.figures.size()), kDamaged);
  return outcome;
}

Store::Store(const std::string& path, const Study& study) {
  // The lock goes with the process, however it ends.
  const int lock = open((path + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock < 0) throw InputError(fmt::format("cannot write {}.lock", path));
  if (flock(lock, LOCK_EX | LOCK_NB) != 0) {
    close(lock);
    throw InputError(fmt::format("another process is at work on {}", path));
  }
  try {
    impl_ = std::make_unique<Impl>(path, study);
    impl_->lock = lock;
    impl_->database.check(kTables);
    // With a write-ahead log a row that was put survives the process; only a loss of power may take the last
    // ones.
    impl_->database.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;");
    impl_->database.run(fmt::format("BEGIN; {} COMMIT", kTables));  // all, or none
    impl_->check();
  } catch (const InputError& error) {
    close(lock);
    const ErrorParts parts = parts_of(error);
    if (parts.message.find(line_text(path)) != std::string::npos) throw;
    throw InputError(fmt::format("{}: {}", path, parts.message), parts.hint);
  }
}

Store::~Store() {
  if (impl_ && impl_->lock >= 0) close(impl_->lock);
}

void Store::put_truth(const std::string& physics, const Truth& truth) {
  const std::lock_guard guard(impl_->mutex);
  impl_->database.run("BEGIN");
  Query put(impl_->database, "INSERT OR REPLACE INTO truths VALUES(?, ?)");
  put.bind(physics).bind_blob(bytes_of(truth)).done();
  for (size_t k = 0; k < truth.rungs.size(); ++k) {
    const Rung& rung = truth.rungs[k];
    Query row(impl_->database, "INSERT OR REPLACE INTO rungs VALUES(?, ?, ?, ?, ?, ?)");
    row.bind(physics).bind(static_cast<int64_t>(k)).bind(rung.dt).bind(rung.cutoff);
    row.bind(rung.trajectory).bind(rung.change).done();
  }
  impl_->database.run("COMMIT");
}

std::optional<Truth> Store::truth(const std::string& physics) const {
  const std::lock_guard guard(impl_->mutex);
  Query row(impl_->database, "SELECT truth FROM truths WHERE physics = ?");
  if (!row.bind(physics).next()) return std::nullopt;
  Truth truth = truth_of(row.blob());
  check_truth(truth, impl_->study);
  return truth;
}

void Store::drop_truth(const std::string& physics) {
  const std::lock_guard guard(impl_->mutex);
  for (const char* table : {"truths", "rungs"})
    Query(impl_->database, fmt::format("DELETE FROM {} WHERE physics = ?", table)).bind(physics).done();
}

void Store::put_errors(const Outcome& outcome) {
  const std::lock_guard guard(impl_->mutex);
  const std::string numbers = outcome.settings.numbers_key();
  const Errors& e = outcome.errors;
  impl_->database.run("BEGIN");
  Query put(impl_->database, insert("INSERT OR REPLACE", "points", kPointColumns));
  put.bind(numbers).bind(text_of(outcome.settings)).bind(kStatuses[static_cast<size_t>(outcome.status)]);
  put.bind(outcome.why).bind(outcome.dt).bind(outcome.pitch).bind(static_cast<int64_t>(outcome.particles));
  put.bind(static_cast<int64_t>(outcome.steps)).bind(outcome.cost).bind(int64_t{outcome.halo_bits});
  put.bind(int64_t{outcome.table_bits}).bind(e.force_median).bind(e.force_999).bind(e.force_max);
  put.bind(e.trajectory).bind(e.drift_per_step).bind(e.drift_per_oscillation).bind(e.momentum);
  put.bind(impl_->machine_of(outcome.machine)).done();
  for (size_t k = 0; k < e.figures.size(); ++k) {
    Query row(impl_->database, "INSERT OR REPLACE INTO figures VALUES(?, ?, ?, ?, ?)");
    row.bind(numbers).bind(static_cast<int64_t>(k)).bind(impl_->study.figures[k].name);
    row.bind(e.values[k]).bind(e.figures[k]).done();
  }
  impl_->database.run("COMMIT");
}

std::optional<Outcome> Store::errors(const Settings& settings) const {
  const std::lock_guard guard(impl_->mutex);
  Query row(impl_->database, fmt::format("SELECT {} FROM points WHERE numbers = ?", kPointColumns));
  if (!row.bind(settings.numbers_key()).next()) return std::nullopt;
  Outcome outcome = impl_->read_outcome(row);
  outcome.settings = settings;
  return outcome;
}

bool Store::has_errors(const Settings& settings) const {
  const std::lock_guard guard(impl_->mutex);
  Query row(impl_->database, "SELECT 1 FROM points WHERE numbers = ?");
  return row.bind(settings.numbers_key()).next();
}

void Store::put_speed(const Settings& settings, const Speed& speed) {
  const std::lock_guard guard(impl_->mutex);
  Query put(impl_->database, insert("INSERT OR REPLACE", "speeds", kSpeedColumns));
  put.bind(settings.key()).bind(settings.numbers_key()).bind(text_of(settings)).bind(speed.particle_steps);
  put.bind(speed.simulated_seconds).bind(speed.spread).bind(int64_t{speed.repeats});
  put.bind(impl_->machine_of(speed.machine)).done();
}

std::optional<Speed> Store::speed(const Settings& settings) const {
  const std::lock_guard guard(impl_->mutex);
  Query row(impl_->database,
            "SELECT particle_steps, simulated_seconds, spread, repeats, machine FROM speeds WHERE point = ?");
  if (!row.bind(settings.key()).next()) return std::nullopt;
  return read_speed(row);
}

bool Store::has_speed(const Settings& settings) const { return speed(settings).has_value(); }

namespace {

// Another's results of the same study.
class Other {
 public:
  Other(const std::string& path, const std::string& own, const Study& study)
      : copied_((check_readable(path), path), own), database(copied_.path(), false, path) {
    database.check(kTables);
    std::string hash;
    Query row(database, "SELECT name, value FROM meta");
    while (row.next()) {
      const std::string name = row.text();
      const std::string value = row.text();
      if (name == "study") hash = value;
      if (name == "machine") machine = value;
    }
    if (hash != fmt::format("{:016x}", study.hash))
      throw InputError(fmt::format(
          "{} holds results of another study: its scene, arch, figures or times are others", path));
  }

 private:
  static void check_readable(const std::string& path) {
    if (access(path.c_str(), R_OK) != 0) throw InputError(fmt::format("cannot read {}", path));
  }
  const Copy copied_;

 public:
  const Database database;
  std::string machine;
};

}  // namespace

void Store::check(const std::string& path, const Study& study) { Other(path, "", study); }

int Store::add(const std::string& path) {
  const std::lock_guard guard(impl_->mutex);
  Other from(path, impl_->path, impl_->study);
  const Database& other = from.database;
  std::string machine = from.machine;
  if (machine == impl_->meta("machine")) machine.clear();  // a part of the study, computed beside it
  int came = 0;
  const auto copy = [&](const char* table, const std::string& columns, bool has_machine) {
    Query row(other, fmt::format("SELECT {} FROM {} ORDER BY 1, 2", columns, table));
    while (row.next()) {
      Query put(impl_->database, insert("INSERT OR IGNORE", table, columns));
      if (has_machine)
        row.copy_to(put, machine);
      else
        row.copy_to(put);
      put.done();
      came += has_machine ? sqlite3_changes(impl_->database.handle()) : 0;
    }
  };
  impl_->database.run("BEGIN");
  copy("points", kPointColumns, true);
  copy("figures", "numbers, figure, name, value, error", false);
  copy("speeds", kSpeedColumns, true);
  impl_->database.run("COMMIT");
  return came;
}

Results Store::results() const {
  Results results;
  if (auto own = truth("")) results.truth = std::move(*own);
  results.truth.states.clear();
  results.truth.horizon = {};
  const Study& study = impl_->study;
  results.title = study.title;
  results.scene = study.base.scene_path;
  for (const Figure& figure : study.figures) results.figure_names.push_back(figure.name);
  results.figure_units = study.figure_units;
  std::set<std::string> shown, shown_numbers;
  for (const Settings& settings : study.points) {
    auto outcome = errors(settings);
    if (!outcome) continue;
    if (const auto measured = speed(settings)) outcome->speed = *measured;
    shown.insert(settings.key());
    shown_numbers.insert(settings.numbers_key());
    results.outcomes.push_back(std::move(*outcome));
  }
  const std::lock_guard guard(impl_->mutex);
  results.machine = impl_->meta("machine");
  // What is no point of the study: one that it had before, or from elsewhere. By speeds, then points without
  // any.
  Query speeds(impl_->database,
               "SELECT point, numbers, settings, particle_steps, simulated_seconds,"
               " spread, repeats, machine FROM speeds ORDER BY point");
  while (speeds.next()) {
    const std::string key = speeds.text(), numbers = speeds.text(), settings = speeds.text();
    if (!shown.insert(key).second) continue;
    Query row(impl_->database, fmt::format("SELECT {} FROM points WHERE numbers = ?", kPointColumns));
    Outcome outcome;
    if (row.bind(numbers).next()) outcome = impl_->read_outcome(row);
    outcome.settings = settings_of(settings);
    outcome.speed = read_speed(speeds);
    shown_numbers.insert(numbers);
    results.outcomes.push_back(std::move(outcome));
  }
  Query points(impl_->database, fmt::format("SELECT {} FROM points ORDER BY numbers", kPointColumns));
  while (points.next()) {
    Outcome outcome = impl_->read_outcome(points);
    if (shown_numbers.insert(outcome.settings.numbers_key()).second)
      results.outcomes.push_back(std::move(outcome));
  }
  return results;
}

std::string this_machine() {
  std::ifstream in("/proc/cpuinfo");
  std::string model = "unknown processor";
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  return fmt::format("{}, {} cores", model, std::thread::hardware_concurrency());
}

}  // namespace cuboct::study
