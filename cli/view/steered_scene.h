// SPDX-License-Identifier: MIT
// A run whose imposed velocities change on the way: a scene of stages that grows as it runs. The plan of a
// run, and with it its bits, follows from its steps and velocities, so a change waits for the next stage.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/command.h"

namespace cuboct {

class SteeredScene {
 public:
  // Of a constraint that is moved.
  struct Led {
    std::string name;
    Vec3 velocity;  // m/s, from the next stage on
  };

  // `asked`: the scene's file and arch. The copy is DIR/scene.toml. `steps`: 0: the scene's. InputError where
  // the scene has stages or a start, ends by `until`, loads at rest, moves nothing, or names files.
  SteeredScene(Input asked, std::string engine, bool real, std::string directory, uint64_t steps,
               uint64_t parts);

  const std::vector<Led>& led() const { return led_; }
  // From the next stage on. InputError where no such stage can be run.
  void set(size_t which, const Vec3& velocity);

  // Appends the next stage to the file, and is it then; false: all steps are done.
  bool next();
  std::string path() const { return directory_ + "/scene.toml"; }
  std::string stage() const { return "part-" + std::to_string(part_); }
  std::string place() const;                 // the directory of its run
  uint64_t first() const { return first_; }  // its first step, of all
  uint64_t part() const { return part_; }    // from 1 on
  uint64_t parts() const { return (steps_ + each_ - 1) / each_; }
  uint64_t steps() const { return steps_; }
  uint64_t next_first() const;  // of the stage after it
  double dt() const { return dt_; }

 private:
  std::string stage_text(const std::vector<Led>& led, uint64_t number, uint64_t steps) const;

  Input asked_;
  std::string engine_;
  bool real_, reduced_ = false;
  std::string directory_, text_;
  uint64_t steps_, each_ = 1, part_ = 0, first_ = 0;
  double dt_ = 0;
  std::vector<Led> led_, own_;  // own: as the scene has them
};

}  // namespace cuboct
