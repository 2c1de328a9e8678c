// SPDX-License-Identifier: MIT
// The report of a study: one page that works offline, and its charts as pictures.
#pragma once

#include <string>
#include <vector>

#include "study/report/chart.h"
#include "study/search/front.h"
#include "study/sweep/store.h"

namespace cuboct::study {

// Whether this build has the page: it needs the charting library, which npm fetches.
bool has_page();

// One HTML file that asks for nothing else: charts (zoom, hover with each point's settings), tables, the
// machine. Charts and tables are drawn in the reader's browser by study/report/web/*.js from the numbers that
// stand in the page. The same results give the same bytes.
std::string page_of(const Results& results);
void write_page(const Results& results, const std::string& path);

// The same charts as PNG and SVG, made by gnuplot, in a directory that is made where needed: charts_of
// study/report/chart.h. The names of the files, without directory. Throws InputError where gnuplot is
// missing.
std::vector<std::string> write_charts(const Results& results, const std::string& directory);
std::vector<std::string> write_charts(const std::vector<Chart>& charts, const std::string& directory);

}  // namespace cuboct::study
