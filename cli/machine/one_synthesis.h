// SPDX-License-Identifier: MIT
// A synthesis of which a command needs the counts alone, with what it says meanwhile.
#pragma once

#include <functional>
#include <string>

#include "cli/machine/tool_lines.h"
#include "synth/fit_measure.h"

namespace cuboct {

// Says before the first tool that a synthesis for `target` takes a while. One that is known says nothing.
synth::Hears hears_of_synthesis(ToolLines& lines, const synth::Target& target);

// Measures what `emit` writes (Meter::measure), and tells what a node takes. `label`: the command. Throws
// Failed where a tool failed, synth::Interrupted.
synth::Measured one_synthesis(const std::string& label, const synth::Target& target,
                              const std::function<void(const std::string& directory)>& emit,
                              synth::Nodes nodes = synth::Nodes::apart);

}  // namespace cuboct
