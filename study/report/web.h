// SPDX-License-Identifier: MIT
// What the page of a study is made of, embedded by study/embed.cmake: the charting library, our own files of
// study/report/web/, and the licences of what is not ours.
#pragma once

#include <string_view>

namespace cuboct::study {

std::string_view web_library();         // Apache ECharts, minified, with its notice
std::string_view web_frame();           // HTML, with places for the rest
std::string_view web_style();           // CSS
std::string_view web_script();          // JavaScript
std::string_view web_machines_frame();  // the same of a study of machines
std::string_view web_machines_script();
std::string_view web_licences();  // plain text

}  // namespace cuboct::study
