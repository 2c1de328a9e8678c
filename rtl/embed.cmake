# SPDX-License-Identifier: MIT
# cmake -D OUT=file.cpp -D DIR=rtl/lib -D FUNCTION=name [-D FILES=a;b] -P embed.cmake: the hand-written modules, and pins of boards, as a
# C++ table, in the order of names.
if(FILES)
  set(sources ${FILES})
else()
  file(GLOB_RECURSE sources RELATIVE ${DIR} ${DIR}/*.sv ${DIR}/*.pcf ${DIR}/*.lpf)
endif()
if(FUNCTION STREQUAL rtl_library)
  list(SORT sources COMPARE FILE_BASENAME)
else()
  list(SORT sources)
endif()
set(text "// SPDX-License-Identifier: MIT\n#include \"hw/rtl/rtl_library.h\"\n\nnamespace cuboct {\n\n")
string(APPEND text "const std::vector<RtlSource>& ${FUNCTION}() {\n  static const std::vector<RtlSource> sources{\n")
foreach(source ${sources})
  file(READ ${DIR}/${source} body)
  if(FUNCTION STREQUAL rtl_library)
    get_filename_component(source ${source} NAME)  # rooms are no part of a name; a board's folder is
  endif()
  string(APPEND text "{\"${source}\", R\"sv~(${body})sv~\"},\n")
endforeach()
string(APPEND text "};\n  return sources;\n}\n\n}  // namespace cuboct\n")
file(WRITE ${OUT} "${text}")
