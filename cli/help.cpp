// SPDX-License-Identifier: MIT
#include "cli/help.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <sstream>

namespace cuboct {
namespace {

constexpr size_t kColumns = 80, kIndent = 26;

// In the order in which they are shown; commands of a group stand together.
struct Entry {
  const char *group, *command, *example;
};
constexpr std::array kEntries{
    Entry{"make a scene", "new", "cuboct new arm --like beam"},
    Entry{"make a scene", "check", "cuboct check scenes/coupon.toml"},
    Entry{"run it", "run", "cuboct run scenes/coupon.toml --steps 400 --out out/coupon"},
    Entry{"run it", "picture", "cuboct picture out/coupon --field speed"},
    Entry{"run it", "report", "cuboct report out/coupon"},
    Entry{"compare", "crosscheck", "cuboct crosscheck scenes/lj_block.toml --engines golden,lattice"},
    Entry{"compare", "bench", "cuboct bench lattice.block_32k"},
    Entry{"make the hardware", "emit", "cuboct emit scenes/lj_block.toml --out out/rtl"},
    Entry{"make the hardware", "synth", "cuboct synth out/rtl --target ecp5-25"},
    Entry{"make the hardware", "energy", "cuboct energy scenes/coupon.toml --technology cmos45"},
    Entry{"make the hardware", "boards", "cuboct boards scenes/coupon.toml --nodes 64"},
    Entry{"study settings", "elastic", "cuboct elastic scenes/lj_block.toml"},
    Entry{"study settings", "explore", "cuboct explore scenes/studies/block.toml"},
    Entry{"study settings", "fit", "cuboct fit scenes/studies/fit_bar.toml"},
    Entry{"study settings", "learn", "cuboct learn scenes/studies/graphene.toml"},
    Entry{"study settings", "multiscale", "cuboct multiscale scenes/studies/silicon_stretch.toml"},
    Entry{"study settings", "pitch", "cuboct pitch scenes/studies/pitch_bar.toml --error 10%"},
    Entry{"study settings", "stability", "cuboct stability scenes/undamped_block.toml"},
};

// Breaks at blanks; `text` begins in the given column, further lines at kIndent.
std::string wrapped(const std::string& text, size_t column) {
  std::istringstream in(text);
  std::string out;
  bool first = true;
  for (std::string word; in >> word; first = false) {
    if (!first && column + 1 + word.size() > kColumns) {
      out += '\n' + std::string(kIndent, ' ');
      column = kIndent;
      first = true;
    }
    out += (first ? "" : " ") + word;
    column += word.size() + (first ? 0 : 1);
  }
  return out;
}

std::string row(const std::string& names, const std::string& text) {
  const bool fits = names.size() + 4 <= kIndent;
  return fmt::format("  {}{}{}\n", names,
                     fits ? std::string(kIndent - 2 - names.size(), ' ') : '\n' + std::string(kIndent, ' '),
                     wrapped(text, kIndent));
}

// "N" of "N:INT in [1 - 4096]": what an option accepts it says where it refuses.
std::string value_of(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return {};
  const std::string type = option.get_type_name().substr(0, option.get_type_name().find(':'));
  return type == "TEXT" ? "WORD" : type;
}

std::string names_of(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  const std::string value = value_of(option);
  return value.empty() ? names : names + " " + value;
}

std::string text_of(const CLI::Option& option) {
  std::string text = option.get_description();
  if (!option.get_default_str().empty()) text += fmt::format("; default: {}", option.get_default_str());
  if (option.get_required() && !option.get_positional()) text += "; required";
  return text;
}

class Help : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override {
    return app->get_parent() ? of_command(*app) : of_all(*app);
  }

 private:
  static std::string of_command(const CLI::App& app) {
    std::string usage = "usage: cuboct " + app.get_name() + " [OPTIONS]", words, options;
    for (const CLI::Option* option : app.get_options()) {
      if (option->get_positional()) {
        const std::string value = value_of(*option);
        usage += option->get_required() ? " " + value : fmt::format(" [{}]", value);
        words += row(value, text_of(*option));
      } else if (!option->get_group().empty()) {
        options += row(names_of(*option), text_of(*option));
      }
    }
    return fmt::format("{}: {}\n{}\n\n{}\noptions:\n{}\nexample:\n  {}\n", app.get_name(),
                       app.get_description(), usage, words, options, app.get_footer());
  }

  static std::string of_all(const CLI::App& app) {
    std::string text = fmt::format("{}\nusage: cuboct COMMAND ...\n", app.get_description()), group;
    for (const Entry& entry : kEntries) {
      if (group != entry.group) text += fmt::format("\n{}:\n", group = entry.group);
      text += fmt::format("  {:<12}{}\n                {}\n", entry.command,
                          app.get_subcommand(entry.command)->get_description(), entry.example);
    }
    return text +
           "\n'cuboct help COMMAND', or 'cuboct COMMAND --help', tells its options. 'cuboct\n"
           "--version' tells version, commit and engines. Exit codes: 0 done; 1 a run found\n"
           "something wrong, or failed; 2 the input or the command line is wrong.\n";
  }
};

}  // namespace

void set_help(CLI::App& app) {
  const auto help = std::make_shared<Help>();
  app.formatter(help);
  for (const Entry& entry : kEntries) {
    CLI::App* command = app.get_subcommand(entry.command);
    command->formatter(help);
    command->footer(entry.example);
  }
}

}  // namespace cuboct
