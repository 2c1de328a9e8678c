# `cmake --install build --strip --prefix DIR`: a directory for machines that have none of our packages. DIR/bin has
# the programs that need no more than a shell, and those that read strangers' files for them; DIR/lib every shared library
# they load but glibc's, which comes with each system and must be its own.
set(installed cuboct cuboct-study cuboct-machine cuboct-bench cuboct-read-trace)
foreach(program cuboct-gpu cuboct-read-mesh cuboct-view)
  if(TARGET ${program})
    list(APPEND installed ${program})
  endif()
endforeach()
foreach(program ${installed})
  # RPATH, not RUNPATH: it holds for what the libraries themselves load too.
  target_link_options(${program} PRIVATE -Wl,--disable-new-dtags)
  set_target_properties(${program} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib")
endforeach()
if(TARGET cuboct_mesh)  # loaded by name, from lib beside bin
  target_link_options(cuboct_mesh PRIVATE -Wl,--disable-new-dtags)
  set_target_properties(cuboct_mesh PROPERTIES INSTALL_RPATH "$ORIGIN")
  install(TARGETS cuboct_mesh RUNTIME_DEPENDENCY_SET libraries LIBRARY DESTINATION lib)
endif()
install(TARGETS ${installed} RUNTIME_DEPENDENCY_SET libraries RUNTIME DESTINATION bin)
# For programs of others: find_package(cuboct) in CMAKE_PREFIX_PATH=DIR.
if(TARGET cuboct_library)
  include(CMakePackageConfigHelpers)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/cuboctConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  target_link_options(cuboct_library PRIVATE -Wl,--disable-new-dtags)
  set_target_properties(cuboct_library PROPERTIES INSTALL_RPATH "$ORIGIN")
  install(TARGETS cuboct_library RUNTIME_DEPENDENCY_SET libraries LIBRARY DESTINATION lib)
  install(FILES library/cuboct/cuboct.h DESTINATION include/cuboct)
  install(FILES library/cuboctConfig.cmake ${PROJECT_BINARY_DIR}/cuboctConfigVersion.cmake DESTINATION lib/cmake/cuboct)
endif()

install(RUNTIME_DEPENDENCY_SET libraries
  PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(c|m|mvec|dl|rt|pthread|resolv|util|anl)\\.so"
  LIBRARY DESTINATION lib)
install(DIRECTORY ${PROJECT_BINARY_DIR}/rules DESTINATION lib FILES_MATCHING PATTERN "*.so")  # kept_rules
install(DIRECTORY scenes technologies DESTINATION .)
# Where man, bash and zsh look below a prefix such as /usr/local.
install(FILES cli/completion/cuboct.bash DESTINATION share/bash-completion/completions RENAME cuboct)
install(FILES cli/completion/_cuboct DESTINATION share/zsh/site-functions)
install(CODE "execute_process(COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:cuboct>
  -D OUT=\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/man/man1 -P ${PROJECT_SOURCE_DIR}/tools/man_pages.cmake COMMAND_ERROR_IS_FATAL ANY)")
# What is inside of it, and what it was made with.
find_program(CUBOCT_PYTHON3 python3)
mark_as_advanced(CUBOCT_PYTHON3)
if(CUBOCT_PYTHON3)
  install(CODE "set(bill \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/doc/cuboct\")
    file(MAKE_DIRECTORY \"\${bill}\")
    execute_process(COMMAND ${CUBOCT_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/bill_of_materials ${PROJECT_VERSION} --out \"\${bill}/cuboct.spdx\"
      COMMAND_ERROR_IS_FATAL ANY)")
else()
  message(STATUS "Installation: without its bill of materials, as python3 is not found")
endif()
