// SPDX-License-Identifier: MIT
// The line of an input file that an error means, for a terminal:
//   12 | fram_every = 10
//      | ^
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cuboct {

// Line `number` of a text, counted from 1, without its end; empty where there is none.
std::string_view line_of(std::string_view text, int number);
std::vector<std::string_view> lines_of(std::string_view text);  // all of them

// UTF-8 code points.
int characters(std::string_view text);

// Both lines, without the last one's end; empty where the line is blank. `column` counts characters
// from 1, and may be one beyond the line. What is not to be seen is shown as line_text does, but
// a tab as one blank. Of a line longer than 80 characters the part around the column.
std::string excerpt(std::string_view line, int number, int column);

}  // namespace cuboct
