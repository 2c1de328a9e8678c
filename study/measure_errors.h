// SPDX-License-Identifier: MIT
// One point of a study against the truth.
#pragma once

#include "study/outcome.h"
#include "study/study.h"
#include "study/truth.h"

namespace cuboct::study {

// Everything of an outcome but its speed. `own`: the truth of the settings' own physical scene (physics_key), with
// which forces and trajectory are compared; figures are compared with `study_truth`. Settings that make no scene,
// arch or plan, and runs that stop, are answers (Status), no exceptions; Interrupted is thrown.
Outcome measure_errors(const Study& study, const Truth& study_truth, const Truth& own, const Settings& settings);

}  // namespace cuboct::study
