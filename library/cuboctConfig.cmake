# find_package(cuboct): the target cuboct::cuboct, the shared library of cuboct/cuboct.h. It needs no other package.
get_filename_component(_cuboct_lib "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
# Of a prefix, lib; of Debian, lib and the architecture.
find_path(_cuboct_include cuboct/cuboct.h PATHS ${_cuboct_lib}/../include ${_cuboct_lib}/../../include NO_DEFAULT_PATH NO_CACHE)
if(NOT _cuboct_include)
  set(cuboct_FOUND FALSE)
  set(cuboct_NOT_FOUND_MESSAGE "no cuboct/cuboct.h beside ${_cuboct_lib}")
  return()
endif()
if(NOT TARGET cuboct::cuboct)
  add_library(cuboct::cuboct SHARED IMPORTED)
  set_target_properties(cuboct::cuboct PROPERTIES
    IMPORTED_LOCATION "${_cuboct_lib}/libcuboct.so"
    INTERFACE_INCLUDE_DIRECTORIES "${_cuboct_include}"
    INTERFACE_COMPILE_FEATURES cxx_std_17)
endif()
unset(_cuboct_include)
unset(_cuboct_lib)
