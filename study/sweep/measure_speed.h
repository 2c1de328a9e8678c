// SPDX-License-Identifier: MIT
// How fast one point of a study computes.
#pragma once

#include "study/sweep/outcome.h"
#include "study/sweep/study.h"

namespace cuboct::study {

// On the study's scene from its start, with the settings' threads; whoever calls sees to it that nothing else
// runs. Each repeat takes `study.seconds` or more; a run that reaches its end within a repeat begins again,
// untimed. Not measured (nan) where the settings make no plan, or the run stops within its first repeat.
Speed measure_speed(const Study& study, const Settings& settings);

}  // namespace cuboct::study
