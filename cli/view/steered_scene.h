// SPDX-License-Identifier: MIT
// A run that a page steers: a scene of stages that grows as it runs. The plan of a run, and with it its bits,
// follows from its steps and velocities, so each change ends the stage at hand and begins another.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
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
  // What a mouse takes hold of: particles that are packed within `radius` of one of them go by `way`, in so
  // many steps, and are let go.
  struct Pull {
    uint64_t particle = 0;
    double radius = 0;        // m
    Vec3 way = Vec3::Zero();  // m
    uint64_t steps = 1;
  };

  // `asked`: the scene's file and arch. The copy is DIR/scene.toml. `steps`: 0: the scene's. InputError where
  // the scene has stages or a start, ends by `until`, loads at rest, or names files.
  SteeredScene(Input asked, std::string engine, bool real, std::string directory, uint64_t steps);

  // What holds from the next stage on.
  struct Wanted {
    std::vector<Led> led;
    Vec3 gravity = Vec3::Zero();  // m/s^2
    double damping = 0;           // kg/s
  };
  const Wanted& wanted() const { return wanted_; }
  // InputError where no such stage can be run.
  void set_velocity(size_t which, const Vec3& velocity);
  void set_gravity(const Vec3& gravity);
  void set_damping(double coefficient);
  void pull(const Pull& asked);
  // Whether something waits for the next stage.
  bool has_change() const { return changed_; }

  // Appends the next stage to the file, and is it then; false: all steps are done.
  bool next();
  // The stage at hand did so many of its steps.
  void ended(uint64_t done);
  std::string path() const { return directory_ + "/scene.toml"; }
  std::string stage() const { return "part-" + std::to_string(part_); }
  std::string place() const;                 // the directory of its run
  uint64_t first() const { return first_; }  // its first step, of all
  uint64_t part() const { return part_; }    // from 1 on
  uint64_t steps() const { return steps_; }
  double dt() const { return dt_; }
  double usual_radius() const { return radius_; }  // m, of a pull
  uint64_t usual_steps() const { return std::max<uint64_t>(1, steps_ / 20); }

 private:
  struct Stage {
    Wanted wanted;
    std::optional<Pull> pull;
    uint64_t steps = 0;
  };
  // `done`: where it has ended before.
  std::string text_of(const Stage& stage, uint64_t number, std::optional<uint64_t> done) const;
  void check(const Stage& stage) const;
  void take(Wanted wanted);
  uint64_t left() const { return steps_ - first_; }

  Input asked_;
  std::string engine_;
  bool real_, reduced_ = false, changed_ = false;
  std::string directory_, text_;  // text: of the scene and the stages that ended
  std::vector<Vec3> packing_;
  double radius_ = 0;
  uint64_t steps_, part_ = 0, first_ = 0;
  double dt_ = 0;
  Wanted wanted_, own_;        // own: as the scene has it
  std::string hand_ = "hand";  // the pull's name, which no constraint of the scene has
  std::optional<Pull> pull_;
  Stage now_{};
};

}  // namespace cuboct
