// SPDX-License-Identifier: MIT
#include "hw/program/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>

namespace cuboct {
namespace {

// "NAME:{a,b}" lists its values, as CLI::IsMember describes itself.
std::vector<std::string> values_in(const std::string& type) {
  std::vector<std::string> values;
  const size_t begin = type.find(":{"), end = type.find('}', begin);
  if (begin == std::string::npos || end == std::string::npos) return values;
  std::istringstream list(type.substr(begin + 2, end - begin - 2));
  for (std::string value; std::getline(list, value, ',');) values.push_back(value);
  return values;
}

OptionText text_of(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  // "N" of "N:INT in [1 - 4096]": what an option accepts it says where it refuses.
  if (option.get_expected_max() > 0)
    text.type_name = option.get_type_name().substr(0, option.get_type_name().find(':'));
  text.values = values_in(option.get_type_name());
  text.description = option.get_description();
  text.shown_default = option.get_default_str();
  text.required = option.get_required();
  text.list = option.get_delimiter() != 0;
  return text;
}

CommandText text_of(const CLI::App& app) {
  CommandText text;
  text.name = app.get_name();
  text.description = app.get_description();
  text.any_words = app.get_prefix_command();
  for (const CLI::Option* option : app.get_options()) text.options.push_back(text_of(*option));
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    text.commands.push_back(text_of(*command));
  return text;
}

class Help : public CLI::FormatterBase {
 public:
  explicit Help(std::function<std::string(const CommandText&)> text) : text_(std::move(text)) {}
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override {
    return text_(text_of(*app));
  }

 private:
  std::function<std::string(const CommandText&)> text_;
};

// CLI11's complaints in the words of all others: what was given, and what it should be.
std::string told(const std::string& text) {
  const auto after = [&](const std::string& begin) -> std::optional<std::string> {
    return text.starts_with(begin) ? std::optional(text.substr(begin.size())) : std::nullopt;
  };
  // "--steps: 1 required N missing"
  const size_t colon = text.find(": ");
  const std::string name = text.substr(0, colon),
                    rest = colon == std::string::npos ? std::string() : text.substr(colon + 2);
  if (rest.starts_with("1 required ") && rest.ends_with(" missing"))
    return "the option '" + name + "' has no value";
  if (rest.starts_with("At Most 1 required but received ")) return "the option '" + name + "' is given twice";
  if (constexpr std::string_view kRequired = " is required"; text.ends_with(kRequired)) {
    const std::string what = text.substr(0, text.size() - kRequired.size());
    return what.starts_with('-') ? "the option '" + what + "' is required" : "no " + what + " is given";
  }
  if (const auto convert = after("Could not convert: "))
    if (const size_t equals = convert->find(" = "); equals != std::string::npos)
      return "the option '" + convert->substr(0, equals) + "' takes a number, not '" +
             convert->substr(equals + 3) + "'";
  if (const auto word = after("The following argument was not expected: "))
    return (word->starts_with('-') ? "unknown option '" : "one word too many: '") + *word + "'";
  if (const auto words = after("The following arguments were not expected: "))
    return "words too many: '" + *words + "'";
  return text;
}

}  // namespace

Option Option::required() { return Option(option_->required()); }
Option Option::needs(Option other) { return Option(option_->needs(other.option_)); }
Option Option::excludes(Option other) { return Option(option_->excludes(other.option_)); }
Option Option::show_default() { return Option(option_->capture_default_str()); }
Option Option::show_default(const std::string& text) { return Option(option_->default_str(text)); }
Option Option::delimiter(char between) { return Option(option_->delimiter(between)); }
Option Option::length(int values) { return Option(option_->expected(values)); }
Option Option::one_word() { return Option(option_->allow_extra_args(false)); }

template <typename Number>
Option Option::range(Number least, Number most) {
  return Option(option_->check(CLI::Range(least, most)));
}
template Option Option::range(int, int);
template Option Option::range(uint32_t, uint32_t);
template Option Option::range(uint64_t, uint64_t);
template Option Option::range(double, double);

Option Option::one_of(std::initializer_list<const char*> values) {
  return Option(option_->check(CLI::IsMember(std::vector<std::string>(values.begin(), values.end()))));
}

Option Option::one_of(std::initializer_list<int> values) {
  return Option(option_->check(CLI::IsMember(std::vector<int>(values))));
}

Option Option::proposed(const std::vector<std::string>& values) {
  std::string list;
  for (const std::string& value : values) list += (list.empty() ? "" : ",") + value;
  return Option(option_->check(CLI::Validator([](std::string&) { return std::string(); }, "{" + list + "}")));
}

Option Option::check(const std::function<std::string(const std::string&)>& wrong) {
  return Option(option_->check(wrong));
}

Option Option::given(bool& flag) {
  return Option(option_->each([&flag](const std::string&) { flag = true; }));
}

Command::Command(const std::string& name, const std::string& description)
    : app_(std::make_shared<CLI::App>(description, name)) {}

std::string Command::name() const { return app_->get_name(); }
CommandText Command::text() const { return text_of(*app_); }

Command Command::command(const std::string& name, const std::string& description) {
  return Command(app_->get_subcommand_ptr(app_->add_subcommand(name, description)));
}

void Command::require_command() { app_->require_subcommand(1); }

template <typename Value>
Option Command::option(const std::string& names, Value& value, const std::string& description,
                       const std::string& value_name) {
  CLI::Option* option = app_->add_option(names, value, description);
  return Option(value_name.empty() ? option : option->type_name(value_name));
}
using Text = const std::string&;
template Option Command::option(Text, std::string&, Text, Text);
template Option Command::option(Text, int&, Text, Text);
template Option Command::option(Text, uint32_t&, Text, Text);
template Option Command::option(Text, uint64_t&, Text, Text);
template Option Command::option(Text, double&, Text, Text);
template Option Command::option(Text, std::optional<uint64_t>&, Text, Text);
template Option Command::option(Text, std::vector<std::string>&, Text, Text);
template Option Command::option(Text, std::vector<int>&, Text, Text);
template Option Command::option(Text, std::vector<uint64_t>&, Text, Text);

Option Command::flag(const std::string& names, bool& value, const std::string& description) {
  return Option(app_->add_flag(names, value, description));
}

void Command::help(const std::string& names, const std::string& description,
                   std::function<std::string(const CommandText&)> text) {
  app_->set_help_flag(names, description);
  app_->formatter(std::make_shared<Help>(std::move(text)));
}

void Command::version(const std::string& names, std::function<std::string()> text,
                      const std::string& description) {
  app_->set_version_flag(names, std::move(text), description);
}

void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

void Command::any_words() {
  app_->prefix_command();
  app_->set_help_flag();
}

std::optional<std::string> Command::parse(std::vector<std::string> words) {
  std::ranges::reverse(words);  // as CLI11 takes them
  try {
    app_->parse(std::move(words));
    return {};
  } catch (const CLI::Success& asked) {
    std::ostringstream text;
    app_->exit(asked, text);
    return text.str();
  } catch (const CLI::Error& wrong) {
    throw WrongWords(told(wrong.what()));
  }
}

}  // namespace cuboct
