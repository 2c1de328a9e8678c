// SPDX-License-Identifier: MIT
// What a pipeline is made of, counted by hand.
#include "hw/pipeline/resources.h"

#include <gtest/gtest.h>

#include "model/graph/builder.h"

namespace cuboct::test {
namespace {

using graph::Builder;
using graph::Source;

// x y + z: 8 by 8 bits in a multiplier with a register of 16; z waits in one of 8; the sum of 17 bits goes
// out of a register. Two bits say valid.
TEST(PipelineResources, OfAProductAndASum) {
  Builder b;
  const int x = b.input(Source::own_field, 0, 0, {-128, 127}),
            y = b.input(Source::own_field, 1, 0, {-128, 127});
  const int z = b.input(Source::own_field, 2, 0, {-128, 127}), sum = b.mac(z, x, y);
  const graph::Graph graph = b.take();
  const pipeline::Schedule schedule = pipeline::schedule_of(graph, {sum});
  const pipeline::Resources r = pipeline::resources_of(graph, schedule);
  EXPECT_EQ(r.cycles, 2);
  EXPECT_EQ(r.products.size(), 1u);
  EXPECT_EQ(r.adder_bits, 16);  // [-128 127 - 128, 128 128 + 127] has 16 bits
  EXPECT_EQ(r.register_bits, 16 + 8 + 16 + 2);
  EXPECT_EQ(r.choice_bits, 0);
  EXPECT_EQ(r.rom_bits(), 0);
}

// Of a square of 30 bits without a sign the two halves and, once, both: three multipliers. Their sum skips
// the lowest 18 bits, which no other term has.
TEST(PipelineResources, OfASquare) {
  Builder b;
  const int x = b.input(Source::own_field, 0, 0, {0, (1 << 30) - 1}), square = b.mul(x, x);
  const graph::Graph graph = b.take();
  const pipeline::Resources r = pipeline::resources_of(graph, pipeline::schedule_of(graph, {square}));
  EXPECT_EQ(r.products.size(), 3u);
  EXPECT_EQ(r.adder_bits, 60 - 18);
}

// Of a sum of which only bits 4 to 7 go on, four wait. A product by a power of two, and one by 3 bits, takes
// no multiplier.
TEST(PipelineResources, OfWhatIsLookedAtAlone) {
  Builder b;
  const int x = b.input(Source::own_field, 0, 0, {0, 255}), y = b.input(Source::own_field, 1, 0, {0, 7});
  const int part = b.floor(x, 4), product = b.mul(x, y), power = b.mul(x, b.constant(16));
  const graph::Graph graph = b.take();
  const pipeline::Resources of_part = pipeline::resources_of(graph, pipeline::schedule_of(graph, {part}));
  EXPECT_EQ(of_part.cycles, 0);
  EXPECT_EQ(of_part.register_bits, 0);
  const pipeline::Resources r =
      pipeline::resources_of(graph, pipeline::schedule_of(graph, {part, product, power}));
  EXPECT_EQ(r.products.size(), 0u);
  EXPECT_EQ(r.choice_bits, 3 * 8);
}

}  // namespace
}  // namespace cuboct::test
