# Files as a C++ table of names and texts.

# Makes OUT in the build's folder: FUNCTION, which HEADER declares in the namespace SPACE, returns the files' names below ROOT and texts.
function(cuboct_embed_texts out header space function root)
  list(TRANSFORM ARGN PREPEND ${root}/ OUTPUT_VARIABLE files)
  string(REPLACE ";" "," names "${ARGN}")
  set(script ${PROJECT_SOURCE_DIR}/tools/embed_texts.cmake)
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -D OUT=${CMAKE_CURRENT_BINARY_DIR}/${out} -D HEADER=${header} -D SPACE=${space} -D FUNCTION=${function}
            -D ROOT=${root} -D FILES=${names} -P ${script}
    DEPENDS ${files} ${script})
endfunction()

if(NOT CMAKE_SCRIPT_MODE_FILE)
  return()
endif()
set(text "// SPDX-License-Identifier: MIT\n#include \"${HEADER}\"\n\nnamespace ${SPACE} {\n\n")
string(APPEND text "const std::vector<std::pair<std::string, std::string>>& ${FUNCTION}() {\n")
string(APPEND text "  static const std::vector<std::pair<std::string, std::string>> texts{\n")
string(REPLACE "," ";" FILES "${FILES}")
foreach(file ${FILES})
  file(READ ${ROOT}/${file} body)
  string(APPEND text "{\"${file}\", R\"text~(${body})text~\"},\n")
endforeach()
string(APPEND text "};\n  return texts;\n}\n\n}  // namespace ${SPACE}\n")
file(WRITE ${OUT} "${text}")
