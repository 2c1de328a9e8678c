// SPDX-License-Identifier: MIT
// What the page of a run is made of, embedded by cli/view/embed.cmake: our own files of cli/view/web, bundled
// with three.js, and the licence of what is not ours.
#pragma once

#include <string_view>

namespace cuboct {

std::string_view web_page();      // HTML, with places for the rest
std::string_view web_style();     // CSS
std::string_view web_script();    // JavaScript
std::string_view web_licences();  // plain text

}  // namespace cuboct
