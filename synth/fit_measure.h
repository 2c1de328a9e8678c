// SPDX-License-Identifier: MIT
// What an emitted project takes on a device: all of it, its nodes synthesised once and counted.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "synth/input_key.h"
#include "synth/kept_files.h"
#include "synth/target.h"
#include "synth/tool.h"

namespace cuboct::synth {

// `apart`: nodes as one module, which is synthesised once. Its border stays, so where links have no neighbour
// what they lead to is counted too. `flat`: the whole as it is built, told as one node with nothing around
// it.
enum class Nodes { apart, flat };

struct Measured {
  Counts node;    // one
  Counts around;  // the rest of the lattice, or of the board
  uint64_t nodes = 0;
  bool kept = false;  // from the cache
};

class Meter {
 public:
  // `hears` of each tool as Runner's. Throws InputError where a tool is missing.
  Meter(const Target& target, Hears hears);

  // `emit` writes a project into the directory that it is given; `board`: with board/. Results are kept in
  // the user's cache directory, by the text of the RTL, the script and the versions of the tools. On ice40 a
  // node's logic cells are those that nextpnr packs. Throws what `emit` throws, ToolFailed (whose log is
  // gone), Interrupted.
  Measured measure(const std::function<void(const std::string& directory)>& emit, bool board,
                   Nodes nodes = Nodes::apart) const;

  const std::vector<std::string>& tools() const { return tools_; }  // versions
  const std::string& kept() const { return kept_.directory(); }     // where results are kept, or empty

 private:
  Measured run(const std::string& directory, bool board, Nodes nodes) const;
  InputKey key_of(const std::string& directory, bool board, Nodes nodes) const;

  const Target& target_;
  Hears hears_;
  std::vector<std::string> tools_;
  KeptFiles kept_;
};

}  // namespace cuboct::synth
