// SPDX-License-Identifier: MIT
#include "study/law_fit/evaluations.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "model/base/json.h"

namespace cuboct::fit {
namespace {

std::string line_of(const Evaluation& e) {
  return json_object({{"sample", json(e.sample)},
                      {"error", json(e.error)},
                      {"largest_strain", json(e.largest_strain)},
                      {"particle_steps", std::to_string(e.particle_steps)},
                      {"seconds", json(e.seconds)},
                      {"stop", json(e.stop)},
                      {"stress", json(e.stress)}});
}

Evaluation evaluation_of(const nlohmann::json& line) {
  return {line.at("sample"),         line.at("error"),   line.at("stress"), line.at("largest_strain"),
          line.at("particle_steps"), line.at("seconds"), line.at("stop")};
}

}  // namespace

Evaluations::Evaluations(const std::string& directory, const FitStudy& study)
    : kept_(directory + "/evaluations.jsonl", study.hash, "the fit of another scene, target or search",
            [this, &study](const nlohmann::json& line) {
              Evaluation evaluation = evaluation_of(line);
              if (evaluation.stress.size() != study.target.even_strain.size()) throw study::UnfitLine();
              std::vector<double> sample = evaluation.sample;
              known_.emplace(std::move(sample), std::move(evaluation));
            }) {}

const Evaluation* Evaluations::find(const std::vector<double>& sample) const {
  const auto at = known_.find(sample);
  return at == known_.end() ? nullptr : &at->second;
}

const Evaluation& Evaluations::add(Evaluation evaluation) {
  kept_.add(line_of(evaluation));
  std::vector<double> sample = evaluation.sample;
  return known_.emplace(std::move(sample), std::move(evaluation)).first->second;
}

}  // namespace cuboct::fit
