// SPDX-License-Identifier: MIT
#include "cli/study/machine_devices.h"

#include <algorithm>

#include "cli/answer.h"
#include "cli/machine/one_synthesis.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/process.h"
#include "synth/node_estimate.h"

namespace cuboct {
namespace {

using study::DeviceUse;
using study::Known;
using study::MachineValue;

DeviceUse use_of(const synth::NodeEstimate& node, double nodes, const synth::Target& target, Known known) {
  const auto all = [&](const Band& of_one) { return MachineValue{nodes * of_one, known, false}; };
  return {all(node.lut),
          all(node.ff),
          all(node.dsp),
          all(node.bram),
          {share_of_room(node, nodes, target), known, false}};
}

}  // namespace

std::vector<std::string> fpga_names() {
  std::vector<std::string> names;
  for (const synth::Target& target : synth::targets())
    if (target.family != synth::Family::asic) names.push_back(target.name);
  return names;
}

DeviceUse estimated_use(const Plan& plan, const std::string& target) {
  const synth::Target& device = synth::target_of(target);
  const auto node = synth::estimate_node(plan, device);
  return node ? use_of(*node, plan.nodes(), device, Known::estimated) : DeviceUse();
}

bool can_synthesise() { return in_path("yosys"); }

// What stands around the nodes is counted with them: all of it is told as one node.
DeviceUse synthesised_use(const Setup& setup, const std::string& target) {
  const synth::Target& device = synth::target_of(target);
  try {
    const synth::Measured m = one_synthesis(
        "explore", device,
        [&](const std::string& directory) { emit_rtl(setup.plan, setup.initial, directory); },
        setup.plan.nodes() == 1 ? synth::Nodes::flat : synth::Nodes::apart);
    const auto all = [&](synth::Resource r) {
      const double count =
          static_cast<double>(m.node[r]) * static_cast<double>(m.nodes) + static_cast<double>(m.around[r]);
      return Band{count, count};
    };
    const synth::NodeEstimate whole{all(synth::Resource::lut), all(synth::Resource::ff),
                                    all(synth::Resource::dsp), all(synth::Resource::bram)};
    DeviceUse use = use_of(whole, 1, device, Known::measured);
    const auto cells = all(synth::Resource::cell);
    if (device.family == synth::Family::ice40) {
      const double share = cells.low / static_cast<double>(device.holds[synth::Resource::lut]);
      use.share.band = {std::max(use.share.band.low, share), std::max(use.share.band.high, share)};
    }
    return use;
  } catch (const synth::Interrupted&) {
    throw Failed("interrupted; the same command goes on where it was");
  }
}

}  // namespace cuboct
