// SPDX-License-Identifier: MIT
// Prints the preset laws for docs/plot_laws.sh: a block per law, r in pitches and force in stiffness * pitch.
#include <fmt/format.h>

#include "model/contract/law.h"

int main() {
  for (const char* name : {"elastic", "brittle", "ductile", "viscous"}) {
    const auto law = cuboct::preset_law(name, 1, 1);
    fmt::print("# {}\n", name);
    for (int k = 0; k <= 290; ++k) fmt::print("{:.3f} {:.6f}\n", k * 5e-3, law->force(k * 5e-3));
    fmt::print("\n\n");
  }
}
