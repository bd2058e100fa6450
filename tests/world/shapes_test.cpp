// Shapes of world files, and changes of objects' shapes, sizes and colours.

#include "world/shapes.h"

#include <gtest/gtest.h>

#include "tests/refusal.h"
#include "tests/world/read_world.h"

namespace sf::world {
namespace {

constexpr const char* kShapes = R"(
shape( name "crate" size [0.6 0.4 0.5] color "red" )
shape( name "wedge" size [0.9 0.8 0.3] block( points 3 point[0] [0 0] point[1] [2 0] point[2] [0 1] z [0 1] ) )
)";

World shaped(const std::string& object) { return read_world(std::string(kShapes) + object, {}); }

std::vector<Segment> own_sides(const World& world) {
  std::vector<Segment> sides;
  for (const Segment& side : world.movers[0].body)
    if (side.model == world.movers[0].model) sides.push_back(side);
  return sides;
}

/// Bitwise: geometry, heights and flags.
void expect_same(const std::vector<Segment>& a, const std::vector<Segment>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].a, b[i].a) << i;
    EXPECT_EQ(a[i].b, b[i].b) << i;
    EXPECT_EQ(std::pair(a[i].z_min, a[i].z_max), std::pair(b[i].z_min, b[i].z_max)) << i;
    EXPECT_EQ(a[i].solid_left, b[i].solid_left);
    EXPECT_EQ(a[i].stops_robots, b[i].stops_robots);
  }
}

TEST(Shapes, AreReadLikeBodiesOfModels) {
  const World world = shaped("");
  ASSERT_EQ(world.shapes.size(), 2u);
  EXPECT_TRUE(world.warnings.empty());
  EXPECT_EQ(world.shapes[0].size, glm::dvec3(0.6, 0.4, 0.5));
  EXPECT_EQ(world.shapes[0].color, 0xFFFF0000u);
  EXPECT_EQ(world.shapes[0].outline.size(), 4u);
  EXPECT_EQ(world.shapes[1].color, 0u);
  EXPECT_EQ(world.shapes[1].outline.size(), 3u);
  EXPECT_TRUE(world.walls.empty());
}

/// Also with an origin, flags and a carried part: the part stays where it is.
TEST(Shapes, EqualThoseOfAFile) {
  constexpr const char* kRest =
      "pose [1 2 0 30] origin [0.1 -0.2 0.05 15] obstacle_return 0 "
      "model( name \"part\" size [0.1 0.1 0.1] pose [0.3 0 0 0] )";
  const auto object = [&](const std::string& body) { return "model( name \"tag1\" " + body + kRest + " )\n"; };
  const std::pair<std::string, ShapeChange> kCases[] = {
      {"size [0.6 0.4 0.5]", {.shape = "crate"}},
      {"size [0.9 0.8 0.3] block( points 3 point[0] [0 0] point[1] [2 0] point[2] [0 1] z [0 1] )", {.shape = "wedge"}},
      {"size [0.37 0.91 0.13]", {.shape = "crate", .size = glm::dvec3{0.37, 0.91, 0.13}}}};
  for (const auto& [body, change] : kCases) {
    World world = shaped(object("size [0.2 0.2 0.5]"));
    const World before = world, written = shaped(object(body));
    EXPECT_TRUE(change_shape(world, 0, change));
    expect_same(own_sides(world), own_sides(written));
    EXPECT_EQ(world.models[0].size, written.models[0].size);
    EXPECT_EQ(world.movers[0].body.size(), own_sides(world).size() + 4);
    EXPECT_EQ(world.movers[0].body.back().a, before.movers[0].body.back().a) << "the part";
    EXPECT_EQ(world.movers[0].radius, radius_of(world.movers[0]));
    EXPECT_TRUE(change_shape(world, 0, {.shape = "original"}));
    expect_same(world.movers[0].body, before.movers[0].body);
    EXPECT_EQ(world.models[0].size, before.models[0].size);
    EXPECT_EQ(world.models[0].color, before.models[0].color);
  }
}

TEST(Shapes, SizesScaleTheOutlineThatIsThere) {
  World world = shaped("model( name \"tag1\" size [0.2 0.4 0.5] color \"blue\" )\n");
  const World written = shaped("model( name \"tag1\" size [0.7 0.3 0.11] )\n");
  change_shape(world, 0, {.size = glm::dvec3{0.7, 0.3, 0.11}});
  expect_same(own_sides(world), own_sides(written));
  EXPECT_EQ(world.models[0].color, 0xFF0000FFu);
  change_shape(world, 0, {.shape = "wedge"});
  EXPECT_EQ(world.models[0].size, glm::dvec2(0.9, 0.8)) << "a shape brings its size";
  EXPECT_EQ(world.models[0].color, 0xFF0000FFu) << "but no colour that it does not have";
  EXPECT_FALSE(change_shape(world, 0, {.color = 0xFF123456u})) << "the outline is the same";
  EXPECT_EQ(world.models[0].color, 0xFF123456u);
  change_shape(world, 0, {.shape = "crate"});
  EXPECT_EQ(world.models[0].color, 0xFFFF0000u);
}

/// A magnet and a mark for fiducial finders are in the middle of their object.
TEST(Shapes, MagnetsAndFiducialsFollow) {
  constexpr const char* kRest = " magnetic_moment 3 fiducial_return 7 )\n";
  World world = shaped(std::string("model( name \"tag1\" size [0.2 0.4 0.5] ") + kRest);
  const World before = world, written = shaped(std::string("model( name \"tag1\" size [0.6 0.4 0.5] ") + kRest);
  change_shape(world, 0, {.shape = "wedge"});
  EXPECT_DOUBLE_EQ(world.fiducials[0].X_BF.z, 0.15);
  EXPECT_DOUBLE_EQ(world.movers[0].magnets[0].radius, 0.4);
  change_shape(world, 0, {.shape = "crate"});
  EXPECT_EQ(world.fiducials[0].X_BF.z, written.fiducials[0].X_BF.z);
  EXPECT_EQ(world.movers[0].magnets[0].z, written.movers[0].magnets[0].z);
  EXPECT_EQ(world.movers[0].magnets[0].radius, written.movers[0].magnets[0].radius);
  change_shape(world, 0, {.shape = "original"});
  EXPECT_EQ(world.movers[0].magnets[0].radius, before.movers[0].magnets[0].radius);
  EXPECT_EQ(world.fiducials[0].X_BF.z, before.fiducials[0].X_BF.z);
}

TEST(Shapes, SnapshotsHaveThemAndOtherWorldsAreUnchanged) {
  const World world = shaped("model( name \"tag1\" size [0.2 0.2 0.5] origin [0.1 0 0 0] )\n");
  World again = from_snapshot(snapshot(world));
  ASSERT_EQ(again.shapes.size(), 2u);
  EXPECT_EQ(again.hash, world.hash);
  EXPECT_EQ(again.shapes[1].outline[2].b, world.shapes[1].outline[2].b);
  EXPECT_NE(world.hash, read_world("model( name \"tag1\" size [0.2 0.2 0.5] origin [0.1 0 0 0] )\n", {}).hash);
  // The origin is not in a snapshot, but recorded with a change.
  World changed = world;
  change_shape(changed, 0, {.shape = "wedge", .color = 0xFF00FF00u, .size = glm::dvec3{1.0, 2.0, 3.0}});
  EXPECT_TRUE(restore_shape(again, shape_state(changed, 0)));
  expect_same(again.movers[0].body, changed.movers[0].body);
  EXPECT_EQ(again.models[0].color, 0xFF00FF00u);
  for (const base::ShapeState& wrong :
       {base::ShapeState{.mover = 1}, base::ShapeState{.shape = 2}, base::ShapeState{.size = {NAN, 1.0, 1.0}},
        base::ShapeState{.X_MB = {NAN, 0, 0, 0}}})
    EXPECT_NE(sf::refusal_of([&] { restore_shape(again, wrong); }), "");
}

TEST(Shapes, ErrorsNameLineAndRemedy) {
  const auto refusal = [](const std::string& text) { return error_of(text); };
  const std::pair<const char*, const char*> kCorpus[] = {
      {"shape( size [1 1 1] )", "'shape' has no name; expected name \"...\" in it"},
      {"shape( name \"a b\" )", "'a b' is no name of a shape; expected 1 to 64 ASCII letters"},
      {"shape( name \"original\" )", "'original' is each object's own shape; expected another name"},
      {"shape( name \"a\" )\nshape( name \"a\" )", "a second shape is named 'a'; expected another name"},
      {"shape( name \"a\" noblocks 1 )", "shape 'a' has an outline of 0 sides; expected 1 to 10000"},
      {"shape( name \"a\" model( ) )", "'model' is not part of a shape; expected blocks only"},
      {"shape( name \"a\" size [1 -1 1] )", "'size' expects lengths that are not negative"},
      {"shape( name \"a\" bitmap \"none.png\" size [1 1 1] )", "none.png"},
      {"model( shape( name \"a\" ) )", "'shape' is part of a model; expected it at the top level"}};
  for (const auto& [text, message] : kCorpus) expect_in(message, refusal(text));
  std::string many;
  for (std::size_t i = 0; i <= kMostShapes; ++i) many += "shape( name \"s" + std::to_string(i) + "\" )\n";
  expect_in("more than 200 shapes; expected fewer", refusal(many));
  const World world = read_world("shape( name \"a\" pose [1 0 0 0] )", {});
  ASSERT_EQ(world.warnings.size(), 1u);
  expect_in("unknown property 'pose' of 'shape' is ignored", world.warnings[0].message);
  EXPECT_EQ(color_named("#0a10fF"), 0xFF0A10FFu);
  EXPECT_EQ(color_named("steel blue"), 0xFF4682B4u);
  for (const char* text : {"", "#12345", "#12345g", "redd"})
    expect_in("expected a name of X11", sf::refusal_of([&] { color_named(text); }));
}

}  // namespace
}  // namespace sf::world
