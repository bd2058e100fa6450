// Reports that are valid on the wire but impossible for a robot: the tick continues, and every scan equals the
// brute-force reference, beam by beam, for both casters and any number of threads.

#include <gtest/gtest.h>

#include <cmath>

#include "raycast/casters.h"
#include "robots/fleet.h"
#include "sensors/laser.h"
#include "sensors/laser_reference.h"
#include "sensors/sensor_type.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/chance.h"

namespace sf::farm {
namespace {

constexpr double kFarthest = 1e7;  // [m] limit of packets
constexpr double kFastest = 1e3;   // [m/s], [rad/s]

/// An awkward coordinate: next to, exactly on or between known ones, to the last bit, or at the limit of packets.
double odd_coordinate(trial::Chance& chance, double known) {
  switch (chance.below(8)) {
    case 0:
      return known;
    case 1:
      return std::nextafter(known, chance.below(2) == 0 ? -1e9 : 1e9);
    case 2:
      return known + chance.between(-1e-9, 1e-9);
    case 3:
      return 0.0;
    case 4:
      return chance.below(2) == 0 ? kFarthest : -kFarthest;
    case 5:
      return chance.between(-kFarthest, kFarthest);
    case 6:
      return 1e-310;
    default:
      return known + chance.between(-3.0, 3.0);
  }
}

base::Report odd_report(trial::Chance& chance, const world::World& world, std::int64_t now) {
  const auto mover = chance.below(static_cast<std::uint32_t>(world.movers.size()));
  // Near a corner of a wall, another mover, or the mover's own position at load.
  const base::Pose& other = world.movers[chance.below(static_cast<std::uint32_t>(world.movers.size()))].X_WM;
  glm::dvec2 known{other.x, other.y};
  if (!world.walls.empty() && chance.below(2) == 0)
    known = world.walls[chance.below(static_cast<std::uint32_t>(world.walls.size()))].a;
  base::Report report{mover, now - chance.below(3) * 100'000'000ll, {}, {}};
  report.X_WM = {odd_coordinate(chance, known.x), odd_coordinate(chance, known.y), odd_coordinate(chance, 0.0),
                 chance.below(4) == 0 ? 1e15 : chance.between(-10.0, 10.0)};
  const auto speed = [&] { return chance.below(3) == 0 ? chance.between(-kFastest, kFastest) : 0.0; };
  report.velocity = {speed(), speed(), speed()};
  return report;
}

void expect_sound(const sensors::LaserReference& reference, const base::ReadingBlock& reading) {
  for (const double value : reading.values) ASSERT_FALSE(std::isinf(value)) << reading.mover;
  if (reading.type != sensors::kLaser) return;
  const auto scan = reference.scan(reading.mover, reading.sensor, reading.sequence);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    ASSERT_TRUE(reading.values[i] == scan.ranges[i] && reading.hits[i] == scan.hits[i])
        << "mover " << reading.mover << " at (" << reading.X_WS.x << ", " << reading.X_WS.y << "; " << reading.X_WS.yaw
        << "), beam " << i << ": " << reading.values[i] << " m of " << reading.hits[i] << ", expected "
        << scan.ranges[i] << " m of " << scan.hits[i];
}

/// @return the hash of all readings
std::uint64_t under_siege(const world::World& world, std::uint64_t seed, unsigned threads,
                          const raycast::CasterType* caster) {
  trial::Chance chance(seed);
  Farm farm(world, device(), {.true_poses = false, .threads = threads, .scene = {.caster = caster}});
  robots::Fleet fleet(world);
  sensors::LaserReference reference(world, 0);
  std::vector<std::uint8_t> gone(world.movers.size());
  farm.subscribe_all();
  std::vector<base::Report> reports;
  std::int64_t now = 0;
  for (int tick = 0; tick < 40; ++tick) {
    reports.clear();
    const std::uint32_t count = chance.below(2 * static_cast<std::uint32_t>(world.movers.size()));
    for (std::uint32_t i = 0; i < count; ++i) reports.push_back(odd_report(chance, world, now));
    // Occasionally all reports have the same position.
    if (tick % 7 == 3)
      for (base::Report& report : reports) report.X_WM = reports[0].X_WM;
    fleet.apply(reports);
    const auto row = chance.below(static_cast<std::uint32_t>(world.movers.size()));
    gone[row] = chance.below(2) == 0 ? 1 : 0;
    farm.set_absent(row, gone[row] != 0);
    fleet.set_absent(row, gone[row] != 0);
    farm.subscribe(row, chance.below(2) == 0 ? kAllSensorTypes : 0);
    const auto states = fleet.predict(now);
    std::vector<base::Pose> poses;
    for (const base::Report& state : states)
      poses.push_back(gone[state.mover] != 0 ? base::Pose{std::nan(""), 0.0, 0.0, 0.0} : state.X_WM);
    reference.set_poses(poses);
    for (const base::ReadingBlock& reading : farm.tick(now, states)) expect_sound(reference, reading);
    now += std::int64_t{chance.below(4)} * 50'000'000 + (tick % 10 == 9 ? 3'600'000'000'000ll : 0);
  }
  return farm.hash();
}

void expect_the_same_from_all(const world::World& world, std::uint64_t seed) {
  const std::uint64_t hash = under_siege(world, seed, 2, &raycast::host_caster);
  EXPECT_EQ(under_siege(world, seed, 1, &raycast::host_caster), hash) << "one thread";
  EXPECT_EQ(under_siege(world, seed, 2, &raycast::device_caster), hash) << "kernels on the device";
}

TEST(HostileStates, MatchTheReferenceAmongBoxes) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) expect_the_same_from_all(small_world(30), seed);
}

/// All sensor types, road, lights and magnets.
TEST(HostileStates, MatchTheReferenceInSimVille) {
  const world::World world =
      world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world", {.sensors = sensors::world_file_words()});
  for (const std::uint64_t seed : {4u, 5u}) expect_the_same_from_all(world, seed);
}

}  // namespace
}  // namespace sf::farm
