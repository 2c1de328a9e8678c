// SPDX-License-Identifier: MIT
#include "study/law_fit/packing_fit.h"

#include "model/contract/law.h"
#include "model/solid/dynamical_matrix.h"
#include "study/law_fit/curve_error.h"
#include "study/law_fit/evolution.h"
#include "study/law_fit/packing_pull.h"

namespace cuboct::fit {

namespace {

std::shared_ptr<const PairLaw> law_of(const FitStudy& study, const Parameters& parameters) {
  const LawPoints points = points_of(draw(parameters, study.scale));
  return spline_law(points.r, points.f, Interpolation::monotone_cubic, study.scale.pitch / 2);
}

}  // namespace

std::vector<double> packing_curve(const FitStudy& study, const Parameters& parameters,
                                  const std::vector<double>& strains) {
  return packing_stress(*law_of(study, parameters), study.scale.pitch, study.axes, strains);
}

double packing_pressure(const FitStudy& study, const Parameters& parameters) {
  return fcc_pressure(*law_of(study, parameters), study.scale.pitch);
}

Parameters fit_packing(const FitStudy& study) {
  constexpr int kGenerations = 60;
  constexpr size_t kStrains = 51;
  const std::vector<double> strains = even_strains(study.target.yield_strain, kStrains);
  const std::vector<double> target = first_passage(study.target.strain, study.target.stress, strains);
  const auto error_of = [&](const std::vector<double>& sample) {
    const double error = curve_error(packing_curve(study, parameters_of(study, sample), strains), target);
    return std::isfinite(error) ? error : 1e3;
  };
  const Search& search = study.search;
  std::vector<double> best = sample_of(study, study.start);
  double least = error_of(best);
  Evolution evolution(best, least, search.samples, search.spread, search.seed);
  for (int k = 0; k < kGenerations; ++k) {
    std::vector<double> errors;
    for (const std::vector<double>& sample : evolution.ask()) {
      errors.push_back(error_of(sample));
      if (errors.back() < least) least = errors.back(), best = sample;
    }
    evolution.tell(errors);
  }
  return parameters_of(study, best);
}

}  // namespace cuboct::fit
