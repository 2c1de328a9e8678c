// SPDX-License-Identifier: MIT
// Motion and strain that the formats of an engine cannot show: what the watch (model/analysis/watch.h) asks
// at each look. docs/reference/failures.md, "Below resolution", has the reasons.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/analysis/expected_strain.h"
#include "model/analysis/moment.h"
#include "model/scene/scene.h"

namespace cuboct {

class Resolution {
 public:
  // What was found; `text` names the width that is too small and the number that would do.
  struct Lack {
    std::optional<uint32_t> particle;
    Vec3 place = Vec3::Zero();     // m, of the particle
    double number = 0, limit = 0;  // as in Finding
    std::string text;
  };

  // Keeps a reference to `scene`; of its body only what it copies here is needed later.
  explicit Resolution(const Scene& scene);

  // Imposed against achieved motion, and initial velocities. Remembers how far bonds have stretched.
  std::optional<Lack> see(const Moment& moment);
  // In runs that should keep their energy: its `change` since the start, J, against what the bonds would hold
  // if each stretched as far as the scene stretches any. `kinetic`: J, the most so far, about the mean
  // motion.
  std::optional<Lack> see_energy(const Moment& moment, double change, double kinetic);
  // After the last look: strains that stayed below what the formats show, and would to the scene's end.
  std::optional<Lack> conclude();

  // A width, and how long a stretch of a bond it tells apart.
  struct Unit {
    const char* key;  // as in an arch file
    int bits;
    double stretch;  // m
  };
  // Of a rule whose bonds have this length at rest, m, and stiffness, N/m.
  static std::vector<Unit> units(const FixedRule& rule, double rest, double stiffness);

 private:
  struct Led {
    uint8_t type;
    std::vector<uint32_t> ids;
    std::vector<Vec3> start;  // m
  };
  struct Bond {
    uint32_t i, j;
    double length;  // m, at the start
  };

  std::optional<Lack> see_led(const Moment& moment) const;
  std::optional<Lack> see_speed(const FixedRule& rule) const;
  void see_stretch(const Moment& moment);
  void choose_bonds();
  const ExpectedStrain& expected(const std::vector<Vec3>& x);
  std::string remedy(double stretch) const;

  const Scene& scene_;
  std::vector<uint8_t> type_;  // by id
  std::vector<Led> led_;
  double rest_ = 0, stiffness_ = 0;  // m and N/m, of a bond
  double bond_count_ = 0;            // about
  double speed_ = 0;                 // m/s, root mean square of what moves freely at the start
  double vibration_ = 0;             // J, of free particles at the start, where they stretch bonds
  double vibrated_ = 0;              // m, root mean square stretch where bonds hold all of that
  bool loaded_ = false;              // something may strain the body at rest
  bool shown_ = false;               // a bond has stretched by more than a few units, or nothing strains any
  std::vector<Bond> bonds_;          // some
  double stretched_ = 0;             // m, the most of them so far
  std::optional<ExpectedStrain> expected_;
  Widths widths_;
  int value_frac_ = 0;        // of the force table
  std::vector<Unit> units_;   // of an engine of integers
  std::vector<Vec3> latest_;  // m, at the last look at which nothing was shown yet
};

}  // namespace cuboct
