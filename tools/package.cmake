# `cpack -G DEB` in a build directory, or its target package: a Debian package. Programs lie together in lib/cuboct/bin, where each
# finds those beside it; bin/cuboct leads there. What they load is Debian's, by dpkg-shlibdeps.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME cuboct)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
if(NOT CPACK_PACKAGE_CONTACT)
  set(CPACK_PACKAGE_CONTACT "cuboct maintainers <maintainers@cuboct.example.org>")  # -DCPACK_PACKAGE_CONTACT="NAME <ADDRESS>"
endif()
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL debian)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_DEBIAN_PACKAGE_NAME cuboct)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/tools/package_date.cmake)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENT_DEBIAN_DESCRIPTION "particle matter and the hardware that computes it
cuboct runs materials that are written as local update rules on a 3D lattice
of particle processors, and emits the machine that computes them as
SystemVerilog. Fast software, cycle-accurate models and the emitted machine
hold the same bits after every step.

This package has the command, its engines, the module for Python 3, the
library for C++, man pages, completion for bash and zsh, the pages of the
documentation, scenes and machine descriptions.")
# Pictures and reports; the RTL's engine; synthesis; what compiles rules of text and programs that link the library.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, verilator, yosys, nextpnr-ice40, openmpi-bin")

set(parts cuboct cuboct-bench cuboct-board-sim cuboct-fpga cuboct-gpu cuboct-lattice cuboct-machine cuboct-read-mesh cuboct-read-trace cuboct-rtl
  cuboct-study cuboct-systemc cuboct-view)
set(home lib/cuboct)
set(control ${PROJECT_BINARY_DIR}/debian)
set(CPACK_DEBIAN_DEBIAN_PACKAGE_CONTROL_EXTRA "")
set(multiarch lib/${CMAKE_LIBRARY_ARCHITECTURE})
# Of this component alone: cmake --install makes another layout (install.cmake).
function(debian_install)
  install(${ARGN} COMPONENT debian EXCLUDE_FROM_ALL)
endfunction()
foreach(part ${parts})
  if(TARGET ${part})
    debian_install(PROGRAMS $<TARGET_FILE:${part}> DESTINATION ${home}/bin)
  endif()
endforeach()
foreach(module cuboct_mesh cuboct_evolution cuboct_machine_evolution)
  if(TARGET ${module})
    debian_install(FILES $<TARGET_FILE:${module}> DESTINATION ${home}/lib)
  endif()
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/rules DESTINATION ${home}/lib COMPONENT debian EXCLUDE_FROM_ALL FILES_MATCHING PATTERN "*.so")
if(TARGET cuboct_library)
  file(WRITE ${control}/triggers "activate-noawait ldconfig\n")
  file(WRITE ${control}/shlibs "libcuboct ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} cuboct\n")
  list(APPEND CPACK_DEBIAN_DEBIAN_PACKAGE_CONTROL_EXTRA ${control}/triggers ${control}/shlibs)
  debian_install(FILES $<TARGET_FILE:cuboct_library> DESTINATION ${multiarch})
  debian_install(FILES $<TARGET_SONAME_FILE:cuboct_library> $<TARGET_LINKER_FILE:cuboct_library> DESTINATION ${multiarch})
  debian_install(FILES library/cuboct/cuboct.h DESTINATION include/cuboct)
  debian_install(FILES library/cuboctConfig.cmake ${PROJECT_BINARY_DIR}/cuboctConfigVersion.cmake DESTINATION ${multiarch}/cmake/cuboct)
endif()
if(TARGET _cuboct)
  # Debian's python3 looks there; the module is of this minor version alone.
  set(python ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR})
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3 (>= ${python}), python3 (<< ${Python_VERSION_MAJOR}.${next}), python3-numpy")
  file(GLOB files python/cuboct/*.py python/cuboct/*.pyi python/cuboct/py.typed)
  # What python3 compiled goes with the package.
  file(WRITE ${control}/prerm "#!/bin/sh\nset -e\nif command -v py3clean >/dev/null; then py3clean -p cuboct; fi\n")
  list(APPEND CPACK_DEBIAN_DEBIAN_PACKAGE_CONTROL_EXTRA ${control}/prerm)
  debian_install(FILES ${files} $<TARGET_FILE:_cuboct> DESTINATION lib/python3/dist-packages/cuboct)
endif()
install(DIRECTORY scenes technologies DESTINATION share/cuboct COMPONENT debian EXCLUDE_FROM_ALL PATTERN __pycache__ EXCLUDE)
debian_install(FILES cli/completion/cuboct.bash DESTINATION share/bash-completion/completions RENAME cuboct)
debian_install(FILES cli/completion/_cuboct DESTINATION share/zsh/vendor-completions)
debian_install(FILES LICENSE DESTINATION share/doc/cuboct RENAME copyright)
if(TARGET docs)
  set(site ${CMAKE_COMMAND} -E env MKDOCS=${CUBOCT_MKDOCS} ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/site.py ${PROJECT_BINARY_DIR}/docs-work)
endif()
install(CODE "set(USR \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX})
set(HOME ${home})
set(CUBOCT $<TARGET_FILE:cuboct>)
set(SOURCE ${PROJECT_SOURCE_DIR})
set(STRIP ${CMAKE_STRIP})
set(SITE ${site})
set(CMAKE ${CMAKE_COMMAND})
include(${PROJECT_SOURCE_DIR}/tools/package_files.cmake)" COMPONENT debian EXCLUDE_FROM_ALL)
include(CPack)
