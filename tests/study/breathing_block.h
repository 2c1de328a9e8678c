// SPDX-License-Identifier: MIT
#pragma once

namespace cuboct::test {

// A free block of two cells a side that breathes.
inline constexpr const char* kBreathing = R"(# A small block.
density = "1.41 g/cm^3"  # acetal

[packing]
pitch = "0.5 mm"

[box]
cells = [2, 2, 2]

[law]
kind = "elastic"
youngs_modulus = "3 GPa"
direction = [1, 0, 0]

[[velocity]]
region = { shape = "half_space", point = "[0.6, 0, 0] mm", normal = [-1, 0, 0] }
uniform = "[20, 0, 0] m/s"

[[velocity]]
region = { shape = "half_space", point = "[0.6, 0, 0] mm", normal = [1, 0, 0] }
uniform = "[-20, 0, 0] m/s"

[[probe]]
name = "right"
kind = "displacement"
region = { shape = "half_space", point = "[0.6, 0, 0] mm", normal = [-1, 0, 0] }

[run]
dt_safety = 0.2  # a fifth of the limit
duration = "24 us"  # ten breaths
)";

}  // namespace cuboct::test
