// SPDX-License-Identifier: MIT
#include "cli/front.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/help.h"
#include "cli/help_forms.h"
#include "cli/programs.h"
#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "model/base/process.h"
#include "model/base/spelling.h"
#include "model/base/standard_streams.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

// CLI11 reports unknown words without a proposal, so they are looked for first.
void check_words(const CommandText& app, const std::vector<std::string>& words) {
  std::vector<std::string> commands;
  for (const CommandText& command : app.commands) commands.push_back(command.name);
  if (words.empty()) throw InputError("no command", "one of " + list_of(commands) + "; see 'cuboct --help'");
  if (words[0].starts_with('-')) {
    if (words[0] != "--help" && words[0] != "-h" && words[0] != "--version")
      throw InputError(fmt::format("unknown option '{}'", words[0]), "see 'cuboct --help'");
    return;
  }
  const auto command = std::ranges::find(app.commands, words[0], &CommandText::name);
  if (command == app.commands.end()) {
    const std::string near = did_you_mean(words[0], commands);
    throw InputError(fmt::format("unknown command '{}'", words[0]),
                     near.empty() ? "one of " + list_of(commands) : near);
  }
  if (command->any_words) return;  // not of this program, which so knows no option of it
  // An empty value is a variable of a script that was never set; an empty path would mean none.
  for (size_t i = 1; i < words.size(); ++i)
    if (words[i].empty() || (words[i].starts_with("--") && words[i].ends_with('='))) {
      const std::string option = words[i].empty() ? words[i - 1] : words[i].substr(0, words[i].size() - 1);
      throw InputError(option.starts_with("--")
                           ? fmt::format("the value of '{}' is empty", option)
                           : fmt::format("argument {} of 'cuboct {}' is empty", i, words[0]),
                       fmt::format("leave it out, or see 'cuboct {} --help'", words[0]));
    }
  std::vector<std::string> options, letters;
  for (const OptionText& option : command->options)
    for (const std::string& name : option.names) (name.starts_with("--") ? options : letters).push_back(name);
  for (size_t i = 1; i < words.size(); ++i) {
    const bool is_short = words[i].size() > 1 && words[i][0] == '-' && std::isalpha(words[i][1]);
    if (!words[i].starts_with("--") && !is_short) continue;
    const std::string name = words[i].substr(0, words[i].find('='));
    if (std::ranges::count(is_short ? letters : options, name) > 0) continue;
    const std::string near = did_you_mean(name, options);
    throw InputError(fmt::format("unknown option '{}' of 'cuboct {}'", name, words[0]),
                     near.empty() ? fmt::format("see 'cuboct {} --help'", words[0]) : near);
  }
}

// How a command is called, and what its words may be.
std::string usage_hint(const CommandText& app, const std::string& name) {
  const auto command = std::ranges::find(app.commands, name, &CommandText::name);
  if (command == app.commands.end()) return "see 'cuboct --help'";
  std::string hint = usage_of(*command);
  for (const OptionText& option : command->options)
    if (option.names.empty() && !option.values.empty())
      hint += fmt::format("; {}: {}", option.type_name, list_of(option.values));
  return hint;
}

// 'cuboct help run' is 'cuboct run --help'.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.empty() || words[0] != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

// Of words that end in "--help-as FORM", the same that end in "--help", and that form.
HelpForm take_form(std::vector<std::string>& words) {
  const size_t n = words.size();
  if (n < 2 || words[n - 2] != "--help-as") return help_text;
  const HelpForm form = help_form(words[n - 1]);
  words.pop_back();
  words.back() = "--help";
  return form;
}

int tell(const InputError& error, bool as_json, int exit_code) {
  fmt::print(stderr, "{}\n", as_json ? error.json() : error.told());
  return exit_code;
}

// Returns only by throwing.
void become(const CommandRow& row, const std::vector<std::string>& words) {
  const std::string name(row.program), path = beside(name);
  if (path.empty())
    throw InputError(fmt::format("{}: no program {} beside cuboct", row.name, name),
                     "build the target " + name);
  std::vector<char*> argv{const_cast<char*>(name.c_str())};
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execv(path.c_str(), argv.data());
  throw InputError(fmt::format("cannot start {}: {}", path, std::strerror(errno)));
}

// A command that another program has, or none.
void add_elsewhere(Command& app, const CommandRow& row, const std::vector<std::string>& words) {
  const bool left_out = row.part && !row.part->built;
  Command command =
      left_out ? app.command(std::string(row.name), fmt::format("left out: built without {}", row.part->name))
               : add_command(app, row.name);
  command.any_words();
  command.callback([&row, &words, left_out] {
    if (left_out) refuse_left_out(std::string(row.name), *row.part);
    become(row, words);
  });
}

int main_of(const std::vector<std::string>& given, bool as_json, std::span<const OwnCommand> own) {
  int exit_code = 0;
  std::vector<std::string> words = given;
  HelpForm form = help_text;
  Command app("cuboct", "cuboct: particle matter and the hardware that computes it, the same bits.");
  app.version("--version", version_text, "Print version, commit and engines, and exit");
  app.require_command();
  app.help("-h,--help", "print this help and exit", [&form](const CommandText& text) { return form(text); });
  for (const CommandRow& row : command_rows()) {
    const auto mine = std::ranges::find(own, row.name, &OwnCommand::name);
    mine != own.end() ? mine->add(app, exit_code) : add_elsewhere(app, row, given);
  }
  // What an exception says in its own words: a message, perhaps of several lines.
  const auto plain = [&](const std::string& text, int code) {
    if (as_json) return tell(InputError(text), true, code);
    fmt::print(stderr, "{}\n", block_text(text));
    return code;
  };
  try {
    form = take_form(words);
    check_words(app.text(), words);
    if (const auto asked = app.parse(words)) fmt::print("{}", *asked);
  } catch (const WrongWords& error) {
    const std::string said = error.what();  // an option that is named needs no more
    return tell(InputError(said, said.starts_with("-") ? "" : usage_hint(app.text(), words[0])), as_json, 2);
  } catch (const InputError& error) {
    return tell(error, as_json, 2);
  } catch (const Failed& failed) {
    return tell(failed.error, as_json, 1);
  } catch (const std::exception& error) {
    if (const auto refusal = path_error(error)) return tell(*refusal, as_json, 2);
    return plain(failure_text(error), 1);
  }
  return exit_code;
}

}  // namespace

int front(int argc, char** argv, std::span<const OwnCommand> own) {
  bool as_json = false;
  const auto work = [&] {
    const std::vector<std::string> words = words_of(argc, argv);
    as_json = std::ranges::count(words, "--json") > 0;
    return main_of(words, as_json, own);
  };
  // By reference, as it holds too much to be copied without memory.
  return with_standard_streams(std::cref(work),
                               [&](const std::string& text) { tell(InputError(text), as_json, 1); });
}

}  // namespace cuboct
