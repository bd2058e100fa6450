// Mirrored packets of readings, and the lines drawn from them.

#include "server/mirrored_readings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "netio/packets.h"
#include "sensors/laneedge_settings.h"
#include "sensors/laser.h"
#include "sensors/occupancy.h"
#include "tests/sensors/scenes.h"
#include "tests/units.h"

namespace sf::server {
namespace {

using Kind = SightLine::Kind;

world::World with_sensors(double least, double most) {
  world::World world;
  scenes::add_room(world, {0.0, 0.0}, 8.0);
  const std::uint32_t robot = scenes::add_robot(world, {0.0, 0.0, 0.0, 0.0}, {});
  world::Sensor laser{.type = "laser", .name = "laser", .X_MS = {0.1, 0.0, 0.0, 0.0}, .height = 0.2};
  laser.settings = {{"samples", {5}, ""}, {"fov", {M_PI}, ""}, {"range", {least, most}, ""}};
  world::Sensor edge{.type = "laneedge", .name = "edge", .X_MS = {0.0, 0.0, 0.0, M_PI / 2}};
  world::Sensor map{.type = "occupancy", .name = "map"};  // 8 x 8 cells from (-1, 2) to (1, 0)
  map.settings = {{"cell", {0.25}, ""}, {"words", {2, 2}, ""}, {"offset", {1.0, -2.0}, ""}, {"rate", {2.0}, ""}};
  world.movers[robot].sensors = {laser, edge, map};
  return world;
}

struct MirroredReadingsTest : testing::Test {
  explicit MirroredReadingsTest(double least = 0.0, double most = 4.0) : world(with_sensors(least, most)) {}
  base::Bytes packet(std::uint8_t type, const std::vector<double>& values, std::uint32_t sequence = 0) const {
    base::ReadingBlock block;
    block.type = type, block.values = values;
    const sensors::SensorType& sensor_type = *sensor_set.group(type)->type;
    base::Bytes payload, bytes;
    const std::uint8_t packet_type =
        sensor_type.encode(sensor_set.row(block), block, sensors::WireFormat::farm, 0, payload);
    netio::Header header;
    header.robot = static_cast<std::uint16_t>(world.movers[0].id);
    header.sequence = sequence;
    netio::encode_reading(header, packet_type, payload, bytes);
    return bytes;
  }
  std::vector<SightLine> lines(const base::Pose& X_WM, std::int64_t now = 0) const {
    std::vector<SightLine> all;
    readings.add_lines(0, X_WM, now, all);
    return all;
  }
  const world::World world;
  const sensors::SensorSet sensor_set{world};
  MirroredReadings readings{world, sensor_set};
};

/// Limits that are not whole millimetres: 4.0004 is sent as 4000, 0.2036 as 204.
struct OddLimits : MirroredReadingsTest {
  OddLimits() : MirroredReadingsTest(0.2036, 4.0004) {}
};

void expect_near(glm::dvec2 p, glm::dvec2 q) { EXPECT_NEAR(glm::distance(p, q), 0.0, 2e-3) << p.x << " " << p.y; }

}  // namespace

TEST_F(MirroredReadingsTest, BeamsStartAtTheSensorOfTheirRobot) {
  EXPECT_TRUE(lines({}).empty()) << "no reading arrived";
  readings.accept(packet(sensors::kLaser, {1.0, 1.0, 4.0, 2.0, 2.0}), 0);
  const auto all = lines({2.0, 3.0, 0.0, M_PI / 2});  // the robot faces +y
  ASSERT_EQ(all.size(), 7u) << "five beams, and echoes on each side of the one without";
  for (const SightLine& line : all) EXPECT_DOUBLE_EQ(line.z, sensor_set.of(sensors::kLaser, 0)[0].X_MS.z);
  expect_near(all[0].points[0], {2.0, 3.1});
  expect_near(all[0].points[1], {3.0, 3.1});  // the first beam points to the right
  const auto echoes = std::count_if(all.begin(), all.end(), [](const SightLine& line) {
    return line.kind == Kind::echoes && line.points.size() == 2;
  });
  EXPECT_EQ(echoes, 2);
}

/// The third beam passes the near surface that the first two hit.
TEST_F(MirroredReadingsTest, EchoesOfTwoSurfacesAreTwoLines) {
  readings.accept(packet(sensors::kLaser, {0.1, 0.1, 3.0, 3.0, 3.0}), 0);
  std::vector<std::size_t> sizes;
  for (const SightLine& line : lines({}))
    if (line.kind == Kind::echoes) sizes.push_back(line.points.size());
  EXPECT_EQ(sizes, (std::vector<std::size_t>{2, 3}));
}

TEST_F(OddLimits, ProduceNoEchoes) {
  readings.accept(packet(sensors::kLaser, {4.0004, 4.0004, 0.2036, 0.2036, 4.0004}), 0);
  for (const SightLine& line : lines({})) EXPECT_EQ(line.kind, Kind::beam);
}

TEST_F(MirroredReadingsTest, EdgesArePerpendicularToTheirMeasurement) {
  readings.accept(packet(sensors::kLaneEdge, {0.5, 30, 0.0, 0.0}), 0);
  const auto all = lines({1.0, 0.0, 0.0, 0.0});
  ASSERT_EQ(all.size(), 2u);
  expect_near(all[0].points[1], {1.0, 0.5});  // to the left
  EXPECT_EQ(all[1].kind, Kind::lane_edge);
  EXPECT_NEAR(all[1].points[0].y, 0.5, 2e-3);
  EXPECT_NEAR(all[1].points[1].y, 0.5, 2e-3);
  EXPECT_NEAR(glm::distance(all[1].points[0], all[1].points[1]), 0.3, 1e-9);
  readings.accept(packet(sensors::kLaneEdge, {kNaN, 0, 0.0, 0.0}, 1), 0);
  EXPECT_TRUE(lines({}).empty()) << "no edge in sight";
}

TEST_F(MirroredReadingsTest, OldReadingsAreNotDrawn) {
  readings.accept(packet(sensors::kLaser, {1.0, 1.0, 1.0, 1.0, 1.0}), 0);
  EXPECT_FALSE(lines({}, MirroredReadings::kFresh).empty());
  EXPECT_TRUE(lines({}, MirroredReadings::kFresh + 1).empty());
}

/// Two free cells and an occupied one next to them, in the upper left corner of the map.
TEST_F(MirroredReadingsTest, MapsAreDrawnByTheBordersOfTheirCells) {
  const auto maps = [&](std::int64_t now = 0) {
    std::vector<SightLine> all;
    readings.add_maps(now, all);
    return all;
  };
  EXPECT_TRUE(maps().empty());
  readings.accept(packet(sensors::kOccupancy, {2.0 + 4 * 2.0 + 16 * 1.0, 0.0, 0.0, 0.0}), 0);
  const auto all = maps();
  ASSERT_EQ(all.size(), 8u) << "two rectangles";
  EXPECT_EQ(all[0].kind, Kind::explored);
  EXPECT_EQ(all[0].points, (std::vector<glm::dvec2>{{-1.0, 2.0}, {-0.25, 2.0}}));
  EXPECT_EQ(all[4].kind, Kind::occupied);
  EXPECT_EQ(all[4].points, (std::vector<glm::dvec2>{{-0.5, 2.0}, {-0.25, 2.0}}));
  EXPECT_EQ(all[7].points, (std::vector<glm::dvec2>{{-0.25, 2.0}, {-0.25, 1.75}}));
  constexpr std::int64_t kLast = MirroredReadings::kFresh + 1'500'000'000;  // three periods
  EXPECT_EQ(maps(kLast).size(), 8u);
  EXPECT_TRUE(maps(kLast + 1).empty());
  readings.accept(packet(sensors::kOccupancy, {0.0, 0.0, 0.0, 2.0}, 1), kLast);
  ASSERT_EQ(maps(kLast).size(), 4u) << "the new map replaces the old one";
  EXPECT_EQ(maps(kLast)[0].points, (std::vector<glm::dvec2>{{0.0, 1.0}, {0.25, 1.0}}));
}

TEST_F(MirroredReadingsTest, AnyBytesAreAccepted) {
  const base::Bytes good = packet(sensors::kLaser, {1.0, 1.0, 1.0, 1.0, 1.0});
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    base::Bytes bytes = good;
    bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(random() % (bytes.size() + 1));
    readings.accept(bytes, 0);
  }
  const std::uint64_t before = readings.unknown();
  readings.accept({}, 0);
  EXPECT_EQ(readings.unknown(), before + 1);
  for (const SightLine& line : lines({}))
    for (const glm::dvec2& p : line.points) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
}

}  // namespace sf::server
