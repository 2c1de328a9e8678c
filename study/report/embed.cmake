# cmake -D OUT=file.cpp -D DIR=study/report/web -P embed.cmake: the parts of a study's page as C++ strings.
include(${CMAKE_CURRENT_LIST_DIR}/../../tools/embed_bytes.cmake)

set(modules ${DIR}/node_modules)
set(text "// SPDX-License-Identifier: MIT\n#include \"study/report/web.h\"\n\nnamespace cuboct::study {\n\n")
add_part(web_library ${modules}/echarts/dist/echarts.common.min.js)
add_part(web_frame ${DIR}/page.html)
add_part(web_style ${DIR}/page.css)
add_part(web_script ${DIR}/format.js ${DIR}/charts.js ${DIR}/tables.js ${DIR}/page.js)
add_part(web_machines_frame ${DIR}/machines.html)
add_part(web_machines_script ${DIR}/format.js ${DIR}/charts.js ${DIR}/tables.js ${DIR}/machines.js)
add_part(web_licences ${modules}/echarts/NOTICE ${modules}/echarts/LICENSE ${modules}/echarts/licenses/LICENSE-d3
         ${modules}/zrender/LICENSE ${modules}/tslib/LICENSE.txt)
file(WRITE ${OUT} "${text}\n}  // namespace cuboct::study\n")
