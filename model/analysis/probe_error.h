// SPDX-License-Identifier: MIT
// What a run in integers leaves between a probe's curve and that of doubles: an estimate before it runs.
// docs/reference/numeric.md, "What a probe is off by", derives it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/scene/scene.h"

namespace cuboct {

// The unit of an error that is a plain number, and no share of its curve.
inline constexpr const char* kPlainNumber = "number";

// Of a curve: the root mean square of its difference from that of doubles, over that of the latter.
struct CurveError {
  std::string quantity;  // "stress"
  double error = 0;      // of `unit`; without one a share of the curve
  std::string unit{};
  bool of_means = false;  // single readings part: what their mean over the run is off by
};

struct ProbeError {
  std::string probe;
  std::vector<CurveError> curves;  // none: not estimated
  std::string why;                 // the part that is largest, or why there is no estimate
  // A run may break bonds: trajectories part behind the first one.
  bool until_breaks = false;
};

// Of one scene, which must outlive it, in several formats: what formats do not change is computed once.
class ProbeErrors {
 public:
  explicit ProbeErrors(const Scene& scene);
  ~ProbeErrors();
  ProbeErrors(const ProbeErrors&) = delete;
  ProbeErrors& operator=(const ProbeErrors&) = delete;

  // One for each probe of the scene, in their order. Of a rule of pairs, in the formats of `rule`.
  std::vector<ProbeError> of(const FixedRule& rule) const;

 private:
  struct Facts;
  class Estimate;
  const Scene& scene_;
  std::unique_ptr<const Facts> facts_;
};

// Of one rule alone.
std::vector<ProbeError> probe_errors(const Scene& scene, const FixedRule& rule);

}  // namespace cuboct
