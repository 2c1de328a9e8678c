# cmake -D OUT=file.cpp -D DIR=sources -P commit.cmake: what cli/commit.h declares. The file is left alone where it would
# hold the same.
set(commit unknown)
find_program(git git)
if(git)
  # Sources inside a repository of something else are none of its own.
  execute_process(COMMAND ${git} rev-parse --show-cdup WORKING_DIRECTORY ${DIR}
    OUTPUT_VARIABLE up RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND up STREQUAL "")
    execute_process(COMMAND ${git} describe --always --tags --dirty WORKING_DIRECTORY ${DIR}
      OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT failed)
      set(commit ${described})
    endif()
  endif()
endif()
set(text "// SPDX-License-Identifier: MIT\n#include \"cli/commit.h\"\n\nnamespace cuboct {\n\nconst char* commit() { return \"${commit}\"; }\n\n}  // namespace cuboct\n")
set(before "")
if(EXISTS ${OUT})
  file(READ ${OUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUT} "${text}")
endif()
