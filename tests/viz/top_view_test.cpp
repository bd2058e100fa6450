// Images of a world from above: pixels at the positions of objects.

#include "viz/top_view.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "base/error.h"
#include "world/stage/build_world.h"

namespace sf::viz {
namespace {

/// A room of 4 m with one robot, 0.4 m wide.
world::World room() {
  return world::build_world("room.world", R"(
    model( name "walls" size [4 4 1] boundary 1 )
    position( name "one" pose [0 0 0 0] size [0.4 0.4 0.2] ))");
}

/// 100 pixels per metre.
TopView view_of(const world::World& world) {
  return {world, {.width = 400, .height = 400, .extent = world::Extent{-2.0, -2.0, 2.0, 2.0}}};
}

bool free_at(const PixelImage& image, double x, double y) {
  const auto column = static_cast<std::size_t>(200.0 + 100.0 * x), row = static_cast<std::size_t>(200.0 - 100.0 * y);
  const std::uint8_t* pixel = &image.rgb[3 * (row * static_cast<std::size_t>(image.width) + column)];
  return pixel[0] == 255 && pixel[1] == 255 && pixel[2] == 255;
}

TEST(TopView, ObjectsAreAtTheirPositions) {
  const world::World world = room();
  const TopView view = view_of(world);
  const PixelImage image = view.paint(std::array{base::Pose{1.0, 0.5, 0.0, 0.0}}, 0.0);
  EXPECT_EQ(image.width, 400);
  EXPECT_EQ(image.rgb.size(), 3u * 400u * 400u);
  EXPECT_FALSE(free_at(image, 1.1, 0.5)) << "the body";
  EXPECT_TRUE(free_at(image, 0.0, 0.0)) << "where the robot was at load";
  EXPECT_TRUE(free_at(image, 1.0, -0.5)) << "mirrored";
  EXPECT_FALSE(free_at(image, -1.995, 0.0)) << "a wall";
}

/// The static layer is painted once; an image leaves no traces in the next.
TEST(TopView, ImagesDoNotDependOnEarlierOnes) {
  const world::World world = room();
  const TopView view = view_of(world);
  const std::array first{base::Pose{1.0, 0.5, 0.0, 0.3}}, second{base::Pose{-1.0, 0.0, 0.0, 0.0}};
  const PixelImage before = view.paint(first, 0.0);
  EXPECT_NE(view.paint(second, 0.0).rgb, before.rgb);
  EXPECT_EQ(view.paint(first, 0.0).rgb, before.rgb);
}

TEST(TopView, RejectsOptionsOutOfRange) {
  const world::World world = room();
  using world::Extent;
  for (const TopViewOptions& options :
       {TopViewOptions{.width = 0}, TopViewOptions{.height = TopViewOptions::kLongestSide + 1},
        TopViewOptions{.extent = Extent{0.0, 0.0, 0.0, 1.0}}, TopViewOptions{.extent = Extent{0.0, 0.0, 1.0, NAN}}})
    EXPECT_THROW(TopView(world, options), base::InputError);
  EXPECT_NO_THROW(TopView(world, {.width = 1, .height = 1}));
}

}  // namespace
}  // namespace sf::viz
