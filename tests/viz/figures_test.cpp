#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "tests/sensors/edit_laser.h"
#include "tests/viz/png.h"
#include "tests/viz/scenes.h"
#include "viz/axes.h"
#include "viz/color.h"
#include "viz/occupancy_figure.h"
#include "viz/signal_layer.h"
#include "viz/trajectory_figure.h"
#include "viz/visibility_layer.h"
#include "viz/world_figure.h"

namespace sf::viz {
namespace {

using base::Pose;

/// An empty room of 6 m x 4 m in walls of 0.5 m.
world::World room() { return scenes::make_world(6, 4, 0, 0); }

/// The picture of a room, and the pixels of points in the world. The plot is located by its frame.
struct Seen {
  scenes::Picture picture;
  int left = 0, top = 0, right = 0, bottom = 0;
  world::Extent shown;

  std::uint32_t at(double x, double y) const {
    return picture.at(static_cast<int>(left + (x - shown.x_min) / (shown.x_max - shown.x_min) * (right - left)),
                      static_cast<int>(bottom - (y - shown.y_min) / (shown.y_max - shown.y_min) * (bottom - top)));
  }
};

Seen see(const std::string& path, double margin) {
  constexpr std::uint32_t frame = 0xFF404040u;
  Seen seen{scenes::read_png(path), 0, 0, 0, 0, {-0.5, -0.5, 6.5, 4.5}};
  const scenes::Picture& p = seen.picture;
  const int x_mid = p.width / 2;
  const int y_mid = p.height / 3;
  while (seen.top < p.height - 1 && p.count(frame, x_mid - 50, seen.top, x_mid + 50, seen.top + 1) < 100) ++seen.top;
  seen.bottom = p.height - 1;
  while (seen.bottom > 0 && p.count(frame, x_mid + 100, seen.bottom, x_mid + 150, seen.bottom + 1) < 50) --seen.bottom;
  while (seen.left < p.width - 1 && p.count(frame, seen.left, y_mid, seen.left + 1, y_mid + 60) < 60) ++seen.left;
  seen.right = p.width - 1;
  while (seen.right > 0 && p.count(frame, seen.right, y_mid, seen.right + 1, y_mid + 60) < 60) --seen.right;
  ++seen.left, ++seen.top;
  const double pad = margin * 7.0;
  seen.shown = {-0.5 - pad, -0.5 - pad, 6.5 + pad, 4.5 + pad};
  return seen;
}

Seen see_world(const world::World& world, const std::string& name) {
  draw_world(world, scenes::own_file(name));
  return see(scenes::own_file(name), 0.03);
}

TEST(WorldFigure, LightsHaveTheirInitialState) {
  world::World world = room();
  const auto add = [&](double x, double offset) {
    world.lights.push_back({.name = "light",
                            .X_WL = {x, 2.0, 0.0, 0.0},
                            .phases = {{world::LightState::green, 8.0}, {world::LightState::red, 2.0}},
                            .offset = offset});
  };
  add(1.0, 0.0);
  add(3.0, 1.0);  // one second before the start of its plan
  const Seen seen = see_world(world, "lights.png");
  EXPECT_EQ(seen.at(1.0, 2.0), 0xFF43A047u);
  EXPECT_EQ(seen.at(3.0, 2.0), 0xFFE53935u);
}

TEST(WorldFigure, LightsPointWhereTheyFace) {
  world::World world = room();
  world.lights.push_back(
      {.name = "light", .X_WL = {3.0, 2.0, 0.0, M_PI / 2}, .phases = {{world::LightState::green, 8.0}}});
  const Seen seen = see_world(world, "facing.png");
  EXPECT_LT(to_oklab(seen.at(3.0, 2.055)).lightness, 0.6) << "a stroke to the north";
  EXPECT_GT(to_oklab(seen.at(3.0, 1.945)).lightness, 0.9) << "and none to the south";
}

/// The start of the subtitle is at the same position and equal in both pictures.
TEST(WorldFigure, TheSubtitleDoesNotCountTags) {
  world::World world = room();
  world.movers.push_back(scenes::make_robot(world, 1, {2.0, 2.0, 0, 0}, 0xFF2E7D32u, 1.0));
  draw_world(world, scenes::own_file("robot_alone.png"));
  world.movers.push_back({.name = "tag", .model = 0, .is_tag = true, .X_WM = {4.0, 2.0, 0, 0}});
  draw_world(world, scenes::own_file("robot_and_tag.png"));
  const scenes::Picture one = scenes::read_png(scenes::own_file("robot_alone.png")),
                        two = scenes::read_png(scenes::own_file("robot_and_tag.png"));
  int dark = 0, apart = 0;
  for (int y = 65; y < 92; ++y)
    for (int x = 0; x < 180; ++x) {
      dark += to_oklab(one.at(x, y)).lightness < 0.6 ? 1 : 0;
      apart += one.at(x, y) != two.at(x, y) ? 1 : 0;
    }
  EXPECT_GT(dark, 50) << "1 robot,";
  EXPECT_EQ(apart, 0);
}

TEST(WorldFigure, HolesAreDarkAndBeamsAreFaint) {
  world::World world = room();
  world.floor_holes.push_back({{{1.0, 1.0}, {2.0, 1.0}, {2.0, 2.0}, {1.0, 2.0}}, 0});
  world.emitters.push_back({world::Emitter::Kind::virtual_wall, 0, {3.0, 1.0, 0.0, M_PI / 2}, 2.0, 0.4, 0.3});
  world.emitters.push_back({world::Emitter::Kind::dock, 0, {5.8, 3.0, 0.0, M_PI}, 1.5, 0.7, 0.0});
  const Seen seen = see_world(world, "signals.png");
  const auto green_of = [&](double x, double y) { return seen.at(x, y) >> 8 & 0xFF; };
  EXPECT_LT(green_of(1.52, 1.53), 0x60u) << "the hole";
  EXPECT_EQ(seen.at(2.53, 2.53), kWhite) << "outside the beam";
  EXPECT_GT(green_of(3.02, 2.53), 0xC0u) << "in the beam";
  EXPECT_NE(seen.at(3.02, 2.53), kWhite);
  EXPECT_NE(seen.at(3.02, 0.83), kWhite) << "in the halo behind it";
  EXPECT_EQ(seen.at(3.02, 0.53), kWhite) << "and beyond";
  // The dock faces west: its red buoy's beam is to its left, which is south.
  const std::uint32_t south = seen.at(4.82, 2.63), north = seen.at(4.82, 3.37);
  EXPECT_GT(south >> 16 & 0xFF, south >> 8 & 0xFF) << "red";
  EXPECT_GT(north >> 8 & 0xFF, north >> 16 & 0xFF) << "green";
}

TEST(WorldFigure, LampsAreYellow) {
  world::World world = room();
  world.lamps.push_back({0, {3.0, 1.0, 2.0, 0.0}, 100.0});
  const Seen seen = see_world(world, "lamps.png");
  EXPECT_EQ(seen.at(3.0, 1.0), 0xFFFDD835u);
  EXPECT_EQ(signal_layer_legend(world).size(), 1u);
}

TEST(WorldFigure, WallsAreAtTheirPositions) {
  const Seen seen = see_world(room(), "room.png");
  EXPECT_EQ(seen.at(3.27, 2.27), kWhite) << "inside the room";
  EXPECT_EQ(seen.at(-0.6, 2.27), kWhite) << "outside of the walls";
  for (const auto& [x, y] : {std::pair{-0.25, 2.2}, {6.25, 2.2}, {3.2, -0.25}, {3.2, 4.25}, {-0.25, -0.25}})
    EXPECT_LT(to_oklab(seen.at(x, y)).lightness, 0.8) << x << ", " << y << " is within a wall";
  EXPECT_LT(to_oklab(seen.at(3.2, 0.0)).lightness, 0.6) << "the wall's edge";
}

TEST(WorldFigure, DrawsPaintAndMagnets) {
  world::World world = room();
  world.lane_markings.push_back({{{1.0, 2.25}, {5.0, 2.25}}, 0.3, 0xFFF2B800u});
  world.magnets.push_back({{3.0, 1.0}, 0.0, 1.0, 0.05, 0});
  world.magnets.push_back({{4.0, 1.0}, 0.0, -1.0, 0.05, 0});
  const Seen seen = see_world(world, "paint.png");
  EXPECT_EQ(seen.at(3.27, 2.27), 0xFFF2B800u) << "in its colour";
  EXPECT_NE(seen.at(3.27, 2.42), kWhite) << "on asphalt";
  EXPECT_EQ(seen.at(5.6, 2.27), kWhite) << "which ends with it";
  EXPECT_GT(to_oklab(seen.at(3.0, 1.0)).a, 0.1) << "red: north is up";
  EXPECT_LT(to_oklab(seen.at(4.0, 1.0)).b, -0.05) << "blue: south is up";
}

TEST(WorldFigure, DrawsOtherSensors) {
  world::World world = room();
  world::Mover robot = scenes::make_robot(world, 1, {2.0, 2.0, 0, 0}, 0xFF2E7D32u, 0.5);
  robot.sensors.push_back({"laneedge", "e", {0.0, 0.0, 0.0, M_PI / 2}, 0.01, 1.0, M_PI / 180.0, {}, 1, "x.world"});
  robot.sensors.push_back({"magnetometer", "m", {1.0, -1.0, 0.0, 0.0}, 0.01, 1.0, M_PI / 180.0, {}, 2, "x.world"});
  world.movers.push_back(robot);
  const Seen seen = see_world(world, "carried.png");
  EXPECT_NE(seen.at(2.03, 2.7), kWhite) << "a fan of 1 m to the left";
  EXPECT_EQ(seen.at(2.53, 2.7), kWhite) << "of 30 degrees";
  EXPECT_EQ(seen.at(2.03, 3.2), kWhite) << "and no longer";
  EXPECT_LT(to_oklab(seen.at(3.0, 1.0)).lightness, 0.6) << "an element";
}

TEST(WorldFigure, DrawsRobotAndItsView) {
  world::World world = room();
  world.movers.push_back(scenes::make_robot(world, 1, {2.0, 2.2, 0, 0}, 0xFF2E7D32u, 3.0));
  const Seen seen = see_world(world, "robot.png");
  const OklabColor body = to_oklab(seen.at(1.92, 2.25));
  EXPECT_LT(body.a, -0.03) << "a green body";
  const OklabColor view = to_oklab(seen.at(4.27, 2.27));
  EXPECT_LT(view.b, -0.02) << "a blue field of view ahead";
  EXPECT_GT(view.lightness, 0.85) << "which is translucent";
  EXPECT_EQ(seen.at(0.77, 2.27), kWhite) << "and not behind";
  EXPECT_EQ(seen.at(5.27, 2.27), kWhite) << "nor beyond range_max";
}

TEST(WorldFigure, HeadingIsDrawn) {
  world::World world = room();
  world.movers.push_back(scenes::make_robot(world, 1, {2.0, 2.0, 0, M_PI / 2}, 0xFF2E7D32u, 0.2));
  const Seen seen = see_world(world, "heading.png");
  EXPECT_LT(to_oklab(seen.at(2.0, 2.08)).lightness, to_oklab(seen.at(2.0, 1.92)).lightness - 0.1) << "to the north";
}

TEST(WorldFigure, ViewStopsAtWalls) {
  world::World world = room();
  world.movers.push_back(scenes::make_robot(world, 1, {2.0, 2.2, 0, 0}, 0xFF2E7D32u, 30.0));
  const Seen seen = see_world(world, "view.png");
  EXPECT_NE(seen.at(5.27, 2.27), kWhite);
  EXPECT_EQ(seen.at(6.62, 2.27), kWhite);
}

TEST(WorldFigure, EveryCombinationOfWallFlagsIsDrawn) {  // all combinations of flags: no wall disappears
  for (int flags = 0; flags < 8; ++flags) {
    world::World world = room();
    for (world::Segment& s : world.walls) {
      s.solid_left = flags & 1;
      s.seen_by_laser = flags & 2;
      s.stops_robots = flags & 4;
    }
    const Seen seen = see_world(world, "flags.png");
    int dark = 0;
    for (double x = 0.5; x < 5.5; x += 0.01) dark += to_oklab(seen.at(x, 0.0)).lightness < 0.8 ? 1 : 0;
    EXPECT_GT(dark, 60) << flags;
  }
}

/// Two walls at one position: the one visible to lasers covers the dots of the other, in either order.
TEST(WorldFigure, WallsVisibleToLasersAreOnTop) {
  const auto lightest = [](const world::World& world) {
    const Seen seen = see_world(world, "top.png");
    double most = 0.0;
    for (double x = 0.5; x < 5.5; x += 0.01) most = std::max(most, to_oklab(seen.at(x, 0.0)).lightness);
    return most;
  };
  const world::World plain = room();
  world::World both = plain;
  for (std::size_t i = 0; i < plain.walls.size(); ++i) {
    both.walls.push_back(plain.walls[i]);
    both.walls.back().seen_by_laser = both.walls.back().solid_left = false;
  }
  EXPECT_LT(lightest(both), lightest(plain) + 0.05);
}

TEST(WorldFigure,
     UnusualWorldsCanBeDrawn) {  // an empty world; no model rows; a name from the file; a robot without a body
  world::World empty;
  empty.extent = {0, 0, 0, 0};
  draw_world(empty, scenes::own_file("empty.png"));
  const scenes::Picture nothing = scenes::read_png(scenes::own_file("empty.png"));
  EXPECT_GT(nothing.count(kWhite), 9 * nothing.width * nothing.height / 10) << "paper, a frame and its numbers";
  EXPECT_GT(nothing.count(0xFF404040u), 2 * 500) << "the frame";
  world::World world = room();
  world.name.clear();
  world.file = "some/where/cave.world";
  world.movers.push_back(scenes::make_robot(world, 1, {2.0, 2.2, 0, 0}, 0xFF2E7D32u, 3.0));
  world.movers[0].body.clear();
  world.movers[0].is_tag = true;
  scenes::edit_laser(world.movers[0])->fov = 0.0;
  world.models.clear();
  const Seen seen = see_world(world, "odd.png");
  EXPECT_LT(to_oklab(seen.at(3.2, 0.0)).lightness, 0.6) << "walls of unknown models";
  EXPECT_EQ(seen.at(4.27, 2.27), kWhite) << "a view of no width";
}

TEST(WorldFigure, FarFromTheOriginIsTheSamePlot) {  // 100 km away: the labels differ, walls and robots do not
  world::World near = room();
  near.movers.push_back(scenes::make_robot(near, 1, {2.0, 2.2, 0, 0}, 0xFF2E7D32u, 3.0));
  world::World far = near;
  for (world::Segment& s : far.walls) s.a = s.a + glm::dvec2{100000, 100000}, s.b = s.b + glm::dvec2{100000, 100000};
  far.movers[0].X_WM.x += 100000, far.movers[0].X_WM.y += 100000;
  far.extent = {99999.5, 99999.5, 100006.5, 100004.5};
  const Seen a = see_world(near, "near.png"), b = see_world(far, "far.png");
  for (const auto& [x, y] : {std::pair{1.92, 2.25}, {4.27, 2.27}, {0.77, 2.27}, {-0.25, 2.2}, {6.62, 2.27}})
    EXPECT_EQ(a.at(x, y), b.at(x, y)) << x << ", " << y;
}

TEST(VisiblePoints, BeamsEndAtTheFirstWallOrAtRangeMax) {
  const world::World world = room();
  sensors::LaserSettings laser;
  laser.fov = M_PI;
  laser.range_max = 3.0;
  const auto ends = visible_points(world, {5.0, 2.0, 0.5, 0}, laser, 3);
  EXPECT_NEAR(ends[0].y, 0.0, 1e-9);  // right: the wall
  EXPECT_NEAR(ends[1].x, 6.0, 1e-9);  // ahead: the wall
  EXPECT_NEAR(ends[2].y, 4.0, 1e-9);  // left: the wall
  const auto back = visible_points(world, {5.0, 2.0, 0.5, M_PI}, laser, 3);
  EXPECT_NEAR(back[1].x, 2.0, 1e-9);  // no wall within range_max
}

/// Their ends are each beyond the range along one axis, and their middles within it: 11 / sqrt(2) = 7.78 m away.
TEST(VisiblePoints, WallsAcrossACornerOfTheRangeAreSeen) {
  for (int quarter = 0; quarter < 4; ++quarter)
    for (const bool turned : {false, true}) {
      world::World world;
      world::Segment wall;
      wall.a = base::rotate(0.5 * M_PI * quarter, {-1.0, 12.0});
      wall.b = base::rotate(0.5 * M_PI * quarter, {12.0, -1.0});
      if (turned) std::swap(wall.a, wall.b);
      wall.z_max = 1.0;
      world.walls.push_back(wall);
      const double yaw = 0.5 * M_PI * quarter + 0.25 * M_PI;
      const auto ends = visible_points(world, {0.0, 0.0, 0.5, yaw}, {.fov = 0.2, .samples = 3, .range_max = 8.0}, 3);
      EXPECT_NEAR(glm::length(ends[1]), 11.0 / std::sqrt(2.0), 1e-12) << quarter << turned;
    }
}

TEST(VisiblePoints, SeesOnlyWallsAtItsHeight) {  // z_min <= z < z_max, the rule of world::Segment
  const world::World world = room();
  sensors::LaserSettings laser;
  laser.fov = 0.1;
  laser.range_max = 30.0;
  EXPECT_NEAR(visible_points(world, {5.0, 2.0, 0.0, 0}, laser, 3)[1].x, 6.0, 1e-9);
  EXPECT_NEAR(visible_points(world, {5.0, 2.0, 1.0, 0}, laser, 3)[1].x, 35.0, 1e-9);
}

/// One robot along y = 2 from x = 1 to x = 5, stopped at its end.
Track straight() {
  Track track;
  track.name = "one";
  track.duration = 4.0;
  for (int i = 0; i <= 40; ++i) track.poses.push_back({1.0 + 0.1 * i, 2.0, 0, 0});
  return track;
}

Seen see_tracks(std::span<const Track> tracks, const std::string& name) {
  draw_trajectories(room(), tracks, scenes::own_file(name));
  return see(scenes::own_file(name), 0.03);
}

TEST(TrajectoryFigure, LineHasItsColour) {
  Track track = straight();
  track.color = 0xFFFF00FFu;
  const Seen seen = see_tracks({&track, 1}, "track.png");
  EXPECT_EQ(seen.at(3.03, 2.0), 0xFFFF00FFu);
  EXPECT_EQ(seen.at(3.03, 2.1), kWhite);
  EXPECT_EQ(seen.at(0.8, 2.1), kWhite);
  EXPECT_EQ(seen.at(5.0, 2.0), 0xFFFF00FFu) << "a disc at the end";
  EXPECT_EQ(seen.at(1.0, 2.0), kWhite) << "an open ring at the start";
}

TEST(TrajectoryFigure, ContactIsMarked) {
  Track track = straight();
  const Seen before = see_tracks({&track, 1}, "free.png");
  track.contacts.assign(track.poses.size(), 0);
  track.contacts[20] = track.contacts[21] = 1;
  const Seen after = see_tracks({&track, 1}, "stopped.png");
  EXPECT_NE(before.at(3.0, 2.0), after.at(3.0, 2.0));
  EXPECT_EQ(before.at(3.3, 2.0), after.at(3.3, 2.0)) << "the line next to it";
}

/// The arms of the cross extend beyond the dot and have a pale border on it.
TEST(TrajectoryFigure, ContactAtTheEndIsVisibleOnItsDot) {
  Track track = straight();
  track.color = 0xFFD4351Cu;  // the colour of the cross
  track.contacts.assign(track.poses.size(), 0);
  track.contacts.back() = 1;
  draw_trajectories(room(), {&track, 1}, scenes::own_file("at_the_end.png"));
  track.contacts.back() = 0;
  draw_trajectories(room(), {&track, 1}, scenes::own_file("free_end.png"));
  const scenes::Picture with = scenes::read_png(scenes::own_file("at_the_end.png")),
                        without = scenes::read_png(scenes::own_file("free_end.png"));
  int apart = 0;
  for (int y = without.height / 8; y < without.height; ++y)
    for (int x = 0; x < without.width; ++x) apart += with.at(x, y) != without.at(x, y) ? 1 : 0;
  EXPECT_GT(apart, 40);
}

TEST(TrajectoryFigure, PoseThatIsNotFiniteBreaksTheLine) {
  Track track = straight();
  track.color = 0xFFFF00FFu;
  for (std::size_t i = 18; i < 23; ++i) track.poses[i].x = std::numeric_limits<double>::quiet_NaN();
  const Seen seen = see_tracks({&track, 1}, "broken.png");
  for (const double x : {2.93, 3.07}) EXPECT_NE(seen.at(x, 2.0), 0xFFFF00FFu) << x;
  EXPECT_EQ(seen.at(2.33, 2.0), 0xFFFF00FFu);
}

/// The length of a path is the sum of its unbroken steps; a contact lasts until nothing stops the mover.
TEST(Track, LengthAndContactsOfABrokenPath) {
  Track track;
  track.poses = {
      {0, 0, 0, 0}, {1, 0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0}, {3, 0, 0, 0}, {3, 2, 0, 0}};
  track.contacts = {0, 1, 1, 0, 1};
  EXPECT_EQ(path_length(track), 3.0);
  EXPECT_EQ(contact_count(track), 2u);
}

TEST(TrajectoryFigure, LaterTracksAreOnTop) {
  Track tracks[] = {straight(), straight()};
  tracks[0].color = 0xFFFF0000u;
  tracks[1].color = 0xFF0000FFu;
  EXPECT_EQ(see_tracks(tracks, "over.png").at(3.03, 2.0), 0xFF0000FFu);
}

TEST(TrajectoryFigure, TracksBeyondTheWorldAreShown) {  // the figure grows with the tracks
  Track track = straight();
  track.poses.push_back({60.0, 2.0, 0, 0});
  draw_trajectories(room(), {&track, 1}, scenes::own_file("away.png"));
  const scenes::Picture p = scenes::read_png(scenes::own_file("away.png"));
  EXPECT_GT(p.width, 2 * p.height);
}

TEST(TrajectoryFigure, NoTrackAndEmptyTracksCanBeDrawn) {
  const auto is_bare = [&](std::span<const Track> tracks) {
    const Seen seen = see_tracks(tracks, "none.png");
    int other = 0;
    for (double x = 0.5; x < 5.5; x += 0.02)
      for (double y = 0.5; y < 3.5; y += 0.02) {
        const OklabColor lab = to_oklab(seen.at(x, y));
        other += std::hypot(lab.a, lab.b) > 0.02 || lab.lightness < 0.8 ? 1 : 0;
      }
    EXPECT_EQ(other, 0) << "the floor of a room, and the grid on it";
    EXPECT_LT(to_oklab(seen.at(3.2, 0.0)).lightness, 0.9) << "its wall";
  };
  is_bare({});
  is_bare(std::vector<Track>(30));
}

TEST(TrajectoryFigureDeathTest, ContactsMustMatchPoses) {
  Track track = straight();
  track.contacts.assign(3, 0);
  EXPECT_DEATH(draw_trajectories(room(), {&track, 1}, scenes::own_file("never.png")), "3 contacts for 41 poses");
}

TEST(OccupancyFigure, CellsHaveTheirColours) {
  const world::World world = room();
  maps::OccupancyGrid grid({world.extent.x_min, world.extent.y_max, 0.25, 7, 5});
  grid.set(maps::cell_at(grid.geometry, {3.125, 2.125}), maps::Cell::free);
  grid.set(maps::cell_at(grid.geometry, {6.125, 2.125}), maps::Cell::occupied);
  draw_occupancy(world, grid, scenes::own_file("grid.png"));
  const Seen seen = see(scenes::own_file("grid.png"), 0.0);
  EXPECT_EQ(seen.at(3.125, 2.125), 0xFFFEFEFEu) << "free";
  EXPECT_EQ(seen.at(-0.375, 2.125), 0xFFCDCDCDu) << "unknown";
  EXPECT_EQ(seen.at(6.125, 2.125), 0xFF000000u) << "occupied";
  draw_occupancy(world, grid, scenes::own_file("thesis.png"), {.map_colors = MapColors::thesis});
  const Seen thesis = see(scenes::own_file("thesis.png"), 0.0);
  EXPECT_EQ(thesis.at(3.125, 2.125), kWhite) << "free";
  EXPECT_EQ(thesis.at(-0.375, 2.125), 0xFF474B50u) << "unexplored";
  EXPECT_EQ(thesis.at(6.125, 2.125), 0xFF1748D1u) << "occupied";
}

TEST(OccupancyFigure, OneWordCanBeDrawn) {
  draw_occupancy({}, maps::OccupancyGrid({0, 1, 1.0, 1, 1}), scenes::own_file("cell.png"));
  const scenes::Picture p = scenes::read_png(scenes::own_file("cell.png"));
  EXPECT_GT(p.count(0xFFCDCDCDu), p.width * p.height / 2) << "unexplored";
}

TEST(Figures, ManyRobotsCanBeDrawn) {  // a single large case: 1000 robots in a world of 2000 segments
  const world::World world = scenes::make_world(80, 40, 500, 1000, 8.0);
  draw_world(world, scenes::own_file("many.png"));
  const scenes::Picture p = scenes::read_png(scenes::own_file("many.png"));
  EXPECT_EQ(p.width, 1600);
  EXPECT_GT(p.count(0xFF2E7D32u), 5 * 1000) << "of each robot's body a few pixels";
}

}  // namespace
}  // namespace sf::viz
