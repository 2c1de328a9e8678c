// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/templates.h"
#include "hw/program/options.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/spelling.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

struct Template {
  std::string name, text;
  // The first line, a comment.
  std::string what() const { return text.substr(2, text.find('\n') - 2); }
};

const std::vector<Template>& templates() {
  static const std::vector<Template> all{
      {"tension", kTensionScene}, {"impact", kImpactScene}, {"drop", kDropScene},   {"beam", kBeamScene},
      {"gas", kGasScene},         {"metal", kMetalScene},   {"crack", kCrackScene}, {"sheet", kSheetScene},
      {"release", kReleaseScene}, {"rule", kRuleScene}};
  return all;
}

struct NewOptions {
  std::string name, like = "tension";
  bool list = false, force = false;
  Answer answer;
};

std::vector<std::string> template_names() {
  std::vector<std::string> names;
  for (const Template& one : templates()) names.push_back(one.name);
  return names;
}

const Template& template_of(const std::string& like) {
  const auto found = std::ranges::find(templates(), like, &Template::name);
  if (found != templates().end()) return *found;
  const std::vector<std::string> names = template_names();
  const std::string near = did_you_mean(like, names);
  throw InputError(fmt::format("unknown template '{}'", like),
                   near.empty() ? "one of " + list_of(names) : near);
}

void make(const NewOptions& options) {
  const Answer& answer = options.answer;
  if (options.list) {
    std::vector<Items> all;
    for (const Template& one : templates()) {
      answer.say("{:<8} {}\n", one.name, one.what());
      all.emplace_back().add("name", one.name);
      all.back().add("what", one.what());
    }
    Items items;
    items.add_list("templates", "template", all);
    if (answer.json) answer.close(items);
    return;
  }
  if (options.name.empty())
    throw InputError("no NAME for the scene", "cuboct new --list tells what there is");
  const Template& like = template_of(options.like);
  const std::string path = options.name + (options.name.ends_with(".toml") ? "" : ".toml");
  if (!options.force && std::filesystem::exists(std::filesystem::symlink_status(path)))
    throw InputError(fmt::format("{} is there already", path), "--force replaces it");
  check_writable(path);
  write_text(path, like.text);
  const std::string shown = line_text(path);
  answer.close(json_object({{"file", json(path)}}));
  answer.say("{}: {}\n  cuboct check {}\n  cuboct run {} --out out/{}\n", shown, like.what(), shown, shown,
             line_text(std::filesystem::path(path).stem()));
}

}  // namespace

const std::string& template_text(const std::string& name) { return template_of(name).text; }

void add_new(Command& app, int& exit_code) {
  auto [command, options] = add_command<NewOptions>(app, "new", exit_code, make);
  command.option("name", options->name, "the file, NAME.toml", "NAME");
  command.option("--like", options->like, "what it shows: see --list", "TEMPLATE")
      .proposed(template_names())
      .show_default();
  command.flag("--list", options->list, "tell what templates there are");
  options->answer.add_to(command);
  command.flag("--force", options->force, "replace a file of that name");
}

}  // namespace cuboct
