// SPDX-License-Identifier: MIT
#include "cli/machine/boards.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "cli/answer.h"
#include "cli/machine/clock_option.h"
#include "cli/machine/machine_cycles.h"
#include "cli/machine/technologies.h"
#include "cli/programs.h"
#include "cli/run/estimate.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/spelling.h"
#include "model/config/config.h"

namespace cuboct {
namespace {

struct BoardsOptions {
  Input input;
  std::string device, links, link = "ecp5-lvds", clock = "100 MHz", write;
  std::optional<uint64_t> nodes;  // of a device
  uint64_t most = UINT64_MAX;
  std::vector<int32_t> box;  // x, y, z: this one alone; empty: what the search finds
  std::optional<uint64_t> steps;
  bool json = false, anyway = false;
};

DeviceLinkKind link_of(const BoardsOptions& options) {
  const std::vector<DeviceLinkKind> kinds = board_links(options.links);
  const auto found = std::ranges::find(kinds, options.link, &DeviceLinkKind::name);
  if (found != kinds.end()) return *found;
  std::vector<std::string> names;
  for (const DeviceLinkKind& kind : kinds) names.push_back(kind.name);
  const std::string near = did_you_mean(options.link, names);
  throw InputError(fmt::format("--link: unknown kind '{}'", options.link),
                   near.empty() ? list_of(names) : near);
}

Plan on_boards(const Plan& plan, const DeviceCut& boards) {
  Arch arch = plan.arch;
  arch.boards = boards;
  return on_machine(plan, std::move(arch));
}

// Mean cycles per step, and the number of steps.
std::pair<double, uint64_t> cycles_of(const Plan& plan, const State& initial, uint64_t steps,
                                      const std::string& label) {
  const auto run = count_run(plan, initial, steps, label);
  if (interrupted()) throw Failed("interrupted");
  if (!run) throw Failed("the first step breaks a width or a capacity", "'cuboct run' tells which");
  return {run->cycles.mean(), run->cycles.steps};
}

CountedPartition count(const Partition& p, const Plan& plan, const State& initial,
                       const BoardsFindings& found, const std::string& label) {
  CountedPartition counted{p, 1, found.one_device, 0, 0};
  if (p.count() == 1) return counted;
  counted.devices = DeviceMap(plan.lattice, plan.bricks, p.boards).devices;
  const auto cycles = [&](int latency, int interval) {
    return cycles_of(on_boards(plan, {p.boards.nodes, latency, interval}), initial, found.steps, label).first;
  };
  counted.cycles = cycles(p.boards.latency, p.boards.interval);
  const double wide = p.boards.interval == 1 ? counted.cycles : cycles(found.link.latency(found.clock, 1), 1);
  counted.by_latency = wide - found.one_device;
  counted.by_interval = counted.cycles - wide;
  return counted;
}

[[noreturn]] void refuse(const BoardsFindings& found) {
  if (found.without_lanes.empty())
    throw InputError(
        fmt::format("a device holds {} nodes: no box of the machine's fits within it", found.room.nodes),
        "a smaller node: fewer lanes and pipes, or a smaller brick");
  const auto nearest = std::ranges::min_element(found.without_lanes, {}, &Partition::lanes);
  const Cell& box = nearest->boards.nodes;
  throw InputError(
      fmt::format(
          "{} has {} lanes on a device, which are not enough: the nearest, {} devices of {} x {} x {} "
          "nodes, needs {} even with a beat every {} cycles",
          found.link.name, found.link.lanes(), nearest->count(), box[0], box[1], box[2], nearest->lanes,
          DeviceCut::kMostInterval),
      "a device that holds more nodes, a narrower link.bits, or another --link");
}

// The box of --box, or what the search finds within the room.
std::vector<Partition> ways_of(const BoardsOptions& options, const BoardsFindings& found, const Plan& plan) {
  if (!options.box.empty()) {
    const Cell box{options.box[0], options.box[1], options.box[2]};
    return {partition_of(plan, found.link, found.clock, box)};
  }
  std::vector<Partition> ways =
      partitions(plan, found.link, found.clock, found.room.nodes,
                 static_cast<double>(plan.particles) / std::max<uint32_t>(plan.lattice.size(), 1));
  const uint64_t fewest = ways.empty() ? 0 : ways.front().count();
  std::erase_if(ways, [&](const Partition& p) { return p.count() > options.most; });
  if (ways.empty() && fewest > 0)
    throw InputError(fmt::format("--most: {} devices have no room for {} nodes, of which each holds {}",
                                 options.most, plan.nodes(), found.room.nodes),
                     fmt::format("--most {}, the fewest that were found", fewest));
  return ways;
}

void check(const BoardsOptions& options) {
  constexpr int32_t kMostSide = 1 << 20;  // of boards.nodes in an arch
  const int given = !options.device.empty() + options.nodes.has_value() + !options.box.empty();
  if (given != 1)
    throw InputError(fmt::format("what a device holds is told {} times", given),
                     "give one of --device NAME, --nodes N, --box X,Y,Z");
  if (options.nodes == uint64_t{0}) throw InputError("--nodes: a device without nodes", "--nodes 64");
  for (const int32_t side : options.box)
    if (side < 1 || side > kMostSide)
      throw InputError(fmt::format("--box: {} is not in [1, {}]", side, kMostSide), "--box 4,4,4");
}

uint64_t nodes_of(const std::vector<int32_t>& box) {
  uint64_t nodes = 1;
  for (const int32_t side : box) nodes *= static_cast<uint64_t>(side);
  return nodes;
}

int boards(const BoardsOptions& options) {
  catch_interrupts();
  check(options);
  if (options.steps == uint64_t{0}) throw InputError("--steps: no step, no cycles", "--steps 20");
  const Loaded loaded = load_machine(options.input);
  const Plan& plan = loaded.setup.plan;
  check_held(loaded.scene, plan, options.anyway);
  if (options.steps) check_counted("--steps", "lattice", loaded.scene, plan, *options.steps, options.anyway);
  check_machine(loaded);
  if (plan.arch.boards.several())
    plan.arch.places.fail({"boards"}, "the machine is on several devices already",
                          "leave out [boards]: this command finds it");
  BoardsFindings found;
  found.scene = options.input.scene;
  found.arch = plan.arch.name;
  found.device = options.device;
  found.link = link_of(options);
  found.clock = clock_of(options.clock);
  found.room = options.nodes          ? DeviceRoom{*options.nodes, ""}
               : !options.box.empty() ? DeviceRoom{nodes_of(options.box), ""}
                                      : device_room(plan, options.device);
  found.nodes = plan.nodes();
  found.particles = plan.particles;
  found.beat_bits = board_beat_bits(plan);
  std::vector<Partition> ways = ways_of(options, found, plan);
  for (const Partition& p : ways)
    if (!enough_lanes(p, found.link)) found.without_lanes.push_back(p);
  std::erase_if(ways, [&](const Partition& p) { return !enough_lanes(p, found.link); });
  if (ways.empty()) refuse(found);
  constexpr uint64_t kSteps = 20, kMostWork = 4'000'000;  // particles times steps, of each count
  const uint64_t affordable = std::max<uint64_t>(1, kMostWork / std::max<uint64_t>(1, plan.particles));
  std::tie(found.one_device, found.steps) =
      cycles_of(plan, loaded.setup.initial, options.steps.value_or(std::min(kSteps, affordable)),
                "cycles of one device");
  for (const Partition& p : ways) {
    const std::string label = fmt::format("cycles of partition {} of {}", found.rows.size() + 1, ways.size());
    found.rows.push_back(count(p, plan, loaded.setup.initial, found, label));
  }
  if (!options.write.empty()) {
    const std::string arch = options.input.arch;
    const std::string text = arch.empty() ? "name = \"default\"\n" : read_config_text(arch);
    write_text(options.write, with_boards(text, arch, found.fastest().partition.boards));
  }
  fmt::print("{}", options.json ? json_of(found) : text_of(found));
  return 0;
}

}  // namespace

const CountedPartition& BoardsFindings::fastest() const {
  return *std::ranges::min_element(
      rows, {}, [](const CountedPartition& row) { return std::pair(row.cycles, row.devices); });
}

void add_boards(Command& app, int& exit_code) {
  auto [command, options] = add_command<BoardsOptions>(app, "boards", exit_code, boards);
  options->input.add_to(command);
  options->input.add_start_to(command);
  command.option("--device", options->device, "FPGA to fill; a node is synthesised for it", "NAME");
  command.option("--nodes", options->nodes, "nodes that a device holds, instead of --device", "N")
      .check(whole_number);
  command.option("--box", options->box, "nodes of a device along x, y and z: this box alone", "X,Y,Z")
      .delimiter(',')
      .length(3);
  command.option("--link", options->link, "kind of link between devices", "KIND").show_default();
  command.option("--links", options->links, "file of kinds; default: the built-in ones", "FILE");
  command.option("--clock", options->clock, "of the machine", "F").show_default();
  command.option("--most", options->most, "devices at the most", "N").check(whole_number);
  command.option("--steps", options->steps, "steps to count; default: 20, fewer if very many particles", "N")
      .check(whole_number);
  command.option("--write", options->write, "writes the arch with [boards] of the fastest", "FILE");
  add_anyway_to(command, options->anyway);
  command.flag("--json", options->json, "print one JSON document instead of lines for people");
}

}  // namespace cuboct
