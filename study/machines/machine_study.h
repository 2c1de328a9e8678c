// SPDX-License-Identifier: MIT
// A study of machines: grids over the keys of the arch file, the clock, the technology and the device, beside
// those that errors depend on. docs/user/machines.md is the reference of the format.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hw/cost/technology.h"
#include "study/machines/constraint.h"
#include "study/sweep/study.h"

namespace cuboct::study {

// One machine in one technology at one clock, for one scene.
struct MachineChoice {
  size_t scene = 0;       // of MachineStudy::scenes
  Settings settings;      // of the scene and the arch
  double clock = 100e6;   // Hz
  size_t technology = 0;  // of MachineStudy::technologies
  std::string target;     // the FPGA; empty: none

  // What its cycles depend on, on one line.
  std::string machine_key() const;
};

// What the study's files name and the command knows.
struct MachineNames {
  std::function<Technology(const std::string& name)> technology;                     // throws InputError
  std::function<Technology(Technology technology, const std::string& link)> linked;  // throws InputError
  std::vector<std::string> targets;                                                  // FPGAs
};

// The axes of a search, each point a notch on each.
struct MachineSpace {
  std::vector<std::string> names;
  std::vector<size_t> sizes;
  std::vector<std::function<void(MachineChoice&)>> set;  // [axis], of all its notches one after the other
  std::vector<size_t> first;                             // [axis]: of its notches in `set`

  MachineChoice at(const std::vector<size_t>& notches) const;
  double points() const;
};

struct MachineEvolution {
  MachineSpace space;
  int population = 40, generations = 25;
  unsigned seed = 1;
};

struct MachineStudy {
  Study frame;               // base, figures, truth; without points
  std::vector<Base> scenes;  // the first is the frame's
  std::vector<Technology> technologies;
  std::vector<MachineChoice> points;
  std::optional<MachineEvolution> evolution;
  std::vector<MachineConstraint> constraints;
  std::vector<size_t> minimise;  // measures; the first decides
  uint64_t steps = 100;          // that are counted
  uint64_t hash = 0;             // of all that counts depend on but the points

  std::vector<std::string> figure_names() const;
};

// Whether a study file has [[machines]] or [evolve].
bool is_machine_study(const std::string& path);
// Throws InputError with file:line:column.
MachineStudy read_machine_study(const std::string& path, const MachineNames& names);

}  // namespace cuboct::study
