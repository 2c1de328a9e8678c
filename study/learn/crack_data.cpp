// SPDX-License-Identifier: MIT
#include "study/learn/crack_data.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "model/base/interrupt.h"
#include "study/learn/field_text.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/kept_lines.h"
#include "study/sweep/work.h"

namespace cuboct::learn {
namespace {

constexpr std::array<const char*, 2> kNames{"pulled", "pushed"};

std::string text_of(const Frame& frame) {
  return json_object({{"u", text_of_field(frame.u)},
                      {"acceleration", text_of_field(frame.acceleration)},
                      {"b", text_of_field(frame.b)}});
}
std::string text_of(const AtomFrame& frame) {
  return json_object({{"frame", json(static_cast<double>(frame.frame))},
                      {"x", text_of_field(frame.x)},
                      {"u", text_of_field(frame.u)}});
}
std::string text_of(const FractureSample& sample, size_t load) {
  const auto grids = [](const auto& items, const auto& text) { return json_array(items, text); };
  return json_object(
      {{"name", json(std::string(kNames[load]))},
       {"seconds", json(sample.seconds)},
       {"density", grids(sample.density, [](const std::vector<double>& one) { return json(one); })},
       {"velocity", grids(sample.velocity, text_of_field)},
       {"frames", grids(sample.frames,
                        [](const std::vector<Frame>& frames) {
                          return json_array(frames, [](const Frame& frame) { return text_of(frame); });
                        })},
       {"atoms", json_array(sample.atoms, [](const AtomFrame& frame) { return text_of(frame); })}});
}

// Whether it has all that a sample of the study has.
bool fits(const FractureSample& sample, const LearnStudy& study, const std::vector<Grid>& grids) {
  const size_t frames = static_cast<size_t>(study.fracture.frames) + 1;
  bool whole = sample.density.size() == grids.size() && sample.velocity.size() == grids.size() &&
               sample.frames.size() == grids.size();
  for (size_t g = 0; whole && g < grids.size(); ++g) {
    const size_t points = grids[g].size();
    whole =
        sample.density[g].size() == points && sample.velocity[g].size() == points &&
        sample.frames[g].size() == frames && std::ranges::all_of(sample.frames[g], [&](const Frame& frame) {
          return frame.u.size() == points && frame.acceleration.size() == points && frame.b.size() == points;
        });
  }
  return whole && std::ranges::all_of(sample.atoms, [&](const AtomFrame& atoms) {
           return atoms.frame >= 0 && static_cast<size_t>(atoms.frame) < frames &&
                  atoms.x.size() == atoms.u.size();
         });
}

FractureSample sample_of(const nlohmann::json& line) {
  FractureSample out;
  out.seconds = line.at("seconds").get<double>();
  for (const nlohmann::json& grid : line.at("density"))
    out.density.push_back(grid.get<std::vector<double>>());
  for (const nlohmann::json& grid : line.at("velocity")) out.velocity.push_back(field_of(grid));
  for (const nlohmann::json& grid : line.at("frames")) {
    out.frames.emplace_back();
    for (const nlohmann::json& frame : grid)
      out.frames.back().push_back(
          {field_of(frame.at("u")), field_of(frame.at("acceleration")), field_of(frame.at("b"))});
  }
  for (const nlohmann::json& frame : line.at("atoms"))
    out.atoms.push_back({frame.at("frame").get<int>(), field_of(frame.at("x")), field_of(frame.at("u"))});
  return out;
}

}  // namespace

std::array<FractureSample, 2> cracked_sheets(const LearnStudy& study, const std::string& directory,
                                             int jobs) {
  std::array<std::optional<FractureSample>, 2> known;
  const AtomCell sheet = resting_sheet(study.sheet);
  const std::vector<Grid> grids = fracture_grids(study, sheet);
  study::KeptLines kept(directory + "/cracks.jsonl", study.fracture_hash,
                        "the cracks of another sheet or load", [&](const nlohmann::json& line) {
                          FractureSample sample = sample_of(line);
                          if (!fits(sample, study, grids)) throw study::UnfitLine();
                          known[line.at("name") == kNames[0] ? 0 : 1] = std::move(sample);
                        });
  std::mutex guard;
  std::vector<study::Piece> pieces;
  for (const size_t load : {0, 1}) {
    if (known[load]) continue;
    pieces.push_back({1, [&, load] {
                        FractureSample sample =
                            fracture(study, sheet, FractureLoad{static_cast<uint8_t>(load)}, [](int) {
                              if (interrupted()) throw study::Interrupted();
                            });
                        const std::lock_guard lock(guard);
                        kept.add(text_of(sample, load));
                        known[load] = std::move(sample);
                      }});
  }
  try {
    study::work_off(std::move(pieces), jobs, "cracks", true);
  } catch (...) {
    kept.save();
    throw;
  }
  kept.save();
  return {std::move(*known[0]), std::move(*known[1])};
}

}  // namespace cuboct::learn
