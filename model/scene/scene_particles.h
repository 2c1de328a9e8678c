// SPDX-License-Identifier: MIT
// The table [particles] of a scene: particles from a file, in SI units.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "model/body/particle_file.h"
#include "model/scene/scene_parts.h"

namespace cuboct {

struct FileParticles {
  ConfigTable table;
  ParticleFile file;  // lengths and velocities in SI units; momenta and masses as in the file
  ParticleUnits units;
  std::vector<int> material;  // by kind of the file; empty: regions say it

  int material_of(size_t i) const {
    return material.empty() || file.kind.empty() ? -1 : material[file.kind[i]];
  }
};

// Absent where the scene has no such table. `packed`: a packing or a crystal is there, and the file's box
// does not count. `materials`: the scene's names.
std::optional<FileParticles> read_file_particles(const ConfigTable& root, bool packed,
                                                 const std::vector<std::string>& materials);

// That `size` of [box], whose axes `periodic` repeat, is the file's to a millionth.
void check_box_size(const ConfigValue& size, const ParticleFileBox& box, const Vec3& extent,
                    const std::array<bool, 3>& periodic);

// Adds them to scene.body: into the box that the file brings, along the axes of it that repeat; in any other
// box they must be. Velocities that are momenta in the file are 0 until take_momenta.
void place_file_particles(const FileParticles& of, Scene& scene);

// `material`: by particle of the scene, the file's from `first` on.
void take_momenta(const FileParticles& of, const std::vector<int>& material, size_t first, Scene& scene);
// That the masses of the file are the scene's, to 1 %, where their unit is known.
void check_file_masses(const FileParticles& of, const std::vector<int>& material, size_t first,
                       const Scene& scene, const std::vector<std::string>& names);

}  // namespace cuboct
