// SPDX-License-Identifier: MIT
// The C++ library of cuboct: a scene in an engine that is stepped from a program of yours, as `cuboct run`
// and Python step it, to the same bits. This header needs C++17 and the standard library alone.
//
//   find_package(cuboct REQUIRED)
//   target_link_libraries(program PRIVATE cuboct::cuboct)
//
// Quantities are in SI: m, m/s, kg, s, J, N, Pa; of scenes in reduced units, in those. The index of a vector
// is the particle's id, the same at every step and in every engine. What is wrong is thrown as an Error.
// Scenes: docs/user/scene.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#define CUBOCT_EXPORT __attribute__((visibility("default")))

namespace cuboct {

// What cuboct refuses, or cannot go on with. what() is what the command prints: file, line, column, the line
// itself, and a hint, on lines of their own where they are known.
class CUBOCT_EXPORT Error : public std::runtime_error {
 public:
  Error(const std::string& told, std::string message, std::string hint)
      : std::runtime_error(told), message(std::move(message)), hint(std::move(hint)) {}
  ~Error() override;
  std::string message, hint;  // without the place; an empty hint: there is none
};

// The input is wrong: a scene, a machine description, an argument.
class CUBOCT_EXPORT InputRefused : public Error {
 public:
  using Error::Error;
  ~InputRefused() override;
  std::string file;          // empty: no place is known
  int line = 0, column = 0;  // counted from 1; 0: no place is known
};

// A step cannot be done: a number left its width, a cell was full, a particle left the lattice.
class CUBOCT_EXPORT RunStopped : public Error {
 public:
  using Error::Error;
  ~RunStopped() override;
  uint64_t step = 0;  // the last step that was done
};

struct Options {
  std::string engine;  // "lattice", "golden", "reference", "systemc", "rtl", "gpu" or "fpga"; empty: the one
                       // that the scene asks for
  std::string arch;    // file of a machine description; empty: the default machine
  std::string stage;   // of a scene of stages; empty: the first
  std::string
      from;  // directory of `cuboct run --out` or of Simulation::leave, whose last state it begins with
  std::string
      precision;    // "fixed", "float" or "double", of the engines that have several; empty: the engine's own
  int threads = 0;  // of lattice, systemc, rtl and reference, 1 to 4096; 0: as many as suit the scene
  std::optional<uint64_t>
      probe_every;      // steps between two readings of probes and energies; 0: none; without: the scene's
  bool anyway = false;  // though the run needs more memory than is free
};

// A scene that is no file. Its errors name it `name`, and the files that it names lie beside that path.
struct SceneText {
  std::string toml, name = "scene";
};

// A scene in an engine. Any thread may call any function: one waits for the other. What one call returns is a
// copy.
class CUBOCT_EXPORT Simulation {
 public:
  explicit Simulation(const std::string& scene_file, const Options& options = {});
  explicit Simulation(const SceneText& scene, const Options& options = {});
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  // Goes so many steps further. Throws RunStopped where one cannot be done; the state before it stands.
  void step(uint64_t steps = 1);
  // Goes to the scene's last step, or to where its `until` holds.
  void run();

  uint64_t steps() const;                                              // done
  double dt() const;                                                   // s
  double time() const { return static_cast<double>(steps()) * dt(); }  // s
  uint64_t particles() const;                                          // their number
  std::string engine() const;                                          // its name
  std::string title() const;                                           // of the scene
  std::vector<std::string> type_names() const;                         // "material" or "material/constraint"
  std::vector<double> type_masses() const;                             // kg, of a particle of each type

  std::vector<std::array<double, 3>> positions() const;   // m; the fixed rule wraps them into a periodic box
  std::vector<std::array<double, 3>> velocities() const;  // m/s, half a step before the positions (leapfrog)
  std::vector<uint8_t> types() const;                     // index of type_names()

  // Of the state of an engine with the fixed rule: equal hashes are equal bits, in any engine, on any
  // threads. Nothing in real numbers.
  std::optional<uint64_t> hash() const;
  // Of the rule in integers, the lattice and the machine.
  uint64_t plan_hash() const;

  struct Energies {
    double kinetic, potential, gravity, total;  // J
    std::optional<double> temperature;          // K; in reduced units J; of a scene that has one
  };
  Energies energies() const;

  // What a probe, or the meter of energies, has read so far.
  struct Curve {
    std::string name;             // "tension.stress"
    std::string unit;             // "Pa"
    std::vector<uint64_t> steps;  // at which it was read, rising
    std::vector<double> values;   // of the same length, in the unit
  };
  std::vector<Curve> curves() const;
  // The one of that name. Throws InputRefused with the nearest spelling where there is none.
  Curve curve(const std::string& name) const;

  // What the scene's [rule] shows of its particles, by name: one number each, or three of a vector, particle
  // by particle.
  std::vector<std::pair<std::string, std::vector<double>>> fields() const;

  // m/s, of all particles that the scene's constraint of that name holds or moves, from the next step on.
  void set_velocity(const std::string& constraint, const std::array<double, 3>& velocity);
  // m/s^2, from the next step on.
  void set_gravity(const std::array<double, 3>& gravity);

  // Leaves the present state in a directory, where `cuboct run --from` or Options::from goes on with the same
  // bits.
  void leave(const std::string& directory) const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

struct Crosscheck {
  bool matched = false;
  std::string text;              // "matched U updates over S steps in K engines", or the first difference
  uint64_t updates = 0;          // of particles that were found equal
  uint64_t steps = 0;            // compared
  std::optional<uint64_t> step;  // of the first difference
};
// Runs a scene in several engines and compares every bit after every step. `steps`: without, the scene's.
CUBOCT_EXPORT Crosscheck crosscheck(const std::string& scene_file, const std::vector<std::string>& engines,
                                    std::optional<uint64_t> steps = {}, const Options& options = {});

// Where the programs of engines are that run in a process of their own, such as cuboct-systemc. At first:
// those that were installed with this library.
CUBOCT_EXPORT void look_for_programs_in(const std::string& directory);

CUBOCT_EXPORT std::string version();  // "0.1.0"

}  // namespace cuboct
