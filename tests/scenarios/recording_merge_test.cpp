// Merging the recordings of two ranks.

#include "scenarios/recording_merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <random>

#include "base/echo.h"
#include "base/error.h"
#include "base/files.h"
#include "base/thread_pool.h"
#include "record/recorder.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"
#include "sensors/laser.h"
#include "tests/device.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

std::string merging_folder(const std::string& name) {
  const std::string path = testing::TempDir() + "merging/" + name;
  std::filesystem::remove_all(path);
  return path;
}

/// Three robots with lasers that are delivered late; the first two have sonars, whose readings are three messages each.
world::World merged_world() {
  world::World world = scenes::boxes(10, 6.0, 3);
  sensors::LaserSettings laser = scenes::laser(5, M_PI, 4.0);
  laser.latency = 0.15;
  scenes::add_robots(world, 3, laser, 5);
  for (std::size_t m = 0; m < 2; ++m) {
    world::Sensor sonar;
    sonar.type = sonar.name = "sonar";
    sonar.settings = {{"scount", {2.0}, "", 0, ""},
                      {"spose[0]", {0.1, 0.0, 0.0}, "", 0, ""},
                      {"spose[1]", {0.0, 0.1, 90.0}, "", 0, ""}};
    world.movers[m].sensors.push_back(sonar);
  }
  world::update_extent_and_hash(world);
  return world;
}

/// Ten ticks: complete in WHOLE/run.mcap, and in RANKS by two ranks, of which the second has the odd robots.
void record_merged(const std::string& whole, const std::string& ranks, std::uint64_t seed = 9,
                   record::Compression compression = record::Compression::zstd) {
  const world::World world = merged_world();
  Simulation simulation(world, device(), {.seed = seed});
  const record::RunInfo info = run_info(world, simulation.farm().sensor_set(), {seed, true});
  record::Recorder one(whole, info, {.compression = compression}), first(ranks, info, {0, 2, compression}),
      second(ranks, info, {1, 2, compression});
  for (int tick = 0; tick < 10; ++tick) {
    base::TickRecord record = simulation.step();
    one.write(record);
    const std::vector<base::ReadingBlock> all(record.readings.begin(), record.readings.end());
    for (const std::uint32_t rank : {0u, 1u}) {
      std::vector<base::ReadingBlock> own;
      std::copy_if(all.begin(), all.end(), std::back_inserter(own), [&](const auto& r) { return r.mover % 2 == rank; });
      record.readings = own;
      (rank == 0 ? first : second).write(record);
    }
  }
  for (record::Recorder* recorder : {&one, &first, &second}) recorder->finish();
}

/// Bounds are those of the recorded numbers, and noisy sensors have none.
TEST(RunInfo, HasTheBoundsOfRecordedReadings) {
  world::World world = merged_world();
  for (const std::size_t m : {1, 2})
    for (world::Setting& setting : world.movers[m].sensors[0].settings)
      if (setting.key == "noise") setting.numbers[0] = 0.2;
  const sensors::SensorSet sensor_set(world);
  const auto rows = run_info(world, sensor_set, {}).accuracy;
  ASSERT_EQ(rows.size(), 2u) << "sonar states none";
  const auto number = [](const std::string& row, const std::string& key) {
    return std::stod(row.substr(row.find("\"" + key + "\":") + key.size() + 3));
  };
  const double rounding = 0x1p-23 * sensor_set.group(sensors::kLaser)->rows[0].limit;
  EXPECT_GE(number(rows[0], "bound"), 1e-9 + rounding) << "of 32 bits";
  EXPECT_LE(number(rows[0], "bound"), 2e-9 + rounding);
  EXPECT_EQ(number(rows[0], "sigma"), 0.0);
  EXPECT_NE(rows[1].find("\"bound\":null"), std::string::npos) << rows[1];
  EXPECT_EQ(number(rows[1], "bound_without_noise"), number(rows[0], "bound"));
  EXPECT_EQ(number(rows[1], "sigma"), 0.2);
  EXPECT_EQ(run_info(world, sensor_set, {.noise = false}).accuracy[1].find("null"), std::string::npos);
}

TEST(RunInfo, TheBoundCoversRoundingAtTheLimits) {
  EXPECT_GT(std::abs(base::rep117_range(4.999999999, {.max = 5.0}) - 4.999999999), 0x1p-24 * 5.0)
      << "more than to nearest";
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 100'000; ++i) {
    const double max = std::exp2(24.0 * share(engine) - 6.0), min = max * share(engine);
    const double step = 0x1p-24 * max * share(engine);
    for (const double range :
         {min, min + step, max - step, std::nextafter(max, 0.0), min + (max - min) * share(engine)})
      if (range >= min && range < max) {
        ASSERT_LE(std::abs(base::rep117_range(range, {min, max}) - range), recorded_rounding(max)) << range;
      }
  }
}

void expect_bytes_of_one(record::Compression compression) {
  const std::string whole = merging_folder("whole"), ranks = merging_folder("ranks");
  record_merged(whole, ranks, 9, compression);
  const record::Recording expected = record::open_recording(whole), read = open_run(ranks);
  ASSERT_GT(expected.readings.size(), 40u);
  EXPECT_EQ(read.readings.size(), expected.readings.size()) << "as if it were merged";
  const MergedRecording merged = merge_recordings(std::span(&ranks, 1), merging_folder("merged"));
  const std::string bytes = base::read_text(merged.file);
  EXPECT_TRUE(bytes == base::read_text(whole + "/run.mcap"));
  EXPECT_EQ(merged.bytes, bytes.size());
  EXPECT_EQ(merged.ticks, 10u);
  EXPECT_FALSE(merged.truncated);
}

TEST(Merging, MatchesTheBytesOfASingleProcess) {
  expect_bytes_of_one(record::Compression::zstd);
  expect_bytes_of_one(record::Compression::none);
}

TEST(Merging, StoppingWritesNothing) {
  const std::string ranks = merging_folder("stopped"), merged = merging_folder("stopped_merged");
  record_merged(merging_folder("stopped_whole"), ranks);
  EXPECT_THROW(merge_recordings(std::span(&ranks, 1), merged, [] { return true; }), base::Interrupted);
  EXPECT_TRUE(std::filesystem::is_empty(merged));
}

/// Otherwise the merged recording would be complete, and sound without a tick.
TEST(Merging, ARankWithoutACompleteTickIsRejected) {
  const std::string ranks = merging_folder("cut");
  record_merged(merging_folder("cut_whole"), ranks, 9, record::Compression::none);
  const std::string second = ranks + "/rank-1.mcap";
  std::uintmax_t size = std::filesystem::file_size(second);
  std::filesystem::resize_file(second, size * 3 / 4);
  const MergedRecording part = merge_recordings(std::span(&ranks, 1), merging_folder("cut_merged"));
  EXPECT_TRUE(part.truncated);
  EXPECT_GT(part.ticks, 0u);
  EXPECT_LT(part.ticks, 10u);
  const std::string text = base::read_text(second);
  std::filesystem::resize_file(second, text.find("/clock") + 100);  // after the channel of the ticks' first message
  EXPECT_THROW(merge_recordings(std::span(&ranks, 1), merging_folder("cut_none")), base::InputError);
}

}  // namespace
}  // namespace sf::scenarios
