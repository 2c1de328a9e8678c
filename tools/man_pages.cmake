# Writes the man pages of PROGRAM and of its commands into the directory OUT, from what they say of themselves (cli/help_forms.h).
# usage: cmake -D PROGRAM=build/cuboct -D OUT=DIR -P man_pages.cmake

function(page name)  # COMMAND...
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help-as man OUTPUT_FILE ${OUT}/${name}.1 COMMAND_ERROR_IS_FATAL ANY)
endfunction()
file(MAKE_DIRECTORY ${OUT})
page(cuboct)
execute_process(COMMAND ${PROGRAM} --help-as words OUTPUT_VARIABLE words COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE ";" "," words "${words}")
string(REGEX MATCHALL "(^|\n)[a-z]+\t[^\n]*" lines "${words}")
foreach(line ${lines})
  string(REGEX MATCH "[a-z]+" command ${line})
  if(NOT line MATCHES "\tleft out: ")
    page(cuboct-${command} ${command})
  endif()
endforeach()
