// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/machine/boards.h"
#include "model/base/json.h"
#include "model/base/quantity_text.h"
#include "model/base/text.h"
#include "model/config/changes.h"

namespace cuboct {
namespace {

std::string box_text(const Cell& c) { return fmt::format("{}x{}x{}", c[0], c[1], c[2]); }

// What costs most of the cycles.
const char* binds(const CountedPartition& row, double one_device) {
  if (row.by_interval > one_device && row.by_interval >= row.by_latency) return "serialisation";
  return row.by_latency > one_device ? "latency" : "nodes";
}

std::string row_text(const CountedPartition& row, const BoardsFindings& found) {
  const Partition& p = row.partition;
  return fmt::format(
      "  {:>7} {:>10} {:>10} {:>14} {:>11} {:>9} {:>8} {:>12.1f} {:>10.1f} {:>10.1f} {:>12.4g}  {}\n",
      row.devices, box_text(p.devices), box_text(p.boards.nodes),
      fmt::format("{}/{}/{}", p.links[0], p.links[1], p.links[2]),
      fmt::format("{}/{}", p.lanes, found.link.lanes()),
      p.count() > 1 ? std::to_string(p.boards.interval) : "-",
      p.count() > 1 ? std::to_string(p.boards.latency) : "-", row.cycles, row.by_latency, row.by_interval,
      found.clock / row.cycles, binds(row, found.one_device));
}

std::string figures_text(const DeviceLinkKind& link) {
  std::string out;
  for (size_t k = 0; k < kLinkFigures; ++k) {
    const auto figure = static_cast<LinkFigure>(k);
    const char* unit = unit_of(figure);
    out += fmt::format("  {:<11} {:>9g} {:<7} {}\n", name_of(figure), link.figures[k].value,
                       std::string(unit) == "1" ? "" : unit, line_text(link.figures[k].source));
  }
  return out;
}

std::string cell_json(const Cell& c) { return fmt::format("[{}, {}, {}]", c[0], c[1], c[2]); }

std::string row_json(const CountedPartition& row, const BoardsFindings& found) {
  const Partition& p = row.partition;
  return json_object(
      {{"devices", std::to_string(row.devices)},
       {"grid", cell_json(p.devices)},
       {"nodes", cell_json(p.boards.nodes)},
       {"links", cell_json(p.links)},
       {"lanes", std::to_string(p.lanes)},
       {"pins", std::to_string(p.lanes * static_cast<uint64_t>(found.link.of(LinkFigure::pins)))},
       {"interval", std::to_string(p.boards.interval)},
       {"latency", std::to_string(p.boards.latency)},
       {"cycles_per_step", json(row.cycles)},
       {"by_latency", json(row.by_latency)},
       {"by_interval", json(row.by_interval)},
       {"steps_per_second", json(found.clock / row.cycles)},
       {"binds", json(std::string(binds(row, found.one_device)))}});
}

}  // namespace

std::string with_boards(const std::string& arch, const std::string& path, const DeviceCut& boards) {
  return with_changes(arch, path,
                      {{"boards.nodes", cell_json(boards.nodes)},
                       {"boards.latency", std::to_string(boards.latency)},
                       {"boards.interval", std::to_string(boards.interval)}});
}

std::string text_of(const BoardsFindings& found) {
  std::string out =
      fmt::format("{}: {} nodes of {}, {} particles, {} steps counted\n", line_text(found.scene), found.nodes,
                  line_text(found.arch), found.particles, found.steps);
  out += fmt::format("clock   {:g} MHz\n", found.clock * 1e-6);
  out += fmt::format("device  {} nodes", found.room.nodes);
  if (!found.device.empty()) out += fmt::format(" on {} ({})", found.device, found.room.why);
  out += fmt::format("\nlink    {}: {:.4g} bits per lane and cycle; a beat has {} bits\n",
                     line_text(found.link.name), found.link.bits_per_cycle(found.clock), found.beat_bits);
  out += figures_text(found.link);
  out += fmt::format("one device with all nodes: {:.1f} cycles per step, {:.4g} steps/s\n", found.one_device,
                     found.clock / found.one_device);
  out += fmt::format("  {:>7} {:>10} {:>10} {:>14} {:>11} {:>9} {:>8} {:>12} {:>10} {:>10} {:>12}  {}\n",
                     "devices", "grid", "nodes", "links x/y/z", "lanes", "interval", "latency", "cycles/step",
                     "latency", "serial", "steps/s", "binds");
  for (const CountedPartition& row : found.rows) out += row_text(row, found);
  for (const Partition& p : found.without_lanes)
    out += fmt::format("  {:>7} {:>10} {:>10}  not enough lanes: {} of {}\n", p.count(), box_text(p.devices),
                       box_text(p.boards.nodes), p.lanes, found.link.lanes());
  return out;
}

std::string json_of(const BoardsFindings& found) {
  std::vector<std::string> rows, figures;
  for (const CountedPartition& row : found.rows) rows.push_back(row_json(row, found));
  for (size_t k = 0; k < kLinkFigures; ++k)
    figures.push_back(json_object({{"name", json(std::string(name_of(static_cast<LinkFigure>(k))))},
                                   {"value", json(found.link.figures[k].value)},
                                   {"unit", json(std::string(unit_of(static_cast<LinkFigure>(k))))},
                                   {"source", json(found.link.figures[k].source)}}));
  return json_object({{"scene", json(found.scene)},
                      {"arch", json(found.arch)},
                      {"nodes", std::to_string(found.nodes)},
                      {"particles", std::to_string(found.particles)},
                      {"steps", std::to_string(found.steps)},
                      {"clock", json(found.clock)},
                      {"device", json(found.device)},
                      {"device_nodes", std::to_string(found.room.nodes)},
                      {"link", json_object({{"name", json(found.link.name)},
                                            {"beat_bits", std::to_string(found.beat_bits)},
                                            {"figures", json_array(figures)}})},
                      {"one_device_cycles_per_step", json(found.one_device)},
                      {"partitions", json_array(rows)}}) +
         "\n";
}

}  // namespace cuboct
