// SPDX-License-Identifier: MIT
#include "study/potential_fit/kept_starts.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "model/base/json.h"

namespace cuboct::bond_fit {
namespace {

std::string text_of(const Endurance& endurance) {
  std::vector<std::string> runs;
  for (const Endured& run : endurance.runs)
    runs.push_back(json_object(
        {{"fault", json(run.fault)}, {"temperature", json(run.temperature)}, {"drift", json(run.drift)}}));
  return json_array(runs);
}

Endurance endurance_of(const nlohmann::json& runs) {
  Endurance out;
  for (size_t b = 0; b < kBoundaries; ++b)
    out.runs[b] = {runs.at(b).at("fault"), runs.at(b).at("temperature"), runs.at(b).at("drift")};
  return out;
}

}  // namespace

KeptStarts::KeptStarts(const std::string& directory, const BondStudy& study)
    : kept_(directory + "/starts.jsonl", study.hash, "the fit of another target, search or trial",
            [this](const nlohmann::json& line) {
              if (line.contains("start"))
                starts_[line.at("start")] = {line.at("point"), line.at("loss"), line.at("evaluations")};
              else
                trials_[line.at("trial")] = {0, line.at("fault"), line.at("edge"),
                                             endurance_of(line.at("runs"))};
            }) {}

const Found* KeptStarts::start(int number) const {
  const auto at = starts_.find(number);
  return at == starts_.end() ? nullptr : &at->second;
}

const Tried* KeptStarts::trial(int number) const {
  const auto at = trials_.find(number);
  return at == trials_.end() ? nullptr : &at->second;
}

void KeptStarts::add(int number, Found found) {
  kept_.add(json_object({{"start", std::to_string(number)},
                         {"point", json(found.point)},
                         {"loss", json(found.loss)},
                         {"evaluations", std::to_string(found.evaluations)}}));
  starts_[number] = std::move(found);
}

void KeptStarts::add(int number, Tried tried) {
  kept_.add(json_object({{"trial", std::to_string(number)},
                         {"fault", json(tried.fault)},
                         {"edge", json(tried.edge)},
                         {"runs", text_of(tried.endurance)}}));
  trials_[number] = std::move(tried);
}

}  // namespace cuboct::bond_fit
