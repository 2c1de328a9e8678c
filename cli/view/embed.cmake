# cmake -D OUT=file.cpp -D DIR=cli/view/web -D ESBUILD=program -P embed.cmake: the parts of a run's page as C++ strings. The bundler, a
# program that needs neither node nor a network, makes one script of our modules and of what they use of three.js.
include(${CMAKE_CURRENT_LIST_DIR}/../../tools/embed_bytes.cmake)

execute_process(
  COMMAND ${ESBUILD} ${DIR}/main.js --bundle --minify --format=iife --legal-comments=none --target=es2022 --charset=ascii
          --log-level=warning --outfile=${OUT}.js
  COMMAND_ERROR_IS_FATAL ANY)
file(READ ${OUT}.js script)
if(script MATCHES "</script|<!--")
  message(FATAL_ERROR "the script of a run's page would end its element")
endif()
set(text "// SPDX-License-Identifier: MIT\n#include \"cli/view/web.h\"\n\nnamespace cuboct {\n\n")
add_part(web_page ${DIR}/page.html)
add_part(web_style ${DIR}/page.css)
add_part(web_script ${OUT}.js)
add_part(web_licences ${DIR}/node_modules/three/LICENSE)
file(WRITE ${OUT} "${text}\n}  // namespace cuboct\n")
