// SPDX-License-Identifier: MIT
// What `cuboct learn` says and draws of sheets that crack.
#pragma once

#include <string>

#include "cli/items.h"
#include "study/learn/cracks.h"

namespace cuboct {

void add_cracks(Items& items, const learn::LearnStudy& study, const learn::Cracks& cracks);
// stretch.tsv, predictions.tsv, cost.tsv.
void write_crack_tables(const learn::LearnStudy& study, const learn::Cracks& cracks,
                        const std::string& directory);
// stretch.svg, cost.svg, a PNG of each test. InputError without gnuplot.
void draw_cracks(const learn::LearnStudy& study, const learn::Cracks& cracks, const std::string& directory);

}  // namespace cuboct
