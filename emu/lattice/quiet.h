// SPDX-License-Identifier: MIT
// Which nodes need work: those in whose neighbourhood something changed in the step before.
//
// A step is a function of a particle and its neighbours. Where neither changed a bit, the step changes
// nothing again, so it need not be taken: exact in integers.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/kernel.h"
#include "emu/lattice/members.h"

namespace cuboct::emu {

class Quiet {
 public:
  Quiet() = default;
  Quiet(const Lattice& lattice, size_t groups);

  // What the next step has to look at; valid until the next call.
  Active next(const Members& members);
  // Nodes at rest in the step that next() began, as far as they were told apart.
  uint64_t quiet_nodes() const { return quiet_nodes_; }

  // Tells of the step that next() began. Needed if Active::track was set.
  void changed(uint32_t node) {
    if (changed_flag_[node] != 0) return;
    changed_flag_[node] = 1;
    changed_.push_back(node);
  }
  // Particles changed their places in storage.
  void regroup(size_t groups);

 private:
  void forget();
  void dilate(std::vector<uint32_t>& nodes, std::vector<uint8_t>& flag) const;

  const Lattice* lattice_ = nullptr;
  bool told_ = false;  // the changes of the step before are known
  int pause_ = 0;      // steps for which nothing is told apart
  uint64_t quiet_nodes_ = 0;
  std::vector<uint32_t> changed_, awake_, near_, groups_;
  std::vector<uint8_t> changed_flag_;  // by node
  std::vector<uint8_t> awake_flag_;    // by node: it or a neighbour changed
  std::vector<uint8_t> near_flag_;     // by node: awake or beside one that is
  std::vector<uint8_t> group_flag_;    // by group: holds a particle of a near node
};

}  // namespace cuboct::emu
