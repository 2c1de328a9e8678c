// SPDX-License-Identifier: MIT
#include "study/learn/learn.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/json.h"
#include "study/learn/field_text.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/kept_lines.h"
#include "study/sweep/work.h"

namespace cuboct::learn {
namespace {

constexpr double kHeld = -1e-4;  // a constraint that is less below 0 holds

// The sample in a kept line, of a grid of so many points. A field of another length, or one of zeros, is
// none.
StaticSample sample_of(const nlohmann::json& line, size_t points) {
  const StaticSample sample{field_of(line.at("u")), field_of(line.at("b")), line.at("strain")};
  const auto fits = [&](const std::vector<Vec3>& field) {
    const auto zero = [](const Vec3& at) { return at.isZero(0); };
    return field.size() == points && !std::ranges::all_of(field, zero);
  };
  if (!fits(sample.u) || !fits(sample.b)) throw study::UnfitLine();
  return sample;
}

std::vector<StaticSample> samples_of(const LearnStudy& study, const AtomCell& sheet,
                                     const std::vector<StaticLoad>& loads, const std::string& directory,
                                     int jobs) {
  std::map<std::string, StaticSample> known;
  const size_t points = grid_of(study, sheet, study.grid.points).size();
  study::KeptLines kept(
      directory + "/samples.jsonl", study.static_hash, "the samples of another sheet or load",
      [&](const nlohmann::json& line) { known[line.at("name")] = sample_of(line, points); });
  std::mutex guard;
  std::vector<study::Piece> pieces;
  for (const StaticLoad& load : loads) {
    if (known.contains(load.name)) continue;
    pieces.push_back({1, [&] {
                        if (interrupted()) throw study::Interrupted();
                        StaticSample sample = rest_under(study, sheet, load);
                        const std::lock_guard lock(guard);
                        kept.add(json_object({{"name", json(load.name)},
                                              {"strain", json(sample.strain)},
                                              {"u", text_of_field(sample.u)},
                                              {"b", text_of_field(sample.b)}}));
                        known[load.name] = std::move(sample);
                      }});
  }
  try {
    study::work_off(std::move(pieces), jobs, "samples", true);
  } catch (const InputError&) {
    throw;  // of a study that is refused nothing is written
  } catch (...) {
    kept.save();
    throw;
  }
  kept.save();
  std::vector<StaticSample> out;
  for (const StaticLoad& load : loads) out.push_back(known.at(load.name));
  return out;
}

size_t best_of(const std::vector<Tried>& tried) {
  const auto rank = [&](size_t k) {
    return std::pair(tried[k].fit.constraint < kHeld, tried[k].fit.validation);
  };
  size_t best = 0;
  for (size_t k = 1; k < tried.size(); ++k)
    if (rank(k) < rank(best)) best = k;
  return best;
}

}  // namespace

void check_loads(const LearnStudy& study) {
  const std::vector<StaticLoad> loads = static_loads(study, resting_sheet(study.sheet));
  const StaticLoad& least = *std::ranges::min_element(loads, {}, &StaticLoad::size);
  if (study.still.force < least.size) return;
  throw placed(study, InputError(fmt::format("a sheet whose forces are below {:.3g} eV/angstrom is at rest, "
                                             "and '{}' loads an atom with {:.3g} eV/angstrom at most",
                                             study.still.force, least.name, least.size),
                                 "a smaller 'force'")
                          .about({"static.force"}));
}

Learned learn(const LearnStudy& study, const std::string& directory, int jobs) {
  const AtomCell sheet = resting_sheet(study.sheet);
  Learned out;
  out.grid = grid_of(study, sheet, study.grid.points);
  out.atoms = sheet.x.size();
  for (const double horizon : study.kernel.horizons)
    WaveOperator(out.grid, horizon);  // refuses before the work
  const std::vector<StaticLoad> loads = static_loads(study, sheet);
  const std::vector<StaticSample> samples = samples_of(study, sheet, loads, directory, jobs);
  for (size_t k = 0; k < loads.size(); ++k) {
    (loads[k].training ? out.training : out.validation).push_back(samples[k]);
    out.strain = std::max(out.strain, samples[k].strain);
  }
  std::vector<study::Piece> pieces;
  for (const double horizon : study.kernel.horizons)
    for (const int degree : study.kernel.degrees) out.tried.push_back({horizon, degree, {}});
  const auto fit = [&](const Tried& one, uint64_t draw) {
    if (interrupted()) throw study::Interrupted();
    return fit_kernel(out.grid, out.training, out.validation, study.kernel,
                      {.horizon = one.horizon, .degree = one.degree, .draw = draw});
  };
  for (Tried& one : out.tried) pieces.push_back({1, [&] { one.fit = fit(one, 0); }});
  study::work_off(std::move(pieces), jobs, "kernels", true);
  out.best = best_of(out.tried);
  out.drawn.resize(static_cast<size_t>(study.kernel.seeds));
  pieces.clear();
  for (size_t k = 0; k < out.drawn.size(); ++k)
    pieces.push_back({1, [&, k] { out.drawn[k] = fit(out.tried[out.best], study.kernel.seed + k); }});
  study::work_off(std::move(pieces), jobs, "draws", true);
  return out;
}

}  // namespace cuboct::learn
