// SPDX-License-Identifier: MIT
#include "cli/help.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace cuboct {
namespace {

constexpr size_t kColumns = 80, kIndent = 26;

using Entry = HelpEntry;
constexpr std::array kEntries{
    Entry{"make a scene", "new", "cuboct new arm --like beam"},
    Entry{"make a scene", "check", "cuboct check scenes/coupon.toml"},
    Entry{"run it", "run", "cuboct run scenes/coupon.toml --steps 400 --out out/coupon"},
    Entry{"run it", "curves", "cuboct curves out/coupon --out coupon.csv"},
    Entry{"run it", "measure", "cuboct measure out/melt rdf --out rdf.csv"},
    Entry{"run it", "state", "cuboct state out/coupon --out coupon.xyz"},
    Entry{"run it", "picture", "cuboct picture out/coupon --field speed"},
    Entry{"run it", "view", "cuboct view out/coupon --save coupon.html"},
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

std::string value_of(const OptionText& option) {
  return option.type_name == "TEXT" ? "WORD" : option.type_name;
}

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

std::string of_command(const CommandText& command) {
  std::string words, options;
  for (const OptionText& option : command.options) {
    if (option.names.empty()) {
      words += row(option_names(option), option_text(option));
    } else {
      options += row(option_names(option), option_text(option));
    }
  }
  const auto entry = std::ranges::find(kEntries, command.name, &Entry::command);
  return fmt::format("{}: {}\n{}\n\n{}\noptions:\n{}\nexample:\n  {}\n", command.name, command.description,
                     usage_of(command), words, options, entry->example);
}

std::string of_all(const CommandText& app) {
  std::string text = fmt::format("{}\nusage: cuboct COMMAND ...\n", app.description), group;
  for (const Entry& entry : kEntries) {
    if (group != entry.group) text += fmt::format("\n{}:\n", group = entry.group);
    const auto command = std::ranges::find(app.commands, entry.command, &CommandText::name);
    text +=
        fmt::format("  {:<12}{}\n                {}\n", entry.command, command->description, entry.example);
  }
  return text +
         "\n'cuboct help COMMAND', or 'cuboct COMMAND --help', tells its options. 'cuboct\n"
         "--version' tells version, commit and engines. Exit codes: 0 done; 1 a run found\n"
         "something wrong, or failed; 2 the input or the command line is wrong.\n";
}

}  // namespace

std::span<const HelpEntry> help_entries() { return kEntries; }

std::string option_names(const OptionText& option) {
  if (option.names.empty()) return value_of(option);
  const std::string value = value_of(option);
  return fmt::format("{}{}{}", fmt::join(option.names, ", "), value.empty() ? "" : " ", value);
}

std::string option_text(const OptionText& option) {
  std::string text = option.description;
  if (!option.shown_default.empty()) text += fmt::format("; default: {}", option.shown_default);
  if (option.required && !option.names.empty()) text += "; required";
  return text;
}

std::string usage_of(const CommandText& command) {
  std::string usage = "usage: cuboct " + command.name + " [OPTIONS]";
  for (const OptionText& option : command.options)
    if (option.names.empty())
      usage += option.required ? " " + value_of(option) : fmt::format(" [{}]", value_of(option));
  return usage;
}

std::string help_text(const CommandText& command) {
  return command.commands.empty() ? of_command(command) : of_all(command);
}

}  // namespace cuboct
