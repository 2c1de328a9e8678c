// SPDX-License-Identifier: MIT
// Frames as the page of a run reads them.
#include "model/trace/view_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/dice.h"

namespace cuboct {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename T>
std::vector<T> numbers_of(const std::string& block) {
  std::vector<T> numbers(block.size() / sizeof(T));
  std::memcpy(numbers.data(), block.data(), numbers.size() * sizeof(T));
  return numbers;
}

Scene small_scene() {
  Scene scene;
  scene.title = "two </script> words";
  scene.rule.dt = 1e-6;
  return scene;
}

TraceHead head_of_scene(const Scene& scene, const FixedRule* rule = nullptr,
                        const Lattice* lattice = nullptr) {
  return {scene, rule, lattice, Vec3::Zero(), "", false, true};
}

FrameStyle style_of_two_types() {
  FrameStyle style;
  style.radius = 1e-3;
  style.types = {frame_type("gel", 1e-6), frame_type("steel/grip", 2e-6)};
  style.own = {{"heat", "J", {}}};
  return style;
}

Frame random_frame(size_t count) {
  test::Dice dice(5);
  Frame frame{40, 4e-5, {}, {}, {}};
  const auto some = [&] { return 1e-3 * dice.draw(-1000000, 1000000); };
  for (size_t k = 0; k < count; ++k) {
    frame.x.emplace_back(some(), 1e-9 * some(), 7.0);
    frame.v.emplace_back(some(), some(), some());
    frame.type.push_back(static_cast<uint8_t>(dice.draw(0, 1)));
  }
  return frame;
}

TEST(ViewFrame, PlacesAreThoseOfTheFrameToHalfAStep) {
  const Scene scene = small_scene();
  const TraceHead head = head_of_scene(scene);
  const ViewFrames form(head, style_of_two_types(), 500, 500);
  Frame frame = random_frame(500);
  frame.x[17] = Vec3(0, kNan, 0);
  const ViewFrame made = form.make(frame, nullptr);
  EXPECT_EQ(made.extent[2], 0);  // flat: all are at its lower side
  const auto places = numbers_of<uint16_t>(made.blocks[ViewFrames::kPlaces]);
  ASSERT_EQ(places.size(), 1500U);
  for (size_t k = 0; k < 500; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const uint16_t place = places[3 * k + static_cast<size_t>(axis)];
      if (k == 17) {
        EXPECT_EQ(place, 65535);
        continue;
      }
      ASSERT_LE(place, 65534);
      EXPECT_NEAR(made.lower[axis] + place / 65534.0 * made.extent[axis], frame.x[k][axis],
                  0.5001 * made.extent[axis] / 65534);
    }
}

TEST(ViewFrame, ExactNumbersAreDoublesOfARunInRealNumbers) {
  const Scene scene = small_scene();
  const TraceHead head = head_of_scene(scene);
  const ViewFrames form(head, style_of_two_types(), 30, 30);
  const Frame frame = random_frame(30);
  const ViewFrame made = form.make(frame, nullptr);
  EXPECT_EQ(form.blocks()[ViewFrames::kExact].row(), 48U);
  const auto exact = numbers_of<double>(made.blocks[ViewFrames::kExact]);
  ASSERT_EQ(exact.size(), 180U);
  for (size_t k = 0; k < 30; ++k)
    for (size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(exact[6 * k + axis], frame.x[k][static_cast<int>(axis)]);
      EXPECT_EQ(exact[6 * k + 3 + axis], frame.v[k][static_cast<int>(axis)]);
    }
}

TEST(ViewFrame, ExactNumbersAreWordsOfTheFixedRule) {
  const Scene scene = small_scene();
  const FixedRule rule;
  const Lattice lattice({{-2, 0, 5}, {1, 0, 5}}, {0, 0, 0});
  const TraceHead head = head_of_scene(scene, &rule, &lattice);
  const ViewFrames form(head, style_of_two_types(), 2, 2);
  State state;
  const uint32_t first = lattice.find({-2, 0, 5}), second = lattice.find({1, 0, 5});
  state.particles = {{0, 0, first, {1, 2, int64_t{1} << 40}, {-1, 0, 3}},
                     {1, 1, second, {7, 8, 9}, {-7, -8, -9}}};
  const ViewFrame made = form.make(random_frame(2), &state);
  const std::string& exact = made.blocks[ViewFrames::kExact];
  ASSERT_EQ(exact.size(), 128U);
  EXPECT_EQ(form.blocks()[ViewFrames::kExact].row(), 64U);
  for (size_t k = 0; k < 2; ++k) {
    const auto words = numbers_of<int64_t>(exact.substr(64 * k, 48));
    const auto cell = numbers_of<int32_t>(exact.substr(64 * k + 48, 12));
    for (size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(words[axis], state.particles[k].x[axis]);
      EXPECT_EQ(words[3 + axis], state.particles[k].v[axis]);
      EXPECT_EQ(cell[axis], lattice.cell(state.particles[k].cell)[axis]);
    }
  }
}

// Of 10 particles 4: ids 0, 2, 5, 7.
TEST(ViewFrame, APartIsSpreadOverAllIds) {
  const Scene scene = small_scene();
  const TraceHead head = head_of_scene(scene);
  const ViewFrames form(head, style_of_two_types(), 10, 4);
  Frame frame = random_frame(10);
  frame.type = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const ViewFrame made = form.make(frame, nullptr);
  EXPECT_EQ(numbers_of<uint8_t>(made.blocks[ViewFrames::kTypes]), (std::vector<uint8_t>{0, 2, 5, 7}));
  for (size_t b = 0; b < made.blocks.size(); ++b)
    EXPECT_EQ(made.blocks[b].size(), 4 * form.blocks()[b].row()) << b;
}

// A frame for pictures alone has no strain tensor, an engine may not hand over what a rule shows: they are
// not known, and not zero.
TEST(ViewFrame, FieldsThatAreNotThereAreNoNumbers) {
  const Scene scene = small_scene();
  const TraceHead head = head_of_scene(scene);
  const ViewFrames form(head, style_of_two_types(), 5, 5);
  Frame frame = random_frame(5);
  frame.broken = {0, 1, 2, 3, 4};
  const ViewFrame made = form.make(frame, nullptr);
  ASSERT_EQ(made.blocks.size(), form.blocks().size());
  size_t fields = 0;
  for (size_t b = ViewFrames::kFields; b < made.blocks.size(); ++b) {
    const std::string& name = form.blocks()[b].name;
    const auto values = numbers_of<float>(made.blocks[b]);
    for (size_t k = 0; k < values.size(); ++k)
      if (name == "velocity")
        EXPECT_EQ(values[k], static_cast<float>(frame.v[k / 3][static_cast<int>(k % 3)]));
      else if (name == "broken_bonds")
        EXPECT_EQ(values[k], static_cast<float>(k));
      else
        EXPECT_TRUE(std::isnan(values[k])) << name;
    ++fields;
  }
  EXPECT_EQ(fields, 5U);  // velocity, axial strain, strain, broken bonds, the rule's own
}

TEST(ViewFrame, TheHeadIsDataInsideAnElementOfHtml) {
  const Scene scene = small_scene();
  const TraceHead head = head_of_scene(scene);
  const std::string text = ViewFrames(head, style_of_two_types(), 5, 5).head_json("lattice");
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_NE(text.find(R"("title":"two \u003c/script> words")"), std::string::npos) << text;
  for (const char* part : {R"("material":"steel")", R"("constraint":"grip")", R"("mass":2e-06)"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace cuboct
