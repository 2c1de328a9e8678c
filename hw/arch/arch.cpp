// SPDX-License-Identifier: MIT
#include "hw/arch/arch.h"

#include <fmt/format.h>

#include "hw/arch/bricks.h"
#include "model/config/file_kind.h"
#include "model/config/name.h"

namespace cuboct {
namespace {

constexpr int kMostBoardNodes = 1 << 20;  // of a device, along an axis

void set(const ConfigTable& table, const char* key, int low, int high, int& value) {
  value = static_cast<int>(table.integer_or(key, low, high, value));
}

// A format that may be "auto".
void set_automatic(const ConfigTable& table, const char* key, int low, int high, int& value) {
  const auto found = table.find(key);
  if (!found) return;
  value = found->is_string() && found->choice("width", {"auto"}) == 0
              ? kAutomatic
              : static_cast<int>(found->integer(low, high));
}

// Three numbers, along x, y and z; `hint` is an example.
Cell read_cells(const ConfigValue& value, const char* what, const char* hint, int most) {
  const std::vector<ConfigValue> numbers = value.items();
  if (numbers.size() != 3)
    value.fail(fmt::format("{}, along x, y and z: got {}", what, numbers.size()), hint);
  Cell cells;
  for (int a = 0; a < 3; ++a)
    cells[a] = static_cast<int32_t>(numbers[static_cast<size_t>(a)].integer(1, most));
  return cells;
}

void read_node(const ConfigTable& node, Arch& arch) {
  if (const auto edge = node.find("cell_edge"))
    arch.cell_edge =
        edge->is_string() && edge->string() == "auto" ? 0 : edge->number(quantity::length, Range::positive());
  set_automatic(node, "capacity", 1, 256, arch.capacity);
  set(node, "filter_lanes", 1, 64, arch.filter_lanes);
  set(node, "force_pipes", 1, 64, arch.force_pipes);
  if (const auto h = node.find("halos"))
    arch.halos = static_cast<Halos>(h->choice("use of halos", {"phases", "arrival"}));
  set(node, "streamers", 1, 2, arch.streamers);
  if (const auto m = node.find("multipliers"))
    arch.multipliers =
        static_cast<Multipliers>(m->choice("use of multipliers", {"parallel", "shared", "serial"}));
  set(node, "queue_depth", 1, 1024, arch.queue_depth);
  arch.overlap = node.boolean_or("overlap", arch.overlap);
  if (const auto brick = node.find("brick"))
    arch.brick = read_cells(*brick, "a brick has three numbers of cells",
                            "such as [2, 2, 2]; in a flat scene [2, 2, 1]", kMostBrickCells);
  if (const auto m = node.find("memories"))
    arch.narrow_memories = m->choice("kind of memories", {"wide", "narrow"}) == 1;
  node.done();
}

void read_boards(const ConfigTable& table, DeviceCut& boards) {
  boards.nodes = read_cells(table.at("nodes"), "a device has three numbers of nodes",
                            "such as [8, 8, 4]; in a flat scene [8, 8, 1]", kMostBoardNodes);
  set(table, "latency", 1, DeviceCut::kMostLatency, boards.latency);
  set(table, "interval", 1, DeviceCut::kMostInterval, boards.interval);
  table.done();
}

void read_widths(const ConfigTable& table, Widths& w) {
  set_automatic(table, "position_frac", 8, 30, w.position_frac);
  set_automatic(table, "guard", 1, 30, w.guard);
  set_automatic(table, "difference_frac", 6, 24, w.difference_frac);
  set_automatic(table, "filter_frac", 2, 16, w.filter_frac);
  set_automatic(table, "velocity_bits", 8, 51, w.velocity_bits);
  set_automatic(table, "relative_velocity_frac", 4, 50, w.relative_velocity_frac);
  set_automatic(table, "relative_velocity_bits", 4, 27, w.relative_velocity_bits);
  set_automatic(table, "strength_bits", 8, 27, w.strength_bits);
  set_automatic(table, "sum_bits", 8, 48, w.sum_bits);
  set_automatic(table, "displacement_bits", 8, 44, w.displacement_bits);
  set_automatic(table, "scale_frac", 4, 16, w.scale_frac);
  set_automatic(table, "gain_frac", 4, 24, w.gain_frac);
  table.done();
}

void read_table(const ConfigTable& table, TableChoice& choice) {
  if (const auto shape = table.find("shape"))
    choice.shape =
        static_cast<TableChoice::Shape>(shape->choice("table shape", {"automatic", "uniform", "octaves"}));
  set(table, "degree", 1, 2, choice.degree);
  set_automatic(table, "index_bits", 2, 16, choice.index_bits);
  set(table, "fraction_bits", 1, 24, choice.fraction_bits);
  table.done();
}

void read_plan(const ConfigTable& table, Carry& carry) {
  const std::vector<std::string> names(Carry::kNames.begin(), Carry::kNames.end());
  if (const auto list = table.find("carry"))
    for (const ConfigValue& name : list->items()) carry[name.choice("part of a plan", names)] = true;
  table.done();
}

Arch arch_of(const ConfigTable& root) {
  Arch arch;
  arch.places = root.places();
  arch.name = read_name(root.at("name"));
  if (const auto node = root.table_at("node")) read_node(*node, arch);
  if (const auto link = root.table_at("link")) {
    if (const auto bits = link->find("bits"))
      arch.link_bits = bits->is_string() && bits->choice("link width", {"record"}) == 0
                           ? 0
                           : static_cast<int>(bits->integer(1, 1024));
    if (const auto check = link->find("check"))
      arch.link_check = static_cast<LinkCheck>(check->choice("link check", {"none", "detect", "retry"}));
    link->done();
  }
  if (const auto boards = root.table_at("boards")) read_boards(*boards, arch.boards);
  if (const auto widths = root.table_at("widths")) read_widths(*widths, arch.widths);
  if (const auto table = root.table_at("table")) read_table(*table, arch.table);
  if (const auto plan = root.table_at("plan")) read_plan(*plan, arch.carry);
  root.done();
  return arch;
}

}  // namespace

Widths automatic_widths() {
  Widths w;
  for (int* bits : {&w.position_frac, &w.guard, &w.difference_frac, &w.velocity_bits,
                    &w.relative_velocity_frac, &w.relative_velocity_bits, &w.filter_frac, &w.strength_bits,
                    &w.sum_bits, &w.displacement_bits, &w.scale_frac, &w.gain_frac})
    *bits = kAutomatic;
  return w;
}

Arch read_arch(const std::string& path) {
  return path.empty() ? Arch() : parse_arch(read_config_text(path), path);
}

Arch parse_arch(const std::string& text, const std::string& path) {
  Arch arch = read_kind(FileKind::arch, text, path, arch_of);
  arch.text = text;
  return arch;
}

}  // namespace cuboct
