// SPDX-License-Identifier: MIT
// emit_case NAME DIR [STEPS]: emits the project of a test case (tests/support/cases.h; random_<seed>,
// random_flat_<seed> and random_brick_<seed> are random ones, `example` the committed one, `rule` a rule of
// text, `bonds` one of bonds). Behind a name ".narrow": with narrow memories; ".arrival": with halos on
// arrival. emit_case --kinds prints names that between them have every kind of node.
#include <cstdio>
#include <string>

#include "hw/rtl/rtl_emit.h"
#include "tests/backend/bond_cases.h"
#include "tests/backend/rule_cases.h"
#include "tests/support/block.h"
#include "tests/support/cases.h"

namespace {

// Small enough to read: two nodes, a table of 16 entries.
cuboct::test::Case example() {
  using namespace cuboct;
  Scene scene = test::block_scene({.size = {2, 1, 1}, .jitter = 0.05, .speed = 0.1, .margin = 0});
  Arch arch;
  arch.capacity = 8;
  arch.filter_lanes = 4;
  arch.queue_depth = 4;
  arch.table = {.shape = TableChoice::Shape::uniform, .degree = 1, .index_bits = 4};
  return {"example", make_setup(scene, arch), 2};
}

// Two rounds, the second of which reads what the first wrote of the other particle.
cuboct::test::Case rule() {
  return cuboct::test::case_of(
      "rule",
      "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nreach = { margin = \"0 mm\" }\n"
      "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[2, 1, 1] mm\" }\n"
      "run = { dt = \"0.2 us\", steps = 9 }\n"
      "velocity = [ { thermal_speed = \"30 m/s\", seed = 3 } ]\n[rule]\n" +
          cuboct::test::kTwoRounds,
      {}, 3);
}

// Four particles with bonds that break.
cuboct::test::Case bonds() {
  using namespace cuboct::test;
  return BondedCase(of_four(kSprings), {cuboct::Vec3(2000, 0, 0), 20, 0.02}, {}, 1).c;
}

bool take_end(std::string& name, const std::string& end) {
  if (!name.ends_with(end)) return false;
  name.erase(name.size() - end.size());
  return true;
}

cuboct::test::Case case_of(std::string name) {
  using namespace cuboct::test;
  if (take_end(name, ".narrow")) return with_narrow_memories(case_of(name));
  if (take_end(name, ".arrival")) return with_halos_on_arrival(case_of(name));
  if (name == "example") return example();
  if (name == "rule") return rule();
  if (name == "bonds") return bonds();
  const auto seeded = [&](const std::string& start) { return std::stoull(name.substr(start.size())); };
  if (name.starts_with("random_flat_")) return random_flat_case(seeded("random_flat_"));
  if (name.starts_with("random_brick_")) return random_brick_case(seeded("random_brick_"));
  if (name.starts_with("random_")) return random_case(seeded("random_"));
  return make_case(name);
}

// Every case with each kind of memories, halos and links that it can have, and with a brick; then drawn ones.
void print_kinds() {
  using namespace cuboct::test;
  constexpr int kDrawn = 6;
  for (const char* kind : {".snug.narrow", ".snug.arrival", ".snug", ".retry"})
    for (const std::string& name : case_names()) std::printf("%s%s\n", name.c_str(), kind);
  for (const std::string& name : case_names()) {
    const std::vector<cuboct::Cell> bricks = bricks_for(make_case(name + ".snug").setup.plan.lattice);
    if (bricks.empty()) continue;
    const cuboct::Cell& brick = bricks.back();
    std::printf("%s.snug.brick_%dx%dx%d\n", name.c_str(), brick[0], brick[1], brick[2]);
  }
  for (int seed = 1; seed <= kDrawn; ++seed)
    std::printf("random_%d\nrandom_flat_%d\nrandom_brick_%d\nrandom_%d.narrow\n", seed, seed, seed, seed);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace cuboct;
  if (argc == 2 && std::string(argv[1]) == "--kinds") {
    print_kinds();
    return 0;
  }
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: emit_case NAME DIR [STEPS] | --kinds\n");
    return 2;
  }
  try {
    const test::Case c = case_of(argv[1]);
    emit_rtl(c.setup.plan, c.setup.initial, argv[2],
             {.vector_steps = argc == 4 ? std::stoull(argv[3]) : c.steps});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "emit_case: %s\n", e.what());
    return 1;
  }
  return 0;
}
