// SPDX-License-Identifier: MIT
// Studies of a ringing block that take a fraction of a second.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/folder.h"

namespace cuboct::test {

// A directory with the scene, removed at the end.
class SmallStudy {
 public:
  SmallStudy() {
    std::ofstream(path("block.toml")) << R"(density = "1.41 g/cm^3"
[packing]
pitch = "0.5 mm"
offset = "[0.1, 0.1, 0.1] mm"
[box]
cells = [3, 3, 3]
[law]
kind = "elastic"
youngs_modulus = "3 GPa"
direction = [1, 0, 0]
[[velocity]]
thermal_speed = "20 m/s"
seed = 1
[run]
dt = "auto"
steps = 160
)";
    // The same block of a rule of text, in a file beside it: heat flows along what pulls.
    std::filesystem::create_directory(path("texts"));
    std::ofstream(path("texts/warm.toml")) << R"(name = "warm"
reach = "1.2 * pitch"
stiffness = "8 * k"
[parameters]
k = "1e6 N/m"
[particle.T]
unit = "K"
start = "300 K + 1 K/mm * x.x"
range = "[0, 1000] K"
[[round]]
sum.force = "k * (r - pitch) * d / r"
sum.flow = "T_j - T_i"
finish.T = "T + 0.01 * flow"
[energy]
pair = "k / 2 * (r - pitch)^2"
)";
    std::ofstream(path("warm.toml")) << R"(density = "1.41 g/cm^3"
rule = "texts/warm.toml"
[packing]
pitch = "0.5 mm"
offset = "[0.1, 0.1, 0.1] mm"
[box]
cells = [3, 3, 3]
[[velocity]]
thermal_speed = "2 m/s"
seed = 1
[[probe]]
name = "left"
kind = "field"
field = "T"
region = { shape = "half_space", point = "[0.5, 0, 0] mm", normal = "-x" }
[run]
dt = "auto"
steps = 160
)";
  }
  SmallStudy(const SmallStudy&) = delete;
  SmallStudy& operator=(const SmallStudy&) = delete;

  std::string path(const std::string& name) const { return folder_.path(name); }
  // A study of the block, or of another scene; `text` follows the top-level keys.
  std::string study(const std::string& text, const std::string& name = "study.toml",
                    const std::string& scene = "block.toml") const {
    std::ofstream(path(name)) << "scene = \"" << scene << "\"\nsamples = 16\n" << text;
    return path(name);
  }

 private:
  Folder folder_;
};

}  // namespace cuboct::test
