// SPDX-License-Identifier: MIT
#include "cli/help_forms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "cli/help.h"
#include "model/base/error.h"
#include "model/trace/trace_head.h"

namespace cuboct {
namespace {

constexpr const char* kExitCodes =
    "0 done; 1 a run found something wrong, or failed; 2 the input or the command line is wrong.";

// Text as it is: '\' begins a request of roff, '-' is a hyphen to it, '.' or "'" at a line's begin a command.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string capital(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string sentence(const std::string& text) { return capital(text) + (text.ends_with('.') ? "" : "."); }

// "\fB\-q\fR, \fB\-\-quiet\fR", and the kind of the value after it.
std::string names_in_roff(const OptionText& option) {
  const std::string names = option_names(option), list = fmt::format("{}", fmt::join(option.names, ", "));
  if (option.names.empty()) return "\\fI" + roff(names) + "\\fR";
  std::string out;
  for (const std::string& name : option.names)
    out += fmt::format("{}\\fB{}\\fR", out.empty() ? "" : ", ", roff(name));
  if (names.size() > list.size()) out += " \\fI" + roff(names.substr(list.size() + 1)) + "\\fR";
  return out;
}

std::string tagged(const std::string& tag, const std::string& text) {
  return fmt::format(".TP\n{}\n{}\n", tag, roff(text));
}

// The date is left empty: the same version makes the same page.
std::string man_head(const std::string& name, const std::string& about) {
  std::string title = name;
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return std::toupper(c); });
  return fmt::format(
      ".\\\" SPDX-License-Identifier: MIT\n.TH {} 1 \"\" \"cuboct {}\" \"cuboct\"\n.SH NAME\n{} \\- {}\n",
      roff(title), program_version(), roff(name), roff(about));
}

std::string man_end(const std::string& example, const std::string& also) {
  return fmt::format(".SH EXIT STATUS\n{}\n.SH EXAMPLE\n.nf\n{}\n.fi\n.SH SEE ALSO\n{}\n", kExitCodes,
                     roff(example), also);
}

std::string man_of_command(const CommandText& command) {
  const std::string name = "cuboct-" + command.name;
  std::string synopsis = fmt::format(".B cuboct {}\n[\\fIOPTIONS\\fR]", roff(command.name)), words, options;
  for (const OptionText& option : command.options) {
    (option.names.empty() ? words : options) += tagged(names_in_roff(option), option_text(option));
    if (!option.names.empty()) continue;
    const std::string tag = names_in_roff(option);
    synopsis += option.required ? " " + tag : fmt::format(" [{}]", tag);
  }
  std::string same_group;
  const auto entry = std::ranges::find(help_entries(), command.name, &HelpEntry::command);
  for (const HelpEntry& other : help_entries())
    if (other.group == entry->group && other.command != entry->command)
      same_group += fmt::format(",\n.BR cuboct\\-{} (1)", roff(std::string(other.command)));
  return man_head(name, command.description) + ".SH SYNOPSIS\n" + synopsis + "\n.SH DESCRIPTION\n" +
         roff(sentence(command.description)) + "\n" + words + ".SH OPTIONS\n" + options +
         man_end(std::string(entry->example), ".BR cuboct (1)" + same_group);
}

std::string man_of_all(const CommandText& app) {
  std::string text = man_head("cuboct", "particle matter and the hardware that computes it");
  text +=
      ".SH SYNOPSIS\n.B cuboct\n\\fICOMMAND\\fR ...\n.br\n.B cuboct\n\\fB\\-\\-version\\fR\n.SH "
      "DESCRIPTION\n";
  text += roff(sentence(app.description.substr(app.description.find(": ") + 2)));
  text += " A scene is a file that says what is made of which material, and what happens to it.\n";
  text +=
      "Each command has a page of its own, and\n.B cuboct help\n\\fICOMMAND\\fR tells its options.\n.SH "
      "COMMANDS\n";
  std::string group, also;
  for (const HelpEntry& entry : help_entries()) {
    if (group != entry.group) text += fmt::format(".SS {}\n", roff(capital(group = entry.group)));
    const std::string name(entry.command);
    const auto command = std::ranges::find(app.commands, name, &CommandText::name);
    text += tagged("\\fB" + roff(name) + "\\fR", command->description);
    also += fmt::format("{}.BR cuboct\\-{} (1)", also.empty() ? "" : ",\n", roff(name));
  }
  text += ".SH OPTIONS\n";
  for (const OptionText& option : app.options) text += tagged(names_in_roff(option), option_text(option));
  return text + man_end(std::string(help_entries().front().example), also);
}

std::string words_line(const std::string& names, const OptionText& option) {
  const std::string shown = option_names(option), list = fmt::format("{}", fmt::join(option.names, ", "));
  std::string value = option.names.empty()         ? shown
                      : shown.size() > list.size() ? shown.substr(list.size() + 1)
                                                   : "";
  if (option.list && !value.ends_with(",...")) value += ",...";
  return fmt::format("{}\t{}\t{}\t{}\n", names, value, fmt::join(option.values, ","), option_text(option));
}

}  // namespace

std::string help_as_man(const CommandText& command) {
  return command.commands.empty() ? man_of_command(command) : man_of_all(command);
}

std::string help_as_words(const CommandText& command) {
  std::string out;
  for (const CommandText& one : command.commands)
    out += fmt::format("{}\t\t\t{}\n", one.name, one.description);
  for (const OptionText& option : command.options)
    out += words_line(fmt::format("{}", fmt::join(option.names, ",")), option);
  return out;
}

HelpForm help_form(const std::string& name) {
  if (name == "man") return help_as_man;
  if (name == "words") return help_as_words;
  throw InputError("unknown form of help '" + name + "'", "one of man or words");
}

}  // namespace cuboct
