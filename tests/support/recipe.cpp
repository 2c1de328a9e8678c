// SPDX-License-Identifier: MIT
#include "tests/support/recipe.h"

#include <cstdio>
#include <map>
#include <sstream>
#include <stdexcept>

namespace cuboct::test {
namespace {

// A word that stands alone.
bool flag(Recipe& r, const std::string& word) {
  static const std::map<std::string, bool Features::*> features{{"two_materials", &Features::two_materials},
                                                                {"contact", &Features::contact},
                                                                {"masses", &Features::masses},
                                                                {"laws", &Features::laws},
                                                                {"held", &Features::held},
                                                                {"force_held", &Features::force_held},
                                                                {"gravity", &Features::gravity},
                                                                {"flat", &Features::flat}};
  static const std::map<std::string, void (*)(Recipe&)> others{
      {"lone", [](Recipe& s) { s.lone = true; }},
      {"narrow", [](Recipe& s) { narrow(s.arch); }},
      {"overlap", [](Recipe& s) { s.arch.overlap = true; }},
      {"no_overlap", [](Recipe& s) { s.arch.overlap = false; }},
      {"arrival", [](Recipe& s) { s.arch.halos = Halos::arrival; }},
      {"shared", [](Recipe& s) { s.arch.multipliers = Multipliers::shared; }},
      {"serial", [](Recipe& s) { s.arch.multipliers = Multipliers::serial; }},
      {"retry", [](Recipe& s) { s.arch.link_check = LinkCheck::retry; }},
      {"detect", [](Recipe& s) { s.arch.link_check = LinkCheck::detect; }},
      {"octaves", [](Recipe& s) { s.arch.table.shape = TableChoice::Shape::octaves; }},
      {"uniform", [](Recipe& s) { s.arch.table.shape = TableChoice::Shape::uniform; }}};
  if (const auto found = features.find(word); found != features.end())
    r.features.*found->second = true;
  else if (const auto other = others.find(word); other != others.end())
    other->second(r);
  else
    return false;
  return true;
}

bool cell(Recipe& r, const std::string& key, const std::string& value) {
  Cell* const to = key == "size"       ? &r.features.size
                   : key == "brick"    ? &r.arch.brick
                   : key == "periodic" ? &r.periodic
                                       : nullptr;
  return to != nullptr && std::sscanf(value.c_str(), "%dx%dx%d", &(*to)[0], &(*to)[1], &(*to)[2]) == 3;
}

bool number(Recipe& r, const std::string& key, const std::string& value) {
  const std::map<std::string, double*> reals{
      {"cutoff", &r.features.cutoff},   {"jitter", &r.features.jitter}, {"speed", &r.features.speed},
      {"damping", &r.features.damping}, {"margin", &r.features.margin}, {"cell_edge", &r.arch.cell_edge}};
  const std::map<std::string, int*> integers{{"capacity", &r.arch.capacity},
                                             {"lanes", &r.arch.filter_lanes},
                                             {"pipes", &r.arch.force_pipes},
                                             {"streamers", &r.arch.streamers},
                                             {"queue", &r.arch.queue_depth},
                                             {"link_bits", &r.arch.link_bits},
                                             {"degree", &r.arch.table.degree},
                                             {"index_bits", &r.arch.table.index_bits},
                                             {"filter_frac", &r.arch.widths.filter_frac},
                                             {"guard", &r.arch.widths.guard},
                                             {"difference_frac", &r.arch.widths.difference_frac},
                                             {"velocity_bits", &r.arch.widths.velocity_bits},
                                             {"sum_bits", &r.arch.widths.sum_bits}};
  if (const auto found = reals.find(key); found != reals.end())
    *found->second = std::stod(value);
  else if (const auto whole = integers.find(key); whole != integers.end())
    *whole->second = std::stoi(value);
  else if (key == "steps")
    r.steps = std::stoull(value);
  else
    return false;
  return true;
}

}  // namespace

void narrow(Arch& arch) {
  arch.narrow_memories = true;
  arch.halos = Halos::phases;
  arch.filter_lanes = arch.force_pipes = arch.streamers = 1;
  arch.overlap = false;
}

void season(Recipe& recipe, const std::string& words) {
  std::istringstream all(words);
  for (std::string word; all >> word;) {
    const size_t at = word.find('=');
    const std::string key = word.substr(0, at), value = at == std::string::npos ? "" : word.substr(at + 1);
    if (!(at == std::string::npos ? flag(recipe, key)
                                  : cell(recipe, key, value) || number(recipe, key, value)))
      throw std::invalid_argument(word);
  }
}

}  // namespace cuboct::test
