// A fleet measured in parts: the hash of all readings equals that of one farm.

#include "farm/shared_hash.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "sensors/own_sensors.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/host_trial.h"
#include "tests/sensors/series.h"

namespace sf::farm {
namespace {

/// Prompt and late sensors, at three rates without a common tick.
world::World mixed_world() {
  world::World world = small_world(7, {.range_sigma = 0.01});
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    scenes::edit_laser(world.movers[m])->rate = m % 3 == 0 ? 10.0 : m % 3 == 1 ? 33.0 : 7.0;
    scenes::edit_laser(world.movers[m])->latency = m % 2 == 0 ? 0.0 : 0.013 * m;
  }
  return world;
}

/// Reports with their time, between which states are interpolated.
std::vector<base::Report> timed_reports(const world::World& world, int tick) {
  std::vector<base::Report> reports = reports_at(world, tick);
  for (base::Report& report : reports) report.time = tick * 100'000'000LL;
  return reports;
}

std::span<const base::ReadingBlock> step(Farm& farm, const world::World& world, int tick) {
  const auto reports = timed_reports(world, tick);
  for (std::int64_t due = farm.next_due(); due < tick * 100'000'000LL; due = farm.next_due())
    farm.sample_between(due, reports);
  return farm.tick(tick * 100'000'000LL, reports);
}

/// @param parts number of farms; farm m % parts measures mover m @param silent whether the last part owns no mover
std::uint64_t hash_of_parts(const world::World& world, unsigned parts, bool silent) {
  std::vector<std::unique_ptr<Farm>> farms;
  const unsigned all = parts + (silent ? 1 : 0);
  for (unsigned part = 0; part < all; ++part) {
    farms.push_back(std::make_unique<Farm>(world, device(), FarmOptions{.seed = 3, .shared = true}));
    farms.back()->subscribe_all();
    for (std::uint32_t m = 0; m < world.movers.size(); ++m)
      if (m % parts != part) farms.back()->sharing().leave_to_others(m);
  }
  for (int k = 0; k < 12; ++k) {
    std::vector<base::Bytes> written(all);
    for (unsigned part = 0; part < all; ++part) {
      step(*farms[part], world, k);
      farms[part]->sharing().write_hashes(written[part]);
    }
    std::vector<base::ByteReader> readers(written.begin(), written.end());
    farms[0]->sharing().add_hashes(readers);
    for (const base::ByteReader& reader : readers) EXPECT_EQ(reader.left(), 0u);
  }
  return farms[0]->hash();
}

TEST(SharedHash, EqualsTheHashOfOneFarm) {
  const world::World world = mixed_world();
  Farm alone(world, device(), {.seed = 3});
  alone.subscribe_all();
  for (int k = 0; k < 12; ++k) step(alone, world, k);
  for (const unsigned parts : {1u, 2u, 3u, 7u}) EXPECT_EQ(hash_of_parts(world, parts, false), alone.hash()) << parts;
  EXPECT_EQ(hash_of_parts(world, 2, true), alone.hash()) << "a part without robots samples at the same times";
}

TEST(SharedHash, DetectsAMissingReading) {
  const world::World world = mixed_world();
  Farm alone(world, device(), {.seed = 3, .shared = true});
  alone.subscribe_all();
  Farm part(world, device(), {.seed = 3, .shared = true});
  part.subscribe_all();
  part.sharing().leave_to_others(2);
  std::uint64_t hashes[2];
  for (Farm* farm : {&alone, &part}) {
    step(*farm, world, 0);
    base::Bytes written;
    farm->sharing().write_hashes(written);
    std::vector<base::ByteReader> readers{base::ByteReader(written)};
    farm->sharing().add_hashes(readers);
    hashes[farm == &part] = farm->hash();
  }
  EXPECT_NE(hashes[0], hashes[1]);
}

/// Adds a custom sensor type, whose id is above that of maps.
void add_still_type() {
  if (sensors::find_sensor_type(31) != nullptr) return;  // types remain for the whole program
  struct Still : sensorfarm::Sensor {
    std::uint32_t elements() const override { return 1; }
    void read(const sensorfarm::Measurement&, std::span<double> values) const override { values[0] = 0.0; }
  };
  const auto make = [](const auto&, const auto&) { return std::make_unique<Still>(); };
  sensors::add_own_sensor({.name = "still", .id = 26, .columns = {{"zero", 1.0}}, .rate = 10.0, .make = make}, "test");
}

/// Keys order readings like `Delivery`, call by call.
void expect_order(const world::World& world) {
  Farm farm(world, device(), {.seed = 3});
  farm.subscribe_all();
  const ReadingOrder order(farm.sensor_set());
  ReadingOrder::Key last{-1, 0};
  std::size_t readings = 0;
  for (int k = 0; k < 12; ++k) {
    const auto reports = timed_reports(world, k);
    const auto check = [&](std::span<const base::ReadingBlock> delivered) {
      for (const base::ReadingBlock& r : delivered) {
        const auto key = order.key(order.sensor_of(r.type, r.mover, r.sensor), r.time);
        EXPECT_LT(last, key) << "type " << int{r.type} << " of mover " << r.mover << " at " << r.time;
        last = key;
        ++readings;
      }
    };
    for (std::int64_t due = farm.next_due(); due < k * 100'000'000LL; due = farm.next_due())
      check(farm.sample_between(due, reports));
    check(farm.tick(k * 100'000'000LL, reports));
  }
  EXPECT_GT(readings, 30u);
}

TEST(ReadingOrder, PutsMapsAfterAllOtherTypes) {
  add_still_type();
  world::World world = mixed_world();
  for (world::Mover& mover : world.movers)
    for (const char* type : {"occupancy", "still"}) mover.sensors.push_back(trial::fitted(type));
  expect_order(world);
}

TEST(ReadingOrder, PutsDerivedSensorsLast) {
  // By wire id, the aggregate would be before the altimeter; the map is computed from the laser.
  const std::string text =
      "position( laser( samples 5 ) altimeter( ) occupancy( ) derived( type \"aggregate\" inputs [\"altimeter\"] "
      "quantity \"height_m\" rate 10 ) )";
  expect_order(trial::world_of(text));
}

/// Late readings that are due at the same time are ordered by robot, then by type, then by sensor, and precede all
/// others.
TEST(ReadingOrder, OrdersLateReadingsByRobotTypeAndSensor) {
  world::World world = small_world(3, {});
  for (world::Mover& mover : world.movers) {
    mover.sensors.clear();
    for (const char* type : {"sonar", "infrared", "sonar", "infrared"})
      mover.sensors.push_back(trial::fitted(type, {trial::setting("latency", {0.05})}));
    mover.sensors.push_back(trial::fitted("bumper"));
  }
  const sensors::SensorSet sensor_set(world);
  const ReadingOrder order(sensor_set);
  struct Row {
    bool prompt;
    std::uint32_t mover;
    std::uint8_t type;
    std::uint32_t sensor;
    auto operator<=>(const Row&) const = default;
  };
  std::map<Row, ReadingOrder::Key> keys;
  for (const auto& group : sensor_set.groups())
    for (const auto& row : group.rows) {
      const std::uint32_t number = order.sensor_of(group.type->id, row.mover, row.sensor);
      EXPECT_EQ(order.is_late(number), row.latency > 0.0);
      const std::int64_t time = row.latency > 0.0 ? 50'000'000 : 100'000'000;  // all readings are due at 0.1 s
      keys[{row.latency == 0.0, row.mover, group.type->id, row.sensor}] = order.key(number, time);
    }
  ASSERT_EQ(keys.size(), 15u);
  EXPECT_EQ(order.sensors(), 15u);
  ReadingOrder::Key last{-1, 0};
  for (const auto& [row, key] : keys) {
    EXPECT_EQ(key.due, 100'000'000);
    EXPECT_LT(last, key) << "mover " << row.mover << ", type " << int{row.type} << ", sensor " << row.sensor;
    last = key;
  }
}

}  // namespace
}  // namespace sf::farm
