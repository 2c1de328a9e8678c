// SPDX-License-Identifier: MIT
// Where methods fail: detectors that look at a run while it goes, in any engine, and name what went wrong
// with step, place and number. docs/reference/failures.md has a section per failure. The faults of the fixed
// engines (model/base/error.h: a velocity that saturates, a full cell) stop a run by themselves; what stands
// here is what a run survives and is wrong all the same.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/analysis/moment.h"
#include "model/analysis/resolution.h"
#include "model/scene/scene.h"
#include "model/trace/finding.h"

namespace cuboct {

class Watch {
 public:
  // Keeps a reference to `scene`; of its body only what it copies here is needed later.
  // `table_error`: N, the largest error of the force that an engine's table makes.
  // `threads` (0: one per core) look at the particles; no result depends on their number.
  Watch(const Scene& scene, double table_error, int threads = 0);

  void see(const Moment& moment);
  // A state of a fixed engine; `kicks`: summed_kicks of it.
  void see(const FixedRule& rule, const Lattice& lattice, const Vec3& origin, const State& state,
           const std::vector<Int3>& kicks, const Energies& energies, const ClosestPair& closest);
  // A state of the reference in doubles; `force`: Reference::forces(). Finds the closest pair itself.
  void see(uint64_t step, const Body& body, const std::vector<Vec3>& force, const Energies& energies);

  // After the last look: what only a whole run shows.
  void conclude();

  // A run that goes on from a checkpoint: its first energies.
  void remember(const Energies& first) { first_ = first; }

  // The first finding of each failure, in the order in which they came.
  const std::vector<Finding>& findings() const { return findings_; }
  std::optional<uint64_t> last_step() const { return last_step_; }  // that was looked at

 private:
  // How the particles move as a whole, and about that.
  struct Motion {
    Vec3 mean = Vec3::Zero();  // m/s, of the particles that are free along some axis
    double carried = 0;        // J: kinetic energy of that, and of imposed motion
    double flipped = 0;        // of `swing`: where velocities about the mean turned over within the step
    double swing = 0;          // m^2/s^2, sum of (v^2 + v_next^2)/2 about the mean
    bool sudden = false;       // a particle turned over at more than the mean speed
    double fastest = 0;        // m/s, about the mean
  };
  Motion motion_of(const Moment& moment) const;
  bool found(Failure failure) const;
  void find(Failure failure, const Moment& moment, std::optional<uint32_t> particle, double number,
            double limit, const std::string& what);
  void see_flips(const Moment& moment, const Motion& motion);
  // Why a step is held to be too long; `near_limit` asks for a flip of the mode that is found.
  enum class Suspicion : uint8_t { flips, near_limit, energy };
  bool prove_unstable(const Moment& moment, const Motion& motion, Suspicion suspicion);
  void see_energy(const Moment& moment, const Motion& motion);
  void see_core(const Moment& moment, const Motion& motion);
  void see_driven(const Moment& moment);
  void see_rest(const Moment& moment);
  void take(uint64_t step, std::optional<Resolution::Lack> lack);

  const Scene& scene_;
  Resolution resolution_;
  double table_error_;
  int threads_;
  double pull_ = 0, jump_ = 0;  // N, of the law: strongest pull, force at the cutoff
  double energy_limit_ = 0;     // of |change of energy| over the largest thermal energy
  double faint_ = 0;            // J: less is no energy to speak of; bonds strained as far as creep may go
  bool near_limit_ = false;     // dt is more than half of the limit, as far as it is known
  bool keeps_energy_ = false, only_loses_ = false, drives_ = false;
  std::vector<uint8_t> type_;     // by id
  std::vector<uint32_t> driven_;  // ids of imposed and PD-led particles, where some of them move
  std::vector<Vec3> rest_;        // m, where a body at rest stood; empty for others
  std::optional<Energies> first_;
  double first_carried_ = 0, thermal_ = 0;  // J; `thermal_`: the largest kinetic energy about the mean so far
  std::optional<uint64_t> last_step_;
  std::vector<Finding> findings_;
};

// Float32 positions: their spacing at the scene's farthest coordinate, over the pitch (the cutoff without
// packing). A bond at rest feels half a spacing as a force of stiffness * spacing/2.
std::optional<Finding> find_far_origin(const Scene& scene);

}  // namespace cuboct
