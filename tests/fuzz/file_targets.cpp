// SPDX-License-Identifier: MIT
// Files of other programs: potentials, particles, meshes.
#include <optional>
#include <string>

#include "model/atoms/bond_order/tersoff_parameters.h"
#include "model/atoms/multiscale/mesh_file.h"
#include "model/body/mesh.h"
#include "model/body/particle_file.h"
#include "model/mesh/stated_unit.h"
#include "model/program/potential_file.h"
#include "tests/fuzz/targets.h"

namespace cuboct {

extern "C" ReadMesh cuboct_read_mesh;

namespace fuzz {

void take_potential(Bytes input) {
  const std::string path = file_of(input, "fuzzed.eam.alloy");
  refusing([&] { read_embedded_atoms(path, {}, true); });
  refusing([&] { read_embedded_atoms(path, {"Cu"}, false); });
  refusing([&] { read_tersoff(path, {"Si"}); });
}

void take_particles(Bytes input) {
  for (const std::string name : {"fuzzed.xyz", "fuzzed.data"}) {
    const std::string path = file_of(input, name);
    for (const std::optional<uint64_t> frame : {std::optional<uint64_t>(), std::optional<uint64_t>(1)})
      refusing([&] {
        try {
          read_particle_file(path, {.frame = frame, .box = true, .atom_style = {}});
        } catch (const NoSuchFrame&) {
        } catch (const UnknownAtomStyle&) {
        }
      });
  }
}

void take_mesh(Bytes input) {
  const std::string path = file_of(input, "fuzzed.msh");
  refusing([&] { read_gmsh(path, 1e-3, {false, true, false}); });
  const std::string text = text_of(input);
  attribute(text, "model", "unit", "millimeter");
  attribute(text, "up_axis", "", "");
  // What the program that reads meshes leaves.
  Mesh mesh;
  std::string error;
  cuboct_read_mesh(path, 1e-3, mesh, error);
  if (mesh.shape == nullptr) return;
  mesh_text(mesh.facts);
  mesh_warning(mesh.facts);
}

}  // namespace fuzz
}  // namespace cuboct
