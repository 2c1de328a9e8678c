// SPDX-License-Identifier: MIT
#include "tests/verify/small_case.h"

#include <stdexcept>

#include "tests/support/block.h"

namespace cuboct::test {

Case small_case(const std::string& name) {
  Features f{.size = {2, 1, 1}, .cutoff = 1.4, .jitter = 0.05, .speed = 0.3, .margin = 0};
  Arch arch;
  arch.capacity = 7;
  arch.filter_lanes = 2;
  arch.queue_depth = 2;
  arch.link_bits = 13;
  Widths& w = arch.widths;
  w.position_frac = 12, w.guard = 4, w.difference_frac = 9;
  w.velocity_bits = 17, w.relative_velocity_frac = 12, w.relative_velocity_bits = 12;
  w.strength_bits = 12, w.sum_bits = 17, w.displacement_bits = 18;
  w.scale_frac = 8;
  arch.table = {.shape = TableChoice::Shape::uniform, .degree = 1, .index_bits = 5};
  Case c{"small_" + name, {}, 6};
  if (name == "damped") {
    f.damping = 0.2;
    f.two_materials = f.held = true;
    arch.force_pipes = 2;
  } else if (name == "pd") {
    f.force_held = true;
    arch.overlap = false;
    arch.table.degree = 2;
  } else if (name == "flat") {
    f.flat = true;
    f.size = {2, 2, 1};
  } else if (name != "plain") {
    throw std::out_of_range("no small case " + name);
  }
  c.scene = block_scene(f);
  c.setup = make_setup(c.scene, arch);
  return c;
}

}  // namespace cuboct::test
