# clang++ compiles the tree in some three quarters of the time that g++ takes, and what it builds has the same bits
# (tests/build/least.sh) and runs as fast (docs/developer.md). Whoever names a compiler, by CXX or CMAKE_CXX_COMPILER, has that one.
option(CUBOCT_CLANG "Compile with clang++, where it is found and no compiler is named" ON)
if(CUBOCT_CLANG AND NOT CMAKE_CXX_COMPILER AND NOT DEFINED ENV{CXX})
  find_program(CUBOCT_CLANG_PROGRAM clang++)
  mark_as_advanced(CUBOCT_CLANG_PROGRAM)
  if(CUBOCT_CLANG_PROGRAM)
    execute_process(COMMAND ${CUBOCT_CLANG_PROGRAM} -dumpversion OUTPUT_VARIABLE version ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(version VERSION_GREATER_EQUAL 14)
      set(CMAKE_CXX_COMPILER ${CUBOCT_CLANG_PROGRAM} CACHE FILEPATH "The compiler of C++")
    endif()
  endif()
endif()
