# Headers from elsewhere that many files read, compiled once for the libraries and programs and once for the tests.
option(CUBOCT_PRECOMPILE "Precompiled headers" ON)

set(cuboct_common <algorithm> <array> <bit> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional>
  <limits> <map> <memory> <numeric> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <tuple> <utility>
  <vector> <Eigen/Dense> <fmt/format.h> <fmt/ranges.h>)

# With the compile options of the directory that calls it.
function(cuboct_headers name)
  if(NOT CUBOCT_PRECOMPILE)
    return()
  endif()
  set(empty ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(TOUCH ${empty})
  add_library(${name} OBJECT ${empty})
  target_link_libraries(${name} PRIVATE Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json)
  target_precompile_headers(${name} PRIVATE ${cuboct_common} ${ARGN})
  # ccache wants to see what was precompiled.
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess> "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endfunction()

# What waits for people and files, or runs once, compiles a third faster with less of the optimiser. What it computes has the same
# bits. GCC then no longer sees that some variables are set.
function(cuboct_lightly_optimised headers)
  foreach(target ${headers} ${ARGN})
    if(TARGET ${target})
      target_compile_options(${target} PRIVATE "$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:Release>>:-O1>" "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>")
      set_target_properties(${target} PROPERTIES CUBOCT_HEADERS ${headers})
    endif()
  endforeach()
endfunction()

function(cuboct_precompile directory)
  if(NOT CUBOCT_PRECOMPILE)
    return()
  endif()
  get_property(targets DIRECTORY ${directory} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    get_target_property(links ${target} LINK_LIBRARIES)
    get_target_property(from ${target} CUBOCT_HEADERS)
    # What is loaded at run time is compiled otherwise; what links nothing does not know the headers' folders.
    if(target STREQUAL "${from}" OR from STREQUAL none OR NOT links OR NOT (type MATCHES "^(STATIC_LIBRARY|EXECUTABLE)$" OR (type STREQUAL OBJECT_LIBRARY AND from)))
      continue()
    endif()
    if(directory MATCHES "^${CMAKE_SOURCE_DIR}/tests")
      if(NOT "${links}" MATCHES "GTest::")
        continue()
      endif()
      if(NOT from)
        set(from test_headers)
      endif()
    elseif(NOT from)
      set(from library_headers)
    endif()
    target_precompile_headers(${target} REUSE_FROM ${from})
    # GCC 12 takes what was precompiled for the project's own, and its false alarms about std::string come through.
    target_compile_options(${target} PRIVATE
      "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess;-Wno-array-bounds;-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread>")
  endforeach()
  get_property(parts DIRECTORY ${directory} PROPERTY SUBDIRECTORIES)
  foreach(part ${parts})
    cuboct_precompile(${part})
  endforeach()
endfunction()
