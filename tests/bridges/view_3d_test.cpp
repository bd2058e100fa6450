// Messages of the live view in three dimensions: clouds against poses worked out by hand, solids, and who gets them.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "bridges/scene_json.h"
#include "bridges/view_clouds.h"
#include "bridges/view_solids.h"
#include "record/cdr.h"
#include "sensors/laser.h"
#include "sensors/lidar.h"
#include "tests/bridges/player_client.h"
#include "tests/bridges/viewer_fixture.h"

namespace sf::bridges {

namespace {

struct SentCloud {
  std::uint32_t mover = 0, sensor = 0;
  bool planar = false;
  glm::dvec3 position;
  std::vector<glm::dvec3> points;  ///< in the world
  std::vector<float> intensities;
};

struct SentClouds {
  std::uint32_t stride = 0, tilts = 0;
  std::vector<SentCloud> clouds;
};

SentClouds read_clouds(const base::Bytes& message) {
  record::CdrReader cdr(message);
  SentClouds sent;
  for (int i = 0; i < 2; ++i) cdr.get<std::uint32_t>();  // stamp
  cdr.get_string();
  const auto vector = [&]<class T>(T) {
    const T x = cdr.get<T>(), y = cdr.get<T>(), z = cdr.get<T>();
    return glm::dvec3(x, y, z);
  };
  const glm::dvec3 origin = vector(0.0);
  sent.stride = cdr.get<std::uint32_t>();
  sent.tilts = cdr.get_count(20);
  for (std::uint32_t i = 0; i < sent.tilts; ++i) cdr.get<std::uint32_t>(), cdr.get<double>(), cdr.get<double>();
  sent.clouds.resize(cdr.get_count(20));
  for (SentCloud& cloud : sent.clouds) {
    cloud.mover = cdr.get<std::uint32_t>(), cdr.get<std::uint8_t>(), cloud.sensor = cdr.get<std::uint32_t>();
    cloud.planar = cdr.get<bool>();
    cloud.position = origin + vector(0.0F);
    for (std::uint32_t left = cdr.get_count(4) / 4; left > 0; --left) {
      cloud.points.push_back(origin + vector(0.0F));
      cloud.intensities.push_back(cdr.get<float>());
    }
  }
  EXPECT_TRUE(cdr.good());
  EXPECT_EQ(cdr.left(), 0u);
  return sent;
}

/// Clouds of hand-made readings in a world.
struct CloudRun {
  explicit CloudRun(const std::string& text)
      : world(player::load_text(text)), sensor_set(world), clouds({world, sensor_set, info}) {}
  base::Bytes encode(base::TickRecord tick = {}) {
    base::Bytes out;
    clouds.encode(tick, out);
    return out;
  }
  void add(const base::ReadingBlock& reading, std::int64_t time = 0) {
    clouds.add({.time = time, .readings = {&reading, 1}});
  }
  SentCloud one(const base::ReadingBlock& reading) {
    add(reading);
    const SentClouds sent = read_clouds(encode());
    EXPECT_EQ(sent.clouds.size(), 1u);
    return sent.clouds.empty() ? SentCloud{} : sent.clouds[0];
  }

  world::World world;
  sensors::SensorSet sensor_set;
  record::RunInfo info;
  ViewClouds clouds;
};

constexpr const char* kFourBeams =
    "position( name \"r\" pose [0 0 0 0] size [0.4 0.4 0.2] origin [0 0 0 0]\n"
    "lidar( elevations [0] columns 4 range [1 10] pose6 [0 0 0.3 0 0 0] size [0.1 0.1 0] ) )\n";

void expect_point(glm::dvec3 found, glm::dvec3 expected) {
  EXPECT_NEAR(glm::distance(found, expected), 0.0, 1e-5) << found.x << " " << found.y << " " << found.z;
}

std::string text_of(const base::Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

/// Four beams, from behind counter-clockwise: backward, right, forward, left.
TEST(ViewClouds, EchoesAreAtTheirPlaces) {
  CloudRun run(kFourBeams);
  const std::vector<double> ranges{2.0, 3.0, 4.0, 5.0};
  const double height = run.sensor_set.of(sensors::kLidar, 0)[0].X_MS.z;
  base::ReadingBlock reading{.type = sensors::kLidar, .X_WM = {10.0, 20.0, 1.0, M_PI / 2}, .values = ranges};
  const SentCloud level = run.one(reading);
  ASSERT_EQ(level.points.size(), 4u);
  EXPECT_FALSE(level.planar);
  const double z = level.position.z;
  EXPECT_NEAR(z, 1.0 + height, 0.5);  // pose6 is in the frame of the model
  expect_point(level.points[0], {10.0, 18.0, z});
  expect_point(level.points[2], {10.0, 24.0, z});
  expect_point(level.points[1], {5.0, 20.0, z});  // steps of 3 of 4 beams
  EXPECT_EQ(level.intensities[0], -1.0F) << "not reported";
  reading.tilt.pitch = M_PI / 2;  // the nose is down, and the mount in front
  const SentCloud down = run.one(reading);
  expect_point(down.points[2], {10.0, 20.0 + z - 1.0, 1.0 - 4.0});
  expect_point(down.points[1], {5.0, 20.0 + z - 1.0, 1.0});
}

TEST(ViewClouds, OnlyEchoesWithinTheLimitsAreSent) {
  CloudRun run(kFourBeams);
  const std::vector<double> ranges{1.0, std::nextafter(10.0, 0.0), 10.0, 1.0};  // the limits are [1, 10)
  const std::vector<base::QualityFlag> near{{}, {}, {}, base::QualityFlag::too_near};
  EXPECT_EQ(run.one({.type = sensors::kLidar, .values = ranges, .quality = near}).points.size(), 2u);
  const std::vector<double> nothing(4, 10.0);
  EXPECT_EQ(run.one({.type = sensors::kLidar, .values = nothing}).points.size(), 0u) << "sent, to replace the last one";
  EXPECT_TRUE((run.add({.type = sensors::kLidar, .X_WM = base::kAbsent, .values = ranges}), read_clouds(run.encode()))
                  .clouds.empty());
  EXPECT_TRUE((run.add({.type = 63, .values = ranges}), read_clouds(run.encode())).clouds.empty()) << "unknown type";
}

/// 32 bits relative to the world's middle: a tenth of a millimetre, where absolute coordinates would have 6 cm.
TEST(ViewClouds, FarFromTheOriginPointsAreExact) {
  CloudRun run(
      "model( name \"far\" pose [1000000 0 0 0] size [2 2 2] )\nposition( pose [1000005 0 0 0] size [0.4 0.4 0.2] "
      "laser( samples 3 fov 180 range_max 8 ) )\n");
  const std::vector<double> ranges{1.0, 2.0123, 8.0};
  const SentCloud cloud = run.one({.type = sensors::kLaser, .X_WM = {1000005.0, 0.0, 0.0, 0.0}, .values = ranges});
  ASSERT_EQ(cloud.points.size(), 2u);
  EXPECT_TRUE(cloud.planar);
  EXPECT_NEAR(cloud.points[1].x - cloud.position.x, 2.0123, 1e-5);
  EXPECT_NEAR(cloud.points[0].y - cloud.position.y, -1.0, 1e-5);
}

TEST(ViewClouds, IntensitiesAreTheSecondColumn) {
  std::string text = kFourBeams;
  text.insert(text.find("columns"), "intensity 1 ");
  CloudRun run(text);
  const std::vector<double> values{2.0, 0.25, 10.0, 0.0, 4.0, 0.75, 5.0, 1.0};
  EXPECT_EQ(run.one({.type = sensors::kLidar, .values = values}).intensities, (std::vector<float>{0.25F, 1.0F, 0.75F}));
}

/// Viewers get some ticks only: every sensor's newest echoes are sent once, those of an earlier run never.
TEST(ViewClouds, TheNewestEchoesAreKept) {
  CloudRun run(std::string(kFourBeams) + kFourBeams + "position( name \"third\" pose [3 0 0 0] )");
  const std::vector<double> first{2.0, 2.0, 2.0, 2.0}, second{3.0, 3.0, 3.0, 3.0};
  run.add({.mover = 0, .type = sensors::kLidar, .values = first}, 100);
  run.add({.mover = 1, .type = sensors::kLidar, .values = first}, 200);
  run.add({.mover = 0, .type = sensors::kLidar, .values = second}, 300);
  const SentClouds sent = read_clouds(run.encode());
  ASSERT_EQ(sent.clouds.size(), 2u);
  expect_point(sent.clouds[0].points[2] - sent.clouds[0].position, {3.0, 0.0, 0.0});
  EXPECT_TRUE(read_clouds(run.encode()).clouds.empty()) << "sent once";
  run.add({.mover = 0, .type = sensors::kLidar, .values = first}, 400);
  run.add({.mover = 1, .type = sensors::kLidar, .values = first}, 0);  // restarted
  ASSERT_EQ(read_clouds(run.encode()).clouds.size(), 1u);
  std::vector<base::Report> reports(3);
  reports[1].tilt.roll = 0.1, reports[2].tilt.roll = 0.1, reports[2].X_WM = base::kAbsent;
  EXPECT_EQ(read_clouds(run.encode({.reports = reports})).tilts, 1u) << "neither level nor absent ones";
}

/// The bound holds for all sensors together; without need, every beam is sent once.
TEST(ViewClouds, LargeScansAreThinnedOut) {
  std::string text;
  for (int i = 0; i < 5; ++i) text += "position( lidar( channels 64 columns 1024 range [0 100] ) )\n";
  CloudRun run(text);
  EXPECT_EQ(run.clouds.stride(), 5u);
  const std::vector<double> ranges(64 * 1024, 5.0);
  const SentCloud cloud = run.one({.mover = 4, .type = sensors::kLidar, .values = ranges});
  EXPECT_EQ(cloud.points.size(), (ranges.size() + 4) / 5);
  EXPECT_LE(5 * cloud.points.size(), kMostViewPoints + 5);
  CloudRun few("position( lidar( channels 2 columns 30 range [0 100] ) )\n");
  EXPECT_EQ(few.clouds.stride(), 1u);
  std::vector<double> different(60);
  std::iota(different.begin(), different.end(), 1.0);
  std::set<long> found;
  const SentCloud all = few.one({.type = sensors::kLidar, .values = different});
  for (const glm::dvec3& p : all.points) found.insert(std::lround(glm::distance(p, all.position)));
  EXPECT_EQ(found.size(), 60u);
}

TEST(ViewSolids, BoxesHaveSidesTopAndBottom) {
  const world::World world = player::load_text("model( name \"box\" pose [3 0 0.5 0] size [1 1 2] color \"red\" )");
  const base::Bytes message = solids_message(world, headroom_of(world));
  record::CdrReader cdr(message);
  EXPECT_EQ(cdr.get_string(), "") << "nothing is left out";
  ASSERT_EQ(cdr.get_count(4), 1u);
  EXPECT_EQ(cdr.get_string(), "solid");
  std::vector<float> vertices(cdr.get_count(4));
  for (float& v : vertices) v = cdr.get<float>();
  float low = 9.0F, high = -9.0F;
  for (std::size_t i = 2; i < vertices.size(); i += 3)
    low = std::min(low, vertices[i]), high = std::max(high, vertices[i]);
  EXPECT_EQ(low, 0.5F);
  EXPECT_EQ(high, 2.5F);
  std::vector<std::uint32_t> corners(cdr.get_count(4));
  EXPECT_EQ(corners.size(), 3u * 2u * 6u) << "two triangles per face";
  for (std::uint32_t& corner : corners) EXPECT_LT(corner = cdr.get<std::uint32_t>(), vertices.size() / 3);
  ASSERT_EQ(cdr.get_count(4), 1u);
  EXPECT_EQ(cdr.get<std::uint32_t>(), world::kNone);
  EXPECT_NEAR(cdr.get<double>() + vertices[0], 3.0, 0.5 + 1e-6) << "placed in the world";
  for (int i = 0; i < 3; ++i) cdr.get<double>();
  EXPECT_EQ(cdr.get<std::uint32_t>(), 0xFFFF0000u);
  EXPECT_TRUE(cdr.good() && cdr.left() == 0);
}

/// Meshes within the bound replace outlines, here and in /scene.json. Those beyond it stay prisms, with a note.
TEST(ViewSolids, MeshesAreBounded) {
  world::World world = player::load_text(
      "model( name \"tree\" size [1 1 2] )\nmodel( name \"bush\" pose [4 0 0 0] size [1 1 1] )\nposition( name \"r\" "
      ")");
  const std::uint32_t robot = world.movers[0].model;
  std::vector<std::uint32_t> corners(3 * kMostViewTriangles);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i % 3);
  const std::vector<glm::dvec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 1}};
  world.meshes = {{"small", vertices, {0, 1, 2}}, {"large", vertices, corners}};
  world.mesh_models = {{0, 0, {}}, {1, 1, {}}, {0, robot, {}}};
  EXPECT_EQ(models_in_view_as_mesh(world), (std::vector<std::uint8_t>{1, 0, 1}));
  const std::string text = text_of(solids_message(world, headroom_of(world)));
  EXPECT_NE(text.find("1 models as prisms"), std::string::npos);
  EXPECT_LT(text.size(), 2000u);
  const sensors::SensorSet sensor_set(world);
  const record::RunInfo info = ViewerFixture::run_info_of(world);
  const auto flagged = [&] {
    return scene_json({world, sensor_set, info}, ViewerMode::run).find(",1]]") != std::string::npos;
  };
  EXPECT_TRUE(flagged()) << "no prism of the robot";
  world.meshes[0].corners = corners, world.meshes[1].corners = {0, 1, 2};  // the first fills the bound exactly
  EXPECT_EQ(models_in_view_as_mesh(world), (std::vector<std::uint8_t>{1, 0, 1}));
  world.meshes[0].corners.insert(world.meshes[0].corners.end(), {0, 1, 2});
  EXPECT_EQ(models_in_view_as_mesh(world), (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_FALSE(flagged());
}

/// Both ends of a side are points of it, whatever the step.
TEST(ViewSolids, LargeTerrainIsThinnedOut) {
  for (const std::uint32_t columns : {2u, 1000u, 1001u, 16'384u}) {
    world::World world;
    world.terrain = {{.cell = {2.0, 1.0}, .columns = columns, .rows = 100}};
    world.terrain[0].heights.assign(std::size_t{100} * columns, 0.5F);
    world.terrain[0].heights.back() = 7.0F;
    const base::Bytes message = solids_message(world, 1.0);
    record::CdrReader cdr(message);
    EXPECT_EQ(cdr.get_string(), columns <= 1000   ? ""
                                : columns == 1001 ? "terrain in steps of 2 points"
                                                  : "terrain in steps of 5 points");
    EXPECT_EQ(cdr.get_count(4), 1u);
    EXPECT_EQ(cdr.get_string(), "terrain");
    std::vector<float> vertices(cdr.get_count(4));
    for (float& v : vertices) v = cdr.get<float>();
    EXPECT_LE(vertices.size(), 3 * kMostViewHeights) << columns;
    const std::vector<float> last(vertices.end() - 3, vertices.end());
    EXPECT_EQ(last, (std::vector<float>{2.0F * static_cast<float>(columns - 1), 99.0F, 7.0F})) << columns;
  }
}

/// With the states of their tick; those of the last tick hold until the next ones.
TEST(ViewIntents, AreSentToTheirSubscribers) {
  ViewerFixture fixture;
  const int topic = static_cast<int>(record::TickMessages(fixture.info).topics().size()) + 2;
  Watcher watcher(fixture);
  EXPECT_NE(watcher.greeting.find("\"topic\":\"/view/intents\""), std::string::npos);
  watcher.subscribe(7, topic);
  watcher.settle();
  const base::Intent intents[] = {{.follows = 0x04030201}};
  fixture.viewer->show_intents(intents);
  fixture.tick(1);
  const std::string message = watcher.receive_binary(1);
  EXPECT_EQ(subscription_tick(message), "7@1");
  EXPECT_NE(message.find(std::string("\1\2\3\4", 4)), std::string::npos);
}

/// Plan viewers get nothing of it; the solids are made once, for the first subscriber.
TEST(View3d, IsSentToItsSubscribersOnly) {
  ViewerFixture fixture;
  const int clouds = static_cast<int>(record::TickMessages(fixture.info).topics().size());
  Watcher plan(fixture, {"/fleet"}), third(fixture);
  EXPECT_NE(plan.greeting.find("\"topic\":\"/view_3d/clouds\""), std::string::npos);
  third.subscribe(7, clouds + 1);
  EXPECT_EQ(third.receive_binary(1).substr(0, 4), std::string("\7\0\0\0", 4)) << "at once";
  third.subscribe(8, clouds);
  third.settle();
  fixture.tick(1);
  EXPECT_EQ(subscription_tick(third.receive_binary(1)), "8@1");
  EXPECT_EQ(subscription_tick(plan.receive_binary(1)), "101@1");
  fixture.tick(2);
  EXPECT_EQ(subscription_tick(plan.receive_binary(1)), "101@2") << "nothing in between";
}

}  // namespace sf::bridges
