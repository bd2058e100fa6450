// Height maps of the ground: files, their place, and the heights of what stands on them.

#include "world/terrain.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/files.h"
#include "tests/world/read_world.h"
#include "world/ground.h"

namespace sf::world {
namespace {

/// Returns a small height map, which is also a seed of the fuzz target.
std::string path_of(const std::string& name) { return SF_SOURCE_DIR "/tests/fuzz/terrain/" + name; }
std::string refusal(const std::string& name, std::size_t bytes = std::string::npos) {
  return sf::refusal_of([&] { decode_height_map(name, base::read_text(path_of(name)).substr(0, bytes), 0.0, 1.0); });
}
std::string block(const std::string& keys, const std::string& name = "three_by_two.png") {
  return "terrain( file \"" + path_of(name) + "\" " + keys + " )\n";
}

/// Two rows of three points: the first row of heights is the picture's last.
TEST(Terrain, ReadsThePictureFromItsLastRow) {
  const HeightMap map = read_height_map(path_of("three_by_two.png"), -1.0, 4.0);
  EXPECT_EQ(map.columns, 3u);
  EXPECT_EQ(map.rows, 2u);
  EXPECT_EQ(map.heights, (std::vector<float>{4.0f, -1.0f, -1.0f, -1.0f, 0.0f, 4.0f}));
}

/// Both bytes of a value count, the first more: pictures are big-endian.
TEST(Terrain, ValuesHaveTwoBytes) {
  const HeightMap map = read_height_map(path_of("uneven.png"), 0.0, 65'535.0);
  EXPECT_EQ(map.heights, (std::vector<float>{0xff00, 0x1234, 0x0100, 0x0001}));
}

TEST(Terrain, RefusesOtherPictures) {
  EXPECT_NE(refusal("eight_bit.png").find("8 bits per pixel; expected a height map as greyscale PNG of 16"),
            std::string::npos);
  EXPECT_NE(refusal("huge.png").find("16384 x 8192 points; expected 2 to 16384 along each side, and at most 67108864"),
            std::string::npos)
      << "before memory is taken";
  EXPECT_NE(refusal("three_by_two.png", 48).find("corrupt PNG"), std::string::npos) << "ends too early";
  EXPECT_NE(refusal("three_by_two.png", 3).find("is not a height map"), std::string::npos);
}

TEST(Terrain, RefusesBadKeys) {
  EXPECT_NE(error_of(block("size [2 1]")).find("test.world:1: a terrain needs 'heights"), std::string::npos);
  EXPECT_NE(error_of(block("heights [0 1]")).find("test.world:1: a terrain needs 'size"), std::string::npos);
  EXPECT_NE(error_of("\nterrain( size [2 1] )").find("test.world:2: a terrain needs 'file"), std::string::npos);
  EXPECT_NE(error_of(block("size [2 1] heights [2 1]")).find("expected [lowest highest]"), std::string::npos);
  EXPECT_NE(error_of(block("size [1e-4 1] heights [0 1]")).find("expected at least 0.001 m"), std::string::npos);
  EXPECT_NE(error_of(block("size [2 1] heights [0 1]") + block("size [2 1] heights [0 1]")).find("a second 'terrain'"),
            std::string::npos);
  EXPECT_NE(error_of("model( " + block("size [2 1] heights [0 1]") + ")").find("expected it at the top level"),
            std::string::npos);
}

std::string geotiff(const std::string& name, const std::string& keys = "") {
  return "terrain( file \"" SF_SOURCE_DIR "/tests/world/terrain/" + name + "\" " + keys + " )\n";
}

/// Heights and distances of a GeoTIFF in metres, whose first row is the northernmost.
TEST(Terrain, ReadsGeoTiff) {
  const World world = read_world(geotiff("three_by_two.tif"));
  EXPECT_EQ(world.terrain.at(0).heights, (std::vector<float>{4.0f, 5.0f, 6.5f, 1.0f, 2.0f, 3.0f}));
  EXPECT_EQ(world.terrain[0].cell, (glm::dvec2{0.5, 2.0}));
  EXPECT_EQ(read_world(geotiff("three_by_two.tif", "size [4 3]")).terrain[0].cell, (glm::dvec2{2.0, 3.0}));
  EXPECT_NE(error_of(geotiff("three_by_two.tif", "heights [0 1]")).find("test.world:1: a GeoTIFF states its heights"),
            std::string::npos);
  EXPECT_NE(error_of(geotiff("gap.tif")).find("the height in column 1, row 1 is -9999"), std::string::npos)
      << "no data";
  EXPECT_NE(error_of(geotiff("nan.tif")).find("the height in column 2, row 0 is nan"), std::string::npos);
}

/// The picture's 3 x 2 points on 4 m x 2 m, turned by 90 degrees about (10, 20, 1).
const std::string kTurned = block("size [4 2] heights [0 5] pose [10 20 1 90]");

TEST(Terrain, HeightsArePlanesOfTriangles) {
  const World world = read_world(kTurned);
  ASSERT_EQ(world.terrain.size(), 1u);
  const Terrain& t = world.terrain[0];
  EXPECT_NEAR(*height_at(t, {11.0 - 1e-9, 18.0 + 1e-9}), 6.0, 1e-7) << "the first point";
  EXPECT_NEAR(*height_at(t, {9.0 + 1e-9, 22.0 - 1e-9}), 6.0, 1e-7) << "the last";
  EXPECT_NEAR(*height_at(t, {10.5, 18.5}), 1.0 + 4.0, 1e-9)
      << "x = 0.25 and y = 0.25 of the first cell, on its diagonal";
  EXPECT_NEAR(*height_at(t, {10.5, 19.0}), 1.0 + 2.75, 1e-9) << "x = 0.5, y = 0.25: below the diagonal";
  EXPECT_NEAR(*height_at(t, {10.0, 18.5}), 1.0 + 2.75, 1e-9) << "x = 0.25, y = 0.5: above it";
  EXPECT_FALSE(height_at(t, {11.1, 20.0})) << "outside";
  EXPECT_EQ(world.extent.y_max, 22.0);
}

/// Models at the top level stand on the ground, their children on them.
TEST(Terrain, ModelsStandOnIt) {
  const World world = read_world(
      "model( pose [10.5 18.5 0.25 0] model( pose [5 5 0.5 0] stack_children 0 ) )\n"
      "model( pose [0 0 0.25 0] )\n" +
      kTurned);
  EXPECT_NEAR(world.models[0].X_WM.z, 5.0 + 0.25, 1e-9);
  EXPECT_NEAR(world.models[1].X_WM.z, 5.25 + 0.5 + 0.1, 1e-9);
  EXPECT_EQ(world.models[2].X_WM.z, 0.25) << "on the floor around it";
}

TEST(Terrain, SnapshotsAndHashesContainIt) {
  World world = read_world(kTurned + "model( )");
  const std::vector<std::uint8_t> bytes = snapshot(world);
  const World again = from_snapshot(bytes);
  ASSERT_EQ(again.terrain.size(), 1u);
  EXPECT_EQ(again.terrain[0].heights, world.terrain[0].heights);
  EXPECT_EQ(again.hash, world.hash);
  const std::uint64_t hash = world.hash;
  world.terrain[0].heights[3] += 1.0f;
  update_extent_and_hash(world);
  EXPECT_NE(world.hash, hash);
  world.terrain[0].heights.pop_back();
  update_extent_and_hash(world);
  EXPECT_NE(sf::refusal_of([&] { from_snapshot(snapshot(world)); }), "") << "a point less than its size";
  translate(world, 1.0, 2.0);
  EXPECT_EQ(world.terrain[0].X_WT.x, 11.0);
}

/// Robots keep their height above it, on slopes of any size, and have the tilt of the plane under their wheels.
TEST(Terrain, GroundFollowsIt) {
  Terrain slope{.file = {},
                .X_WT = {0.0, 0.0, 2.0, 0.0},
                .cell = {10.0, 10.0},
                .columns = 2,
                .rows = 2,
                .heights = {0.0f, 10.0f, 20.0f, 30.0f}};
  const Ground ground({}, {&slope, 1});
  EXPECT_FALSE(ground.is_flat());
  EXPECT_NEAR(ground.follow({0.0, 0.0, 17.0, 0.0}, {1.0, 0.0}), 18.0, 1e-12);
  EXPECT_NEAR(ground.follow({0.0, 0.0, 17.5, 0.0}, {0.0, 1.0}), 19.5, 1e-12) << "half a metre above it";
  const base::Tilt along = ground.tilt({0.0, 0.0, 17.0, 0.0}, 0.5, 0.4);
  EXPECT_NEAR(along.pitch, -std::atan(1.0), 1e-12);
  EXPECT_NEAR(along.roll, std::atan(2.0 / std::sqrt(2.0)), 1e-12)
      << "the plane's gradient across, in the pitched frame";
  const base::Tilt back = ground.tilt({0.0, 0.0, 17.0, M_PI}, 0.5, 0.4);
  EXPECT_NEAR(back.pitch, std::atan(1.0), 1e-12);
  EXPECT_NEAR(back.roll, -along.roll, 1e-12);
  EXPECT_EQ(Ground({}).tilt({}, 0.5, 0.4).pitch, 0.0);
  const auto slope_at = [&](double yaw, glm::dvec2 p) {
    slope.X_WT.yaw = yaw;
    return Ground({}, {&slope, 1}).at(p, 0.0).slope;
  };
  EXPECT_NEAR(slope_at(0.0, {2.0, 1.0}).x, 1.0, 1e-12);
  EXPECT_NEAR(slope_at(0.0, {1.0, 2.0}).y, 2.0, 1e-12) << "the other triangle";
  EXPECT_NEAR(slope_at(0.5 * M_PI, {1.0, 2.0}).x, -2.0, 1e-12) << "in the world's frame";
  EXPECT_NEAR(slope_at(0.5 * M_PI, {1.0, 2.0}).y, 1.0, 1e-12);
}

}  // namespace
}  // namespace sf::world
