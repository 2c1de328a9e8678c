// SPDX-License-Identifier: MIT
// What is told of a comparison of real numbers with their bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cli/answer.h"
#include "model/base/vec.h"

namespace cuboct {

inline double largest(const std::vector<Vec3>& of) {
  double most = 0;
  for (const Vec3& value : of) most = std::max(most, value.norm());
  return most;
}

// What is told of a comparison: lines for people, and the same for scripts.
struct Told {
  const Answer& answer;
  std::vector<Items> errors{};
};

// The particle whose error is the largest share of its bound. Whether all are within.
template <class Bound>
bool tell(Told& told, const std::string& what, const std::vector<Vec3>& got, const std::vector<Vec3>& exact,
          Bound bound, const char* unit, const std::string& more) {
  double worst = -1, most = 0;
  size_t at = 0, unbounded = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    const double error = (got[i] - exact[i]).norm(), limit = bound(i);
    unbounded += !std::isfinite(limit);
    const double share = error > 0 || std::isnan(error) ? error / limit : 0;
    most = std::max(most, error);
    if (share > worst || std::isnan(share)) worst = share, at = i;
    if (std::isnan(share)) break;
  }
  Items& items = told.errors.emplace_back();
  items.add("of", what);
  items.add("largest_error", most);
  items.add("unit", unit);
  items.add("particle", uint64_t{at});
  items.add("error", (got[at] - exact[at]).norm());
  items.add("bound", double{bound(at)});
  told.answer.say("{}: largest error {:.3g} {}{}; nearest to its bound: particle {}, {:.3g} of {:.3g} {}\n",
                  what, most, unit, more, at, (got[at] - exact[at]).norm(), bound(at), unit);
  if (unbounded > 0) {
    items.add("without_bound", uint64_t{unbounded});
    told.answer.say("{}: {} of {} particles have no bound\n", what, unbounded, got.size());
    if (unbounded == got.size()) return false;
  }
  if (worst <= 1) return true;
  told.answer.say(
      "beyond its bound: particle {} has ({:.9g}, {:.9g}, {:.9g}) {}, the reference ({:.9g}, {:.9g}, "
      "{:.9g})\n",
      at, got[at][0], got[at][1], got[at][2], unit, exact[at][0], exact[at][1], exact[at][2]);
  return false;
}

}  // namespace cuboct
