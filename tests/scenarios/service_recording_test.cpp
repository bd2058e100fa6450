// A service records its estimated states: its scans can be recomputed from them and drawn.

#include <gtest/gtest.h>

#include <filesystem>

#include "record/recorder.h"
#include "record/recording.h"
#include "scenarios/recording_verification.h"
#include "scenarios/run_info.h"
#include "tests/server/fixture.h"

namespace sf::scenarios {
namespace {

/// Two robots drive, with samples between ticks; one becomes silent and is removed from the world before the end.
record::Recording recorded_service(const std::string& accuracy = "exact") {
  server::Fixture f({.sensor_rate = 13.0,
                     .filter = {.mode = server::FilterMode::on, .policy = estimation::StalePolicy::hide},
                     .accuracy = accuracy});
  world::update_extent_and_hash(f.world);
  const std::string folder = (std::filesystem::temp_directory_path() / "service_recording").string();
  record::Recorder recorder(folder,
                            run_info(f.world, f.sensor_set, {.seed = 1, .record_readings = true, .estimated = true}));
  f.service->record_to(recorder);
  const auto other = f.make_client(1);
  for (int i = 0; i < 60; ++i, f.now += kTick) {
    for (server::RobotClient* robot : {f.client.get(), other.get()}) {
      robot->receive(f.now);
      if (robot != other.get() || i < 30) robot->step(f.now);
    }
    f.service->tick(f.now);
    const std::int64_t due = f.service->next_due();
    if (due < f.now + kTick) f.service->sample(due);
  }
  recorder.finish();
  return record::open_recording(folder);
}

TEST(ServiceRecording, ScansMatchPlainCpp) {
  const record::Recording recording = recorded_service();
  ASSERT_EQ(recording.states.size(), 2u);
  EXPECT_GT(recording.ticks, 80u) << "60 ticks, and samples between them";
  EXPECT_TRUE(base::is_absent(recording.states[1].back().X_WM)) << "silent for 3 s";
  EXPECT_FALSE(base::is_absent(recording.states[0].back().X_WM));
  EXPECT_TRUE(recording.damage.empty());
  const Verification v = verify(recording, server::Fixture::device(), {});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  EXPECT_GT(v.reference.readings, 90u);
  EXPECT_EQ(v.reference.readings, recording.readings.size());
}

/// Within the bound of each reading, which the metadata states and which follows from the sensor's pose.
TEST(ServiceRecording, ScansIn32BitsAreComparedWithinTheirBound) {
  record::Recording recording = recorded_service("single");
  const Verification v = verify(recording, server::Fixture::device(), {});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  EXPECT_TRUE(v.skipped.empty());
  EXPECT_EQ(v.compared(), recording.readings.size());
  EXPECT_GT(v.reference.largest, 0.0) << "or it was not measured in 32 bits";
  recording.readings[20].values[7] += 2e-3;
  EXPECT_EQ(verify(recording, server::Fixture::device(), {}).reference.different, 1u);
}

/// A service's readings of other types cannot be recomputed.
TEST(ServiceRecording, WithoutComparisonsItIsNotSound) {
  record::Recording recording = recorded_service();
  for (record::ReadingSample& reading : recording.readings) reading.type = sensors::kLaser + 1;
  const Verification v = verify(recording, server::Fixture::device(), {});
  EXPECT_EQ(v.compared(), 0u);
  EXPECT_FALSE(v.faulty());
  EXPECT_FALSE(v.sound());
}

TEST(ServiceRecording, AWrongRangeIsDetected) {
  record::Recording recording = recorded_service();
  recording.readings[20].values[7] += 1e-6;
  EXPECT_FALSE(verify(recording, server::Fixture::device(), {}).sound());
}

}  // namespace
}  // namespace sf::scenarios
