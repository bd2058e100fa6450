// Verification of recordings: sound ones pass, changes are detected.

#include "scenarios/recording_verification.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "raycast/casters.h"
#include "record/recorder.h"
#include "scenarios/recorded_accuracy.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"
#include "sensors/accuracy.h"
#include "tests/device.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/cone_scenes.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

world::World verified_world() {
  world::World world = scenes::boxes(20, 8.0, 3);
  sensors::LaserSettings laser = scenes::laser(61, M_PI, 4.0);
  laser.noise = {.range_sigma = 0.01, .range_proportional = 0.0, .angle_sigma = 0.002};
  laser.latency = 0.15;
  scenes::add_robots(world, 6, laser, 5);
  world::update_extent_and_hash(world);
  return world;
}

/// Two seconds of robots that wander or remain at rest.
record::Recording recorded(bool readings, const std::string& mode = "exact", world::World world = verified_world(),
                           RunSettings settings = {}, bool wander = true, const raycast::CasterType* caster = nullptr) {
  const auto folder = std::filesystem::temp_directory_path() / ("sf_verification_" + std::to_string(::getpid()));
  sensors::set_accuracy(world, mode);
  {
    settings.seed = 9, settings.record_readings = readings;
    if (caster != nullptr) settings.caster = caster->describe();
    Simulation simulation(world, device(),
                          {.seed = 9, .actor = {{.name = wander ? "wander" : ""}, {}}, .caster = caster});
    record::Recorder recorder(folder.string(), run_info(world, simulation.farm().sensor_set(), settings));
    for (int tick = 0; tick < 20; ++tick) recorder.write(simulation.step());
    recorder.finish();
  }
  record::Recording recording = record::open_recording(folder.string());
  std::filesystem::remove_all(folder);
  return recording;
}

TEST(Verification, ASoundRunPasses) {
  const Verification v = verify(recorded(true), device(), {});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  ASSERT_EQ(v.recomputed.size(), 1u);
  EXPECT_EQ(v.recomputed[0].readings, recorded(true).readings.size());
  EXPECT_EQ(v.recomputed[0].values, 61 * v.recomputed[0].readings);
  EXPECT_EQ(v.reference.readings, v.recomputed[0].readings) << "all by default";
  EXPECT_EQ(v.ticks, 20u);
  EXPECT_FALSE(v.interrupted);
}

/// The reference caster reproduces its own bytes. Plain C++ differs from them, within the bounds of both.
TEST(Verification, RecordingsOfTheReferenceCasterPass) {
  world::World world = verified_world();
  world.movers[0].sensors.push_back(trial::cones("sonar", trial::ring(4, 0.1)));
  const record::Recording recording = recorded(true, "exact", world, {}, true, &raycast::reference_caster);
  EXPECT_EQ(record::option_of(recording.info, "caster"), "reference, long double");
  const Verification v = verify(recording, device(), {});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  for (const Comparison& c : v.recomputed) EXPECT_EQ(c.largest, 0.0) << c.type;
  EXPECT_EQ(v.recomputed.size(), 2u);
  record::Recording mislabelled = recording;
  for (auto& [key, value] : mislabelled.info.options)
    if (key == "caster") value = "host, AVX2";
  EXPECT_FALSE(verify(mislabelled, device(), {}).sound()) << "the bytes are not the host's";
}

/// A recording of the other casters is recomputed with one of them, whichever caster the environment names.
TEST(Verification, IgnoresTheCasterOfTheEnvironment) {
  const record::Recording recording = recorded(true);
  setenv("SENSORFARM_CASTER", "reference", 1);
  const Verification v = verify(recording, device(), {});
  unsetenv("SENSORFARM_CASTER");
  EXPECT_TRUE(v.sound()) << v.reference.first;
}

/// Readings between ticks: their poses are recomputed bitwise from those of the ticks.
TEST(Verification, ReadingsBetweenTicksPass) {
  world::World world = verified_world();
  for (std::size_t m = 0; m < world.movers.size(); ++m) {
    scenes::edit_laser(world.movers[m])->rate = 13.0 + 12.0 * static_cast<double>(m);
    for (const char* type : {"encoder", "gyro"}) {
      world::Sensor sensor;
      sensor.type = sensor.name = type;
      sensor.settings = {{"rate", {37.0}, "", 0, ""}, {type[0] == 'e' ? "slip" : "noise", {0.01}, "", 0, ""}};
      world.movers[m].sensors.push_back(sensor);
    }
  }
  world::update_extent_and_hash(world);
  const record::Recording run = recorded(true, "exact", world);
  const Verification v = verify(run, device(), {});
  ASSERT_EQ(v.recomputed.size(), 3u);
  EXPECT_TRUE(v.sound()) << v.reference.first << v.recomputed[0].first << v.recomputed[1].first
                         << v.recomputed[2].first;
  EXPECT_EQ(v.missing, 0u);
  EXPECT_GT(v.recomputed[0].readings, 6u * 10u * 2u) << "more than one a tick";
  EXPECT_EQ(v.reference.readings, v.recomputed[0].readings);
  EXPECT_EQ(v.recomputed[0].readings + v.recomputed[1].readings + v.recomputed[2].readings, run.readings.size());

  record::Recording moved = run;
  moved.states[2][5].X_WM.x += 1e-6;
  EXPECT_FALSE(verify(moved, device(), {}).sound());
}

/// Skipped beams are recomputed bitwise; 32-bit scans bitwise on the device and within the bound by plain C++.
TEST(Verification, OtherModesPass) {
  const record::Recording skipped = recorded(true, "skip4");
  EXPECT_EQ(skipped.info.mode, "laser:skip4");
  const Verification all = verify(skipped, device(), {});
  EXPECT_TRUE(all.sound()) << all.reference.first;
  EXPECT_EQ(all.reference.largest, 0.0);

  const Verification single = verify(recorded(true, "single"), device(), {});
  EXPECT_TRUE(single.sound()) << single.reference.first;
  EXPECT_EQ(single.recomputed[0].largest, 0.0) << "one device, one answer";
  EXPECT_GT(single.reference.largest, 0.0) << "or it was not measured in 32 bits";
  EXPECT_LT(single.reference.largest, 1e-3);
}

/// Robots whose lasers and sonars have many surfaces below their minimum range.
world::World near_world() {
  world::World world = verified_world();
  for (world::Mover& mover : world.movers) {
    scenes::edit_laser(mover)->range_min = 1.4;  // 1.4F is less
    world::Sensor sonar;
    sonar.type = sonar.name = "sonar";
    sonar.settings = {{"range", {1.0, 3.0}, "", 0, ""}};
    mover.sensors.push_back(sonar);
    world::Sensor map;
    map.type = map.name = "occupancy";
    mover.sensors.push_back(map);
  }
  world::update_extent_and_hash(world);
  return world;
}

std::size_t count_too_near(const record::Recording& run) {
  std::size_t count = 0;
  for (const record::ReadingSample& reading : run.readings)
    count += static_cast<std::size_t>(std::count(reading.values.begin(), reading.values.end(), -HUGE_VAL));
  return count;
}

/// Ranges of surfaces that are too near are recorded as -infinity, or as the minimum. Earlier versions, which record no
/// option, use the minimum.
TEST(Verification, RangesThatAreTooNearPass) {
  for (const std::string mode : {"exact", "skip4", "single"}) {
    const record::Recording marked = recorded(true, mode, near_world());
    EXPECT_GT(count_too_near(marked), 100u);
    const Verification v = verify(marked, device(), {});
    EXPECT_TRUE(v.sound()) << mode << v.reference.first << v.recomputed[0].first;
    EXPECT_EQ(v.recomputed.size(), 3u);
    EXPECT_TRUE(v.skipped.empty());

    const record::Recording plain = recorded(true, mode, near_world(), {.too_near_min = true});
    EXPECT_EQ(count_too_near(plain), 0u);
    EXPECT_EQ(record::option_of(plain.info, record::kTooNear), "min");
    EXPECT_TRUE(verify(plain, device(), {}).sound()) << mode;

    record::Recording earlier = plain;
    std::erase_if(earlier.info.options, [](const auto& option) { return option.first == record::kTooNear; });
    for (record::ReadingSample& reading : earlier.readings)
      if (reading.type == 1)
        for (double& range : reading.values) range = range == base::float_above(1.4) ? double{1.4F} : range;
    const Verification old = verify(earlier, device(), {});
    EXPECT_TRUE(old.sound()) << mode << ", as of earlier versions";
    ASSERT_EQ(old.skipped.size(), 1u);
    EXPECT_NE(old.skipped[0].find("occupancy maps: earlier versions treated"), std::string::npos) << old.skipped[0];
  }
}

/// Walls at range_min and range_max, within the error of 32 bits: this device and plain C++ put beams on different
/// sides of both, and noise is added on one side.
world::World world_at_limits() {
  world::World world;
  trial::Chance chance(5);
  for (int i = 0; i < 80; ++i) {
    const double y = 20.0 * i, least = chance.between(0.3, 0.6), most = chance.between(4.0, 8.0);
    const double wall = (i % 2 == 0 ? least : most) * (1.0 + 1e-7 * chance.between(-1.0, 1.0));
    scenes::add_outline(world, {{wall, y - 0.3}, {wall + 1, y - 0.3}, {wall + 1, y + 0.3}, {wall, y + 0.3}}, "wall");
    sensors::LaserSettings laser = scenes::laser(11, 0.001, most);
    laser.X_MS = {0.0, 0.0, 0.1, 0.0};
    laser.range_min = least;
    laser.resolution = i % 4 < 2 ? 1 : 2;
    laser.noise.range_sigma = i % 8 < 4 ? 0.0 : 0.01;
    scenes::add_robot(world, {0.0, y, 0.0, 0.0}, laser);
  }
  world::update_extent_and_hash(world);
  return world;
}

TEST(Verification, A32BitErrorMayCrossALimit) {
  for (const bool infinite : {false, true}) {
    const record::Recording run = recorded(true, "single", world_at_limits(), {.no_return_inf = infinite}, false);
    EXPECT_GT(count_too_near(run), 100u);
    const Verification v = verify(run, device(), {});
    EXPECT_TRUE(v.sound()) << v.reference.first;
    EXPECT_LT(v.reference.largest, 1e-3);
  }
}

TEST(Verification, A32BitRangeBeyondItsBoundIsDetected) {
  record::Recording run = recorded(true, "single");
  for (record::ReadingSample& sample : run.readings) sample.values[7] += 2e-3;
  EXPECT_FALSE(verify(run, device(), {}).sound());
  EXPECT_GT(verify(run, device(), {}).reference.different, 0u);
}

TEST(Verification, WithoutReadingsPlainCppIsComparedWithTheDevice) {
  const Verification v = verify(recorded(false), device(), {});
  EXPECT_TRUE(v.sound());
  EXPECT_TRUE(v.recomputed.empty()) << "no reading to compare with";
  EXPECT_GT(v.reference.readings, 100u);
}

TEST(Verification, ASampleIsSpreadOverTheRun) {
  const record::Recording run = recorded(true);
  const Verification v = verify(run, device(), {.sample = 10});
  EXPECT_TRUE(v.sound());
  EXPECT_GE(v.reference.readings, 10u);
  EXPECT_LE(v.reference.readings, 12u);
  EXPECT_EQ(v.recomputed[0].readings, run.readings.size()) << "the device looks at all";
}

TEST(Verification, DetectsOneBitOfOneBeam) {
  record::Recording run = recorded(true);
  double& range = run.readings[7].values[30];
  range = std::nextafter(static_cast<float>(range), 0.0F);
  const Verification v = verify(run, device(), {});
  EXPECT_FALSE(v.sound());
  EXPECT_EQ(v.recomputed[0].different, 1u);
  EXPECT_EQ(v.reference.different, 1u) << "compared with plain C++, independent of the device";
  EXPECT_LT(v.recomputed[0].largest, 1e-6);
  EXPECT_NE(v.recomputed[0].first.find("sensor 0"), std::string::npos) << v.recomputed[0].first;
}

TEST(Verification, DetectsAnotherSeed) {
  record::Recording run = recorded(true);
  run.info.seed = 10;
  EXPECT_FALSE(verify(run, device(), {}).sound());
}

TEST(Verification, DetectsAMovedPose) {
  record::Recording run = recorded(true);
  run.states[2][5].X_WM.x += 1e-6;
  const Verification v = verify(run, device(), {});
  EXPECT_FALSE(v.sound());
  EXPECT_LT(v.recomputed[0].different, v.recomputed[0].values / 10) << "robots that see it, and itself, at one tick";
}

TEST(Verification, DetectsAReadingThatWasNotDue) {
  record::Recording run = recorded(true);
  run.readings.push_back(run.readings.back());
  run.readings.back().sequence = 1000;
  const Verification v = verify(run, device(), {});
  EXPECT_EQ(v.missing, 1u);
  EXPECT_FALSE(v.sound());
}

TEST(Verification, AnInterruptedVerificationIsNotUnsound) {
  const Verification v = verify(recorded(true), device(), {.progress = [](double) { return false; }});
  EXPECT_EQ(v.ticks, 1u);
  EXPECT_TRUE(v.interrupted);
  EXPECT_EQ(v.missing, 0u) << "unchecked readings are not missing";
}

/// An empty comparison is not evidence of soundness.
TEST(Verification, ARecordingTruncatedBeforeItsFirstTickIsNotSound) {
  record::Recording run = recorded(true);
  for (auto& states : run.states) states.clear();
  run.readings.clear();
  run.ticks = 0;
  EXPECT_TRUE(verify(run, device(), {}).sound()) << "a finished run of no ticks";
  run.truncated = true;
  const Verification v = verify(run, device(), {});
  EXPECT_FALSE(v.sound());
  EXPECT_TRUE(v.truncated);
  ASSERT_EQ(v.damage.size(), 1u);
}

TEST(Verification, StatesOfAnotherWorldAreRejected) {
  record::Recording run = recorded(true);
  run.states.pop_back();
  EXPECT_THROW(verify(run, device(), {}), base::InputError);
  EXPECT_THROW(recorded_accuracy(run, device(), "skip2", {}), base::InputError);
}

/// Each mode compared with `exact`, at the poses of one noisy recording: as many values as were recorded.
TEST(RecordedAccuracy, ModesHaveTheirErrors) {
  const record::Recording run = recorded(true);
  const auto errors = [&](const std::string& words) {
    const RecordedAccuracy all = recorded_accuracy(run, device(), words, {});
    EXPECT_EQ(all.ticks, 20u);
    EXPECT_TRUE(all.within_bounds());
    EXPECT_EQ(all.types.size(), 1u);
    EXPECT_EQ(all.types[0].sensor, "laser");
    EXPECT_EQ(all.types[0].mode, words.substr(words.find(':') + 1));
    EXPECT_EQ(all.types[0].unit, "m");
    EXPECT_TRUE(all.types[0].noisy);
    EXPECT_EQ(all.types[0].errors.count(), 61 * run.readings.size());
    return all.types[0].errors;
  };
  const ErrorDistribution exact = errors("exact"), single = errors("laser:single"), skip2 = errors("skip2"),
                          skip4 = errors("skip4");
  EXPECT_EQ(exact.max(), 0.0);
  EXPECT_EQ(exact.zero(), 1.0);
  EXPECT_EQ(exact.covered(), 1.0);
  EXPECT_GT(single.max(), 0.0) << "32 bits show";
  EXPECT_LE(single.max(), single.bound());
  EXPECT_LT(single.max(), 1e-4) << "noise of 1 cm is in neither";
  EXPECT_NEAR(skip2.covered(), 31.0 / 61.0, 1e-9) << "every other beam, and the last";
  EXPECT_EQ(skip2.covered_max(), 0.0) << "beams that are cast are those of exact";
  EXPECT_GE(skip2.zero(), skip2.covered());
  EXPECT_GT(skip2.max(), 0.1) << "between boxes";
  EXPECT_LT(skip4.zero(), skip2.zero());
}

/// The mode of the recording does not matter, only its poses do: robots with 32-bit scans drive slightly differently.
TEST(RecordedAccuracy, WorksForRecordingsInOtherModesOrWithoutReadings) {
  const auto errors = [](const record::Recording& run) {
    return recorded_accuracy(run, device(), "skip4", {}).types.at(0).errors;
  };
  const ErrorDistribution exact = errors(recorded(true)), single = errors(recorded(true, "single")),
                          silent = errors(recorded(false));
  EXPECT_EQ(silent.count(), exact.count());
  EXPECT_EQ(silent.max(), exact.max());
  EXPECT_EQ(silent.quantile(0.99), exact.quantile(0.99));
  EXPECT_EQ(single.count(), exact.count());
  EXPECT_NEAR(single.max(), exact.max(), 1e-2);
}

TEST(RecordedAccuracy, CanBeStopped) {
  const RecordedAccuracy a =
      recorded_accuracy(recorded(false), device(), "skip4", {.progress = [](double) { return false; }});
  EXPECT_TRUE(a.interrupted);
  EXPECT_EQ(a.ticks, 1u);
}

TEST(RecordedAccuracy, ModesOfNoSensorAreRejected) {
  const record::Recording run = recorded(false);
  EXPECT_THROW(recorded_accuracy(run, device(), "skip3", {}), base::InputError);
  EXPECT_THROW(recorded_accuracy(run, device(), "near3", {}), base::InputError) << "of magnetometers";
}

}  // namespace
}  // namespace sf::scenarios
