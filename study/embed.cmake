# cmake -D OUT=file.cpp -D DIR=study/web -P embed.cmake: the parts of a study's page as C++ strings, byte by byte (as
# hexadecimal escapes, so that no text can end its literal).
function(add_part function)
  set(hex "")
  foreach(file ${ARGN})
    file(READ ${DIR}/${file} one HEX)
    string(APPEND hex "${one}")
  endforeach()
  string(LENGTH "${hex}" length)
  math(EXPR size "${length} / 2")
  string(REGEX REPLACE "(..)" "\\\\x\\1" escaped "${hex}")
  set(text "${text}std::string_view ${function}() { return {\"${escaped}\", ${size}}; }\n" PARENT_SCOPE)
endfunction()

set(modules node_modules)
set(text "// SPDX-License-Identifier: MIT\n#include \"study/web.h\"\n\nnamespace cuboct::study {\n\n")
add_part(web_library ${modules}/echarts/dist/echarts.common.min.js)
add_part(web_frame page.html)
add_part(web_style page.css)
add_part(web_script format.js charts.js tables.js page.js)
add_part(web_licences ${modules}/echarts/NOTICE ${modules}/echarts/LICENSE ${modules}/echarts/licenses/LICENSE-d3
         ${modules}/zrender/LICENSE ${modules}/tslib/LICENSE.txt)
file(WRITE ${OUT} "${text}\n}  // namespace cuboct::study\n")
