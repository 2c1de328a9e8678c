// SPDX-License-Identifier: MIT
// Commands and their options. CLI11 parses them, which costs a file that reads its header twelve seconds of
// compiling: options.cpp alone does.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cuboct {

// Each member changes the option and returns it.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  Option needs(Option other);
  Option excludes(Option other);

  // In help: what its value is without the option: what it is now, or a text.
  Option show_default();
  Option show_default(const std::string& text);

  // Of a list: what parts its values within a word; how many there are; that one word holds them all.
  Option delimiter(char between);
  Option length(int values);
  Option one_word();

  // Of each value. Number: int, uint32_t, uint64_t, double.
  template <typename Number>
  Option range(Number least, Number most);
  Option one_of(std::initializer_list<const char*> values);
  Option one_of(std::initializer_list<int> values);
  // The same for completion alone: every value is taken here, as who reads it tells of a wrong one.
  Option proposed(const std::vector<std::string>& values);
  // `wrong` returns what is wrong with a value as it was typed, or nothing.
  Option check(const std::function<std::string(const std::string&)>& wrong);

  // Sets `flag` where the option is on the command line.
  Option given(bool& flag);

 private:
  CLI::Option* option_;
};

// What help tells of an option.
struct OptionText {
  std::vector<std::string> names;  // "-q", "--quiet"; none: a word without a name
  std::string type_name;           // of its value; empty: a flag
  std::string description, shown_default;
  std::vector<std::string> values;  // those of one_of() or proposed(); empty: others
  bool required = false;
  bool list = false;  // of several values, with a character between
};

// The same of a command, and of those below it.
struct CommandText {
  std::string name, description;
  bool any_words = false;
  std::vector<OptionText> options;
  std::vector<CommandText> commands;
};

// A command line that cannot be read.
class WrongWords : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A program, or a command of one. Copies are the same command. What the options write to must live until the
// words are parsed.
class Command {
 public:
  Command(const std::string& name, const std::string& description);
  std::string name() const;
  CommandText text() const;

  Command command(const std::string& name, const std::string& description);
  void require_command();

  // `names` as "-v,--verbose", or one without dashes for a word by its place. Value: std::string, int,
  // uint32_t, uint64_t, double, std::optional<uint64_t>, or std::vector of std::string, int or uint64_t,
  // which help calls `value_name`, as "FILE", or after its type.
  template <typename Value>
  Option option(const std::string& names, Value& value, const std::string& description,
                const std::string& value_name = {});
  // "!--no-name" clears the value.
  Option flag(const std::string& names, bool& value, const std::string& description);

  // Of commands that are added later, too: the option for help, and the text that it prints.
  void help(const std::string& names, const std::string& description,
            std::function<std::string(const CommandText&)> text);
  void version(const std::string& names, std::function<std::string()> text, const std::string& description);

  // Called once the words are parsed.
  void callback(std::function<void()> run);
  // Takes all words as they are, those for help as well.
  void any_words();

  // Nothing, or the text of help or version where that is asked for. Throws WrongWords, and what callbacks
  // throw.
  std::optional<std::string> parse(std::vector<std::string> words);

 private:
  explicit Command(std::shared_ptr<CLI::App> app) : app_(std::move(app)) {}
  std::shared_ptr<CLI::App> app_;
};

}  // namespace cuboct
