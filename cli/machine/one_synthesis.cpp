// SPDX-License-Identifier: MIT
#include "cli/machine/one_synthesis.h"

#include <fmt/format.h>

#include "cli/answer.h"
#include "model/base/clock.h"

namespace cuboct {

synth::Hears hears_of_synthesis(ToolLines& lines, const synth::Target& target) {
  return [&lines, name = target.name](const std::string& what, int seconds) {
    lines.announce(fmt::format("a synthesis for {}: seconds for small nodes, minutes for large ones", name));
    lines.says()(fmt::format("{}, {} s", what, seconds));
  };
}

synth::Measured one_synthesis(const std::string& label, const synth::Target& target,
                              const std::function<void(const std::string& directory)>& emit,
                              synth::Nodes nodes) {
  ToolLines lines(label);
  const auto begin = Clock::now();
  try {
    const synth::Measured m =
        synth::Meter(target, hears_of_synthesis(lines, target)).measure(emit, false, nodes);
    if (m.kept) return m;
    std::string takes;
    for (const synth::Resource r : synth::resources_of(target.family))
      if (m.node[r] > 0) takes += fmt::format(", {} {}", synth::to_string(r), m.node[r]);
    lines.tells()(fmt::format("{:.0f} s, {}{}", seconds_since(begin),
                              nodes == synth::Nodes::flat ? "the node" : "each node", takes));
    return m;
  } catch (const synth::ToolFailed& error) {
    throw Failed(error.what());
  }
}

}  // namespace cuboct
