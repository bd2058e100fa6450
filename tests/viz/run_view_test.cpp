// Positions of objects in video frames.

#include "viz/run_view.h"

#include <gtest/gtest.h>

#include "base/report.h"
#include "viz/theme.h"
#include "world/stage/build_world.h"

namespace sf::viz {
namespace {

world::World room_of_two() {
  return world::build_world("room.world", R"(
    model( name "walls" size [8 8 1] boundary 1 )
    position( name "one" pose [0 0 0 0] size [0.4 0.4 0.2] )
    position( name "two" pose [2 0 0 0] size [0.4 0.4 0.2] ))");
}

/// 50 pixels per metre.
constexpr TopViewOptions kView{.width = 400, .height = 400, .extent = world::Extent{-4.0, -4.0, 4.0, 4.0}};

RunFrame frame_of(const world::World& world) {
  RunFrame frame;
  for (const world::Mover& mover : world.movers) frame.X_WM.push_back(mover.X_WM);
  frame.contacts.assign(world.movers.size(), 0);
  return frame;
}

std::uint32_t color_at(const PixelImage& image, double x, double y) {
  const auto column = static_cast<std::size_t>(200.0 + 50.0 * x), row = static_cast<std::size_t>(200.0 - 50.0 * y);
  const std::uint8_t* p = &image.rgb[3 * (row * static_cast<std::size_t>(image.width) + column)];
  return 0xFF000000u | static_cast<std::uint32_t>(p[0] << 16 | p[1] << 8 | p[2]);
}

/// A scan of five beams from a sensor that looks along y; the middle one has no echo.
TEST(RunView, EchoesAreDrawnFromTheMeasurementPose) {
  const world::World world = room_of_two();
  const record::SensorInfo laser{.fov = M_PI, .samples = 5, .range_min = 0.0, .range_max = 3.0};
  RunFrame frame = frame_of(world);
  frame.ranges = {{&laser, {0.0, 0.5, 0.0, 0.5 * M_PI}, {2.0, 2.0, 3.0, 2.0, 2.0}}};
  const PixelImage image = RunView(world, {.view = kView}).paint(frame);
  const double s = std::sqrt(2.0);
  for (const auto& [x, y] : {std::pair{2.0, 0.5}, {-2.0, 0.5}, {s, 0.5 + s}, {-s, 0.5 + s}})
    EXPECT_EQ(color_at(image, x, y), theme::kFieldOfView) << x << " " << y;
  EXPECT_NE(color_at(image, 0.0, 3.49), theme::kFieldOfView) << "a beam without an echo has no dot";
  EXPECT_NE(color_at(image, 0.3, 1.5), theme::kWhite) << "the area in view is shaded";
}

TEST(RunView, ConesOfSonarAreDrawnFromTheirTransducers) {
  const world::World world = room_of_two();
  record::SensorInfo sonar;
  sonar.standard.push_back({.X_SE = {0.0, 0.0, 0.0, M_PI}, .fov = 0.5, .range_min = 0.1, .range_max = 3.0});
  RunFrame frame = frame_of(world);
  frame.ranges = {{&sonar, {-0.5, 1.0, 0.0, 0.0}, {1.5}}};
  const PixelImage image = RunView(world, {.view = kView}).paint(frame);
  EXPECT_NE(color_at(image, -1.5, 1.0), theme::kWhite);
  EXPECT_EQ(color_at(image, -2.4, 1.0), theme::kWhite) << "beyond the echo";
  EXPECT_EQ(color_at(image, 0.5, 1.0), theme::kWhite) << "behind the transducer";
}

TEST(RunView, TheCameraStopsWhenItsRobotsLeave) {
  const world::World world = room_of_two();
  RunView view(world, {.view = kView, .followed = {0}, .around = 4.0});
  RunFrame frame = frame_of(world);
  frame.X_WM[0] = {1.0, 1.0, 0.0, 0.0};
  const PixelImage there = view.paint(frame);
  EXPECT_NE(color_at(there, 0.1, 0.0), theme::kWhite) << "the robot in the middle";
  EXPECT_NE(color_at(there, 1.1, -1.0), theme::kWhite) << "the other one, at its distance";
  frame.X_WM[0] = base::kAbsent;
  const PixelImage gone = view.paint(frame);
  EXPECT_EQ(color_at(gone, 0.1, 0.0), theme::kWhite);
  EXPECT_NE(color_at(gone, 1.1, -1.0), theme::kWhite) << "the camera stays";
}

TEST(RunView, ContactsAndTimeAreShown) {
  const world::World world = room_of_two();
  RunView view(world, {.view = kView});
  RunFrame frame = frame_of(world);
  const PixelImage before = view.paint(frame);
  frame.contacts[1] = 1;
  const PixelImage after = view.paint(frame);
  const double ring = world.movers[1].radius + 3.0 / 50.0;
  EXPECT_NE(color_at(before, 2.0, ring), theme::kContact);
  EXPECT_EQ(color_at(after, 2.0, ring), theme::kContact);
  frame.time = 1.0;
  EXPECT_NE(view.paint(frame).rgb, after.rgb) << "the time stamp";
}

}  // namespace
}  // namespace sf::viz
