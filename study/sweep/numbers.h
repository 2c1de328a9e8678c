// SPDX-License-Identifier: MIT
// Numbers as people read them, as study/report/web/format.js writes them too.
#pragma once

#include <string>

namespace cuboct::study {

std::string superscript(int n);   // "⁻²"
std::string power_of_ten(int n);  // "1", "10", "10⁻²"
// Four significant digits: "0.01234", "1.234·10⁻⁷".
std::string number_text(double x);

}  // namespace cuboct::study
