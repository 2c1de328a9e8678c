// SPDX-License-Identifier: MIT
// Titles, names, paths and notes come from a scene, a study, a directory or a result of a stranger. They are
// data in every place that they reach: here is one function for each such place, and no other code escapes.
// A character that is not to be seen (a control, a mark of writing direction, a line separator) becomes its
// escape: \n, \t, \x1b, \u202e. A byte that is no UTF-8 becomes \xff.
#pragma once

#include <string>

namespace cuboct {

// One line of a terminal, a log or a table; a comment that ends with its line (// in SystemVerilog, # in TOML
// and shell).
std::string line_text(const std::string& text);
// Several lines for a terminal: '\n' stays.
std::string block_text(const std::string& text);

// Text between tags and in quoted attributes of HTML, SVG and XML. '\n' and '\t' stay.
std::string html_text(const std::string& text);
// A quoted string of JSON, pure in what it shows, which may also stand inside a script element of HTML.
std::string json_text(const std::string& text);
// A quoted string of TOML.
std::string toml_string(const std::string& text);

// Strings of gnuplot. In single quotes it expands no command, macro or escape. `gnuplot_label`: what is
// drawn, not read as markup (keywords such as `at` may follow). `gnuplot_file`: never a pipe, standard input
// or a special name.
std::string gnuplot_text(const std::string& text);
std::string gnuplot_label(const std::string& text);
std::string gnuplot_file(const std::string& path);

// One word of a shell, kept byte by byte.
std::string shell_word(const std::string& text);
// One word of Tcl, kept byte by byte.
std::string tcl_word(const std::string& text);
// A file's name in a yosys script, which knows no escapes: InputError where the name cannot be written.
std::string yosys_file(const std::string& path);

// One column of extended XYZ, which readers split at any blank that Unicode knows. Never empty.
std::string xyz_word(const std::string& text);
// Part of a file's name: letters, digits, '_' and '-'; other bytes as %2f. At most 80 characters: the end of
// a longer one is a hash of all of it.
std::string file_word(const std::string& text);

}  // namespace cuboct
