# The target docs: README.md and docs/ as HTML, in docs/ of the build directory.
find_program(CUBOCT_MKDOCS mkdocs)
mark_as_advanced(CUBOCT_MKDOCS)
find_package(Python3 COMPONENTS Interpreter QUIET)
if(CUBOCT_MKDOCS AND Python3_Interpreter_FOUND)
  add_custom_target(docs
    COMMAND ${CMAKE_COMMAND} -E env MKDOCS=${CUBOCT_MKDOCS}
            ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/docs/site.py ${CMAKE_BINARY_DIR}/docs-work ${CMAKE_BINARY_DIR}/docs
    COMMENT "The pages as HTML: ${CMAKE_BINARY_DIR}/docs/index.html" VERBATIM)
else()
  message(STATUS "The pages as HTML: without the target docs, as mkdocs (Debian package mkdocs) is not found")
endif()
