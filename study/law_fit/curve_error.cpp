// SPDX-License-Identifier: MIT
#include "study/law_fit/curve_error.h"

#include <algorithm>
#include <cmath>

namespace cuboct::fit {

std::vector<double> even_strains(double last, size_t count) {
  std::vector<double> strains(count);
  for (size_t k = 0; k < count; ++k)
    strains[k] = last * static_cast<double>(k) / static_cast<double>(count - 1);
  return strains;
}

std::vector<double> first_passage(const std::vector<double>& strain, const std::vector<double>& stress,
                                  const std::vector<double>& at) {
  std::vector<double> out(at.size(), 0.0);
  size_t next = 0;
  for (size_t k = 0; k < strain.size(); ++k)
    for (; next < at.size() && at[next] <= strain[k]; ++next) {
      // strain[k - 1] < at[next]: it would have been passed there.
      out[next] = k == 0 ? stress[0]
                         : std::lerp(stress[k - 1], stress[k],
                                     (at[next] - strain[k - 1]) / (strain[k] - strain[k - 1]));
    }
  // Load steps are those of the law's own time step: the last reading may lie a little before the end.
  if (next > 0 && next + 1 == at.size()) {
    const auto largest = std::ranges::max_element(strain);
    if (at[next] - *largest < (at[1] - at[0]) / 2)
      out[next] = stress[static_cast<size_t>(largest - strain.begin())];
  }
  return out;
}

double curve_error(const std::vector<double>& stress, const std::vector<double>& target) {
  double distance = 0, norm = 0;
  for (size_t k = 0; k < target.size(); ++k) {
    const double weight = k == 0 || k + 1 == target.size() ? 0.5 : 1;
    distance += weight * (stress[k] - target[k]) * (stress[k] - target[k]);
    norm += weight * target[k] * target[k];
  }
  return std::sqrt(distance / norm);
}

}  // namespace cuboct::fit
