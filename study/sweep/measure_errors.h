// SPDX-License-Identifier: MIT
// One point of a study against the truth.
#pragma once

#include <functional>

#include "study/sweep/measure_run.h"
#include "study/sweep/outcome.h"
#include "study/sweep/study.h"
#include "study/sweep/truth.h"

namespace cuboct::study {

// Everything of an outcome but its speed. `own`: the truth of the settings' own physical scene (physics_key),
// with which forces and trajectory are compared; figures are compared with `study_truth`. Settings that make
// no scene, arch or plan, and runs that stop, are answers (Status), no exceptions; Interrupted is thrown.
// `gpu`: where runs of the gpu engine go on beside others.
Outcome measure_errors(const Study& study, const Truth& study_truth, const Truth& own,
                       const Settings& settings, GpuRuns* gpu = nullptr);

// The study's figures out of a run's curves, and their errors; one that is not there is nan, with the reason.
void compare_figures(const Study& study, const Truth& truth, const Run& run, Outcome& outcome);
// What `measure` fills in. Settings that it finds to make nothing, and a state that cannot be held, are
// answers; figures that it did not reach are nan.
Outcome answered(const Study& study, const Settings& settings, const std::function<void(Outcome&)>& measure);

}  // namespace cuboct::study
