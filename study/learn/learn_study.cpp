// SPDX-License-Identifier: MIT
#include "study/learn/learn_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "model/base/atom_units.h"
#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/config/file_kind.h"

namespace cuboct::learn {
namespace {

constexpr double kMassUnit = kElectronVolt * 1e-24 / (kAngstrom * kAngstrom);  // kg
constexpr int kMostCells = 400, kMostPoints = 100, kMostFrames = 1000, kMostSeeds = 100, kMostDegree = 12;

double length(const ConfigTable& table, const char* key, double otherwise, const Range& range) {
  return table.number_or(key, quantity::length, otherwise * kAngstrom, range) / kAngstrom;
}
double force(const ConfigTable& table, const char* key, double otherwise) {
  constexpr double kUnit = kElectronVolt / kAngstrom;
  return table.number_or(key, quantity::force, otherwise * kUnit, Range::positive()) / kUnit;
}
double time(const ConfigTable& table, const char* key, double otherwise) {
  return table.number_or(key, quantity::time, otherwise * kPicosecond, Range::positive()) / kPicosecond;
}

SheetInput read_sheet(const ConfigTable& table) {
  SheetInput out;
  const std::vector<std::string> names = tersoff_set_names();
  out.potential = names[table.at("potential").choice("potential", names)];
  out.tersoff = tersoff_set(out.potential);
  out.bond = length(table, "bond", 1.46, Range::positive());
  out.thickness = length(table, "thickness", 3.35, Range::positive());
  out.mass = table.number("mass", quantity::mass, Range::positive()) / kMassUnit;
  const ConfigValue cells = table.at("cells");
  const std::vector<ConfigValue> items = cells.items();
  if (items.size() != 2) cells.fail("'cells' needs two numbers, along x and y");
  for (size_t a = 0; a < 2; ++a) out.cells[a] = static_cast<int>(items[a].integer(4, kMostCells));
  table.done();
  return out;
}

GridInput read_grid(const ConfigTable& table) {
  GridInput out;
  out.points = static_cast<int>(table.at("points").integer(6, kMostPoints));
  out.fine_points = static_cast<int>(table.integer_or("fine_points", 6, kMostPoints, out.fine_points));
  out.coarse_points = static_cast<int>(table.integer_or("coarse_points", 6, kMostPoints, out.coarse_points));
  out.radius = table.number_or("radius", quantity::number, out.radius, {.low = 1, .high = 5});
  out.noise = length(table, "noise", out.noise, Range::positive());
  out.tube = length(table, "tube", out.tube, Range::positive());
  table.done();
  return out;
}

// Discs stand half an edge apart, and pull in turn one way and the other: beyond that they undo one another.
DiscInput read_disc(const ConfigTable& table, const SheetInput& sheet) {
  DiscInput out;
  out.force = static_cast<int>(table.at("force").choice("axis", {"x", "y"}));
  out.centres = static_cast<int>(table.at("centres").choice("axis", {"x", "y"}));
  const ConfigValue radius = table.at("radius");
  out.radius = radius.number(quantity::length, Range::positive()) / kAngstrom;
  const auto axis = static_cast<size_t>(out.centres);
  const double edge = (axis == 0 ? std::sqrt(3) : 3) * sheet.bond * sheet.cells[axis];
  if (out.radius > edge / 2)
    radius.fail(fmt::format("a disc of {:.4g} angstrom is wider than half the sheet's edge, {:.4g} angstrom",
                            out.radius, edge));
  table.done();
  return out;
}

StaticInput read_static(const ConfigTable& table, const SheetInput& sheet) {
  StaticInput out;
  out.strain = table.number_or("strain", quantity::number, out.strain, {.low = 1e-6, .high = 0.02});
  out.waves = static_cast<int>(table.integer_or("waves", 1, 20, out.waves));
  out.force = force(table, "force", out.force);
  for (const ConfigTable& disc : table.tables("disc")) out.discs.push_back(read_disc(disc, sheet));
  if (out.discs.empty()) table.fail("no [[static.disc]]: there is nothing to validate with");
  table.done();
  return out;
}

FractureInput read_fracture(const ConfigTable& table) {
  FractureInput out;
  out.slit = length(table, "slit", out.slit, Range::positive());
  out.grip = length(table, "grip", out.grip, Range::positive());
  out.velocity = table.number("velocity", quantity::velocity, Range::positive()) * kPicosecond / kAngstrom;
  out.push = force(table, "push", out.push);
  out.duration = time(table, "duration", out.duration);
  out.frames = static_cast<int>(table.integer_or("frames", 4, kMostFrames, out.frames));
  out.interval = time(table, "interval", out.interval);
  out.dt = time(table, "dt", out.dt);
  if (out.dt > out.interval) table.at("dt").fail("dt is longer than 'interval'");
  table.done();
  return out;
}

KernelInput read_kernel(const ConfigTable& table) {
  KernelInput out;
  if (const auto horizons = table.find("horizons"))
    out.horizons = horizons->numbers(quantity::number, Range::between(2, 10));
  if (const auto degrees = table.find("degrees")) {
    out.degrees.clear();
    for (const ConfigValue& one : degrees->items())
      out.degrees.push_back(static_cast<int>(one.integer(0, kMostDegree)));
  }
  for (const char* key : {"horizons", "degrees"})
    if (table.has(key) && table.at(key).items().empty())
      table.at(key).fail(fmt::format("'{}' is empty", key));
  out.smoothing = table.number_or("smoothing", quantity::number, out.smoothing, Range::not_negative());
  out.isotropy = table.number_or("isotropy", quantity::number, out.isotropy, Range::not_negative());
  out.zeta = table.number_or("zeta", quantity::number, out.zeta, Range::positive());
  out.seeds = static_cast<int>(table.integer_or("seeds", 1, kMostSeeds, out.seeds));
  out.evaluations = static_cast<int>(table.integer_or("evaluations", 1, 1'000'000, out.evaluations));
  out.seed = static_cast<uint64_t>(table.integer_or("seed", 1, std::numeric_limits<int64_t>::max(), 1));
  table.done();
  return out;
}

StretchInput read_stretch(const ConfigTable& table, const FractureInput& fracture) {
  StretchInput out;
  out.positive = table.boolean_or("positive", out.positive);
  out.horizon = table.number_or("horizon", quantity::number, out.horizon, Range::between(2, 10));
  out.degree = static_cast<int>(table.integer_or("degree", 0, kMostDegree, out.degree));
  out.width = table.number_or("width", quantity::number, out.width, Range::positive());
  out.low = table.number_or("low", quantity::number, out.low, Range::positive());
  out.high = table.number_or("high", quantity::number, out.high, Range::positive());
  if (out.low >= out.high) table.at("high").fail("'high' must be above 'low'");
  if (const auto frames = table.find("frames")) {
    const std::vector<ConfigValue> items = frames->items();
    if (items.size() != 2) frames->fail("'frames' takes the first and the last frame");
    for (size_t k = 0; k < 2; ++k) out.frames[k] = static_cast<int>(items[k].integer(1, fracture.frames - 1));
    if (out.frames[0] > out.frames[1]) frames->fail("'frames' takes the first and the last frame");
  }
  table.done();
  return out;
}

PredictionInput read_prediction(const ConfigTable& table) {
  PredictionInput out;
  out.collar = table.number_or("collar", quantity::number, out.collar, {.low = 0, .high = 100});
  out.dt = table.number_or("dt", quantity::number, out.dt, {.low = 0.01, .high = 0.95});
  out.watts = table.number_or("watts", quantity::number, out.watts, Range::positive());
  table.done();
  return out;
}

class Hashed {
 public:
  Hashed& operator<<(double value) { return hash_.add(std::bit_cast<int64_t>(value)), *this; }
  Hashed& operator<<(const std::string& text) {
    for (const char c : text) hash_.add(c);
    return *this;
  }
  uint64_t value() const { return hash_.value(); }

 private:
  Hash hash_;
};

void hash_data(LearnStudy& s) {
  Hashed all;
  all << s.sheet.potential << s.sheet.bond << s.sheet.mass << s.sheet.thickness << s.sheet.cells[0]
      << s.sheet.cells[1] << s.grid.points << s.grid.radius;
  Hashed still = all, fracture = all;
  still << s.still.strain << s.still.waves << s.still.force;
  for (const DiscInput& disc : s.still.discs) still << disc.force << disc.centres << disc.radius;
  const FractureInput& f = s.fracture;
  fracture << s.grid.fine_points << s.grid.coarse_points << s.grid.noise << s.grid.tube << f.slit << f.grip
           << f.velocity << f.push << f.duration << f.frames << f.interval << f.dt << s.still.force;
  s.static_hash = still.value(), s.fracture_hash = fracture.value();
}

// The slit lies between two columns of points.
void check_columns(const ConfigTable& grid, const GridInput& input) {
  const std::pair<const char*, int> counts[] = {
      {"points", input.points}, {"fine_points", input.fine_points}, {"coarse_points", input.coarse_points}};
  for (const auto& [key, points] : counts)
    if (points % 2 != 0)
      grid.at(key).fail("an odd number of points has a column on the slit", "an even number");
}

}  // namespace

namespace {

// A bond reaches from a point to another one, and not around the grid to itself.
void check_horizons(const ConfigTable& root, const LearnStudy& study) {
  const double widest = *std::ranges::max_element(study.kernel.horizons);
  if (2 * widest < study.grid.points) return;
  const auto kernel = root.table_at("kernel");
  const ConfigValue at =
      kernel && kernel->has("horizons") ? kernel->at("horizons") : root.at("grid").table().at("points");
  at.fail(fmt::format("a horizon of {:g} spacings meets itself around {} points", widest, study.grid.points),
          "more points, or a smaller horizon");
}

LearnStudy learn_study_of(const ConfigTable& root, const std::string& path) {
  LearnStudy out;
  out.path = path;
  out.title = root.string_or("title", "");
  const auto table = [&](const char* key) { return root.at(key).table(); };
  out.sheet = read_sheet(table("sheet"));
  out.grid = read_grid(table("grid"));
  out.still = read_static(table("static"), out.sheet);
  if (const auto kernel = root.table_at("kernel")) out.kernel = read_kernel(*kernel);
  check_horizons(root, out);
  const auto fracture = root.table_at("fracture"), stretch = root.table_at("stretch"),
             prediction = root.table_at("prediction");
  if (fracture) {
    out.cracks = true;
    out.fracture = read_fracture(*fracture);
    check_columns(table("grid"), out.grid);
    if (stretch) out.stretch = read_stretch(*stretch, out.fracture);
    if (prediction) out.prediction = read_prediction(*prediction);
  }
  root.done();
  hash_data(out);
  return out;
}

}  // namespace

LearnStudy read_learn_study(const std::string& path) {
  return read_kind(FileKind::learn_study, path,
                   [&](const ConfigTable& root) { return learn_study_of(root, path); });
}

}  // namespace cuboct::learn
