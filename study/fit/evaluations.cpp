// SPDX-License-Identifier: MIT
#include "study/fit/evaluations.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/json.h"
#include "model/base/output.h"

namespace cuboct::fit {
namespace {

// One line: of the breaks that json_object sets between members none stands within a text.
std::string line_of(const Evaluation& e) {
  std::string line = json_object({{"sample", json(e.sample)},
                                  {"error", json(e.error)},
                                  {"largest_strain", json(e.largest_strain)},
                                  {"particle_steps", std::to_string(e.particle_steps)},
                                  {"seconds", json(e.seconds)},
                                  {"stop", json(e.stop)},
                                  {"stress", json(e.stress)}});
  std::erase(line, '\n');
  return line;
}

Evaluation evaluation_of(const nlohmann::json& line) {
  return {line.at("sample"),         line.at("error"),   line.at("stress"), line.at("largest_strain"),
          line.at("particle_steps"), line.at("seconds"), line.at("stop")};
}

}  // namespace

Evaluations::Evaluations(const std::string& directory, const FitStudy& study)
    : path_(directory + "/evaluations.jsonl"),
      head_(fmt::format("{{\"format\":1,\"study\":\"{:016x}\"}}", study.hash)) {
  if (!std::filesystem::exists(path_)) return;
  const std::string text = read_text(path_);
  const auto lines = lines_of(text);
  if (lines.front() != head_)
    throw InputError(fmt::format("{} holds the fit of another scene, target or search", path_),
                     "take another --out DIR, or remove this one");
  try {
    for (size_t k = 1; k + 1 < lines.size(); ++k) {
      Evaluation evaluation = evaluation_of(nlohmann::json::parse(lines[k]));
      lines_.emplace_back(lines[k]);
      std::vector<double> sample = evaluation.sample;
      known_.emplace(std::move(sample), std::move(evaluation));
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: line {} is no evaluation", path_, lines_.size() + 2), error.what());
  }
}

const Evaluation* Evaluations::find(const std::vector<double>& sample) const {
  const auto at = known_.find(sample);
  return at == known_.end() ? nullptr : &at->second;
}

const Evaluation& Evaluations::add(Evaluation evaluation) {
  lines_.push_back(line_of(evaluation));
  saved_ = false;
  std::vector<double> sample = evaluation.sample;
  return known_.emplace(std::move(sample), std::move(evaluation)).first->second;
}

void Evaluations::save() {
  if (std::exchange(saved_, true)) return;
  write_text(path_, [&](TextFile& file) {
    file.write(head_ + "\n");
    for (const std::string& line : lines_) file.write(line + "\n");
  });
}

}  // namespace cuboct::fit
