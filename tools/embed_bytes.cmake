# Files as C++ strings, byte by byte (as hexadecimal escapes, so that no text can end its literal).

# add_part(FUNCTION FILE...): appends to `text` a function that returns what the files hold, one after the other.
function(add_part function)
  set(hex "")
  foreach(file ${ARGN})
    file(READ ${file} one HEX)
    string(APPEND hex "${one}")
  endforeach()
  string(LENGTH "${hex}" length)
  math(EXPR size "${length} / 2")
  string(REGEX REPLACE "(..)" "\\\\x\\1" escaped "${hex}")
  set(text "${text}std::string_view ${function}() { return {\"${escaped}\", ${size}}; }\n" PARENT_SCOPE)
endfunction()
