// SPDX-License-Identifier: MIT
// What users of molecular dynamics measure of the frames of a run, as tables: radial distribution, mean
// squared displacement, coordination, common neighbours, stress. docs/user/measure.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/scene/scene.h"

namespace cuboct {

// A state of a run, in SI; the index is the particle's id.
struct Snapshot {
  uint64_t step = 0;
  Body body;
  bool wrapped = false;  // positions stand in the periodic box
  double late = 0;       // s, from the time of the velocities to that of the positions
};

inline constexpr uint64_t kMostBins = 1000000;

struct MeasureChoice {
  std::optional<double> cutoff{};    // m
  std::optional<uint64_t> bins{};    // of rdf
  std::vector<std::string> types{};  // materials: of rdf two or none, else whose particles count; none: all
  std::optional<double> volume{};    // m^3, that densities and stresses are over
  bool com = false;                  // of msd: without the motion of the centre of mass
  bool virial = false;               // of stress: without the kinetic part
  int threads = 0;                   // 0: one per core
  std::string option = "--";         // before the names of options in errors
};

struct MeasuredColumn {
  std::string name, unit;  // "1" of a pure number
  bool whole = false;      // counts
  std::vector<double> values{};
};

// What a measure says of each particle of a frame.
struct MeasuredParticles {
  std::string name, unit;
  std::vector<std::string> components{};  // of a scalar none
  bool whole = false;
  std::vector<double> values{};  // [particle x its numbers]
};

struct Measured {
  std::vector<std::pair<std::string, std::string>> notes;  // how it was measured: name, text
  std::vector<MeasuredColumn> columns;                     // of one length
};

class Measure {
 public:
  virtual ~Measure() = default;
  // Frames of the scene's particles, ascending in step. InputError where this frame cannot be measured.
  virtual void add(const Snapshot& now) = 0;
  virtual Measured result() = 0;
  // Of the frame that was added last; null where the measure has nothing of each.
  virtual const MeasuredParticles* particles() const { return nullptr; }
};

// "rdf", "msd", "coordination", "cna", "stress".
const std::vector<std::string>& measure_names();
// Of which frames, unless somebody says: of rdf the second half, else all.
const char* usual_frames(const std::string& name);

// Keeps a reference to the scene. InputError where there is no such measure, the scene has none of the kind,
// or an option is not the measure's.
std::unique_ptr<Measure> make_measure(const std::string& name, const Scene& scene,
                                      const MeasureChoice& choice);

// Frames by number, of all that are kept: "all", "half" (the second), "last", steps "0,500", or from one step
// to another: "100:", "100:900". InputError where there is no such frame.
std::vector<size_t> chosen_frames(const std::vector<uint64_t>& steps, const std::string& text);

}  // namespace cuboct
