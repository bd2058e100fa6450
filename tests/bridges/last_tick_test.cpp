// Ticks stored for viewers of a paused run.

#include <gtest/gtest.h>

#include "bridges/last_tick.h"

namespace sf::bridges {

namespace {

/// A tick of two robots with one reading of one value for each given sensor.
struct TickOf {
  explicit TickOf(std::int64_t time, const std::vector<std::uint32_t>& sensors) : values{static_cast<double>(time)} {
    for (const std::uint32_t sensor : sensors) {
      base::ReadingBlock& block = readings.emplace_back();
      block.sensor = sensor;
      block.time = time;
      block.values = values;
    }
    tick.time = time;
    tick.reports = reports;
    tick.readings = readings;
  }
  std::vector<double> values;
  std::vector<base::Report> reports{2};
  std::vector<base::ReadingBlock> readings;
  base::TickRecord tick;
};

std::vector<double> values_of(const base::TickRecord& tick) {
  std::vector<double> values;
  for (const base::ReadingBlock& reading : tick.readings) values.push_back(reading.values[0]);
  return values;
}

}  // namespace

TEST(LastTick, KeepsEachSensorsNewestReading) {
  LastTick last;
  EXPECT_TRUE(last.empty());
  last.store(TickOf(1, {0, 1}).tick, true);  // the tick is destroyed after each call
  last.store(TickOf(2, {1}).tick, true);
  EXPECT_FALSE(last.empty());
  EXPECT_EQ(last.record().reports.size(), 2u);
  EXPECT_EQ(values_of(last.record()), (std::vector<double>{1, 2}));
  for (std::uint32_t sensor = 2; sensor < 100; ++sensor) last.store(TickOf(3, {sensor}).tick, true);  // reallocates
  EXPECT_EQ(values_of(last.record())[1], 2);
  EXPECT_EQ(last.record().readings.size(), 100u);
}

/// Flags are part of a reading, because messages depend on them.
TEST(LastTick, KeepsTheFlagsOfReadings) {
  LastTick last;
  {
    TickOf tick(1, {0, 1});
    const base::QualityFlag near = base::QualityFlag::too_near;
    tick.readings[1].quality = {&near, 1};
    last.store(tick.tick, true);
  }
  EXPECT_TRUE(last.record().readings[0].quality.empty());
  ASSERT_EQ(last.record().readings[1].quality.size(), 1u);
  EXPECT_EQ(last.record().readings[1].quality[0], base::QualityFlag::too_near);
}

TEST(LastTick, DropsOldReadings) {
  LastTick last;
  last.store(TickOf(1, {0}).tick, true);
  last.store(TickOf(2, {1}).tick, false);  // the run continued
  EXPECT_TRUE(last.record().readings.empty());
  last.store(TickOf(3, {0}).tick, true);
  last.store(TickOf(0, {1}).tick, true);  // it restarted
  EXPECT_EQ(values_of(last.record()), (std::vector<double>{0}));
}

}  // namespace sf::bridges
