// SPDX-License-Identifier: MIT
// What --help prints, in other forms: `cuboct [COMMAND] --help-as FORM`. Man pages and the completion of
// shells are made from it, so that a new command or option has both.
#pragma once

#include <string>

#include "hw/program/options.h"

namespace cuboct {

// FORM "man": a page of section 1 for man(1), in roff. Of a command its options; of the whole its commands.
std::string help_as_man(const CommandText& command);

// FORM "words": for the completion of shells a line per word that may come next, of four fields with tabs
// between:
//   names   "-q,--quiet", a command, or nothing for a word by its place
//   value   its kind, as "FILE", of a list "NAME,..."; nothing of a flag
//   values  those it may have, with commas between; nothing where they are not listed
//   text    what help tells of it
std::string help_as_words(const CommandText& command);

using HelpForm = std::string (*)(const CommandText&);
// InputError where there is no such form.
HelpForm help_form(const std::string& name);

}  // namespace cuboct
