// SPDX-License-Identifier: MIT
// make_page DIRECTORY: writes made-up results as DIRECTORY/page.html, and their charts into DIRECTORY/charts;
// and hostile ones as DIRECTORY/hostile.html.
#include <fmt/format.h>

#include <exception>

#include "model/base/output.h"
#include "study/report/page.h"
#include "tests/web/made_up_results.h"

int main(int count, char** arguments) try {
  if (count != 2) return 2;
  const std::string directory = arguments[1];
  cuboct::make_directory(directory);
  const auto results = cuboct::test::made_up_results();
  cuboct::study::write_page(results, directory + "/page.html");
  cuboct::study::write_page(cuboct::test::hostile_results(), directory + "/hostile.html");
  const size_t charts = cuboct::study::write_charts(results, directory + "/charts").size();
  fmt::print("{} points, {} files of charts\n", results.outcomes.size(), charts);
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
