// Faults of sensors: the effect of each kind, their distributions, determinism, delivery, bad input.

#include "farm/faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/time.h"
#include "robots/fleet.h"
#include "sensors/camera.h"
#include "sensors/compass.h"
#include "sensors/encoder.h"
#include "sensors/gyro.h"
#include "sensors/imu.h"
#include "sensors/laser.h"
#include "sensors/lidar.h"
#include "tests/farm/small_farm.h"
#include "tests/refusal.h"
#include "tests/units.h"
#include "world/append_robot.h"
#include "world/stage/build_world.h"

namespace sf::farm {
namespace {

using base::FaultKind;

constexpr std::int64_t kTenth = base::kSecond / 10;

world::World two_robots(const std::string& gyro = "rate 10") {
  return world::build_world("faults.world",
                            "define bot position( size [0.3 0.3 0.1] drive \"diff\" encoder( rate 10 )\ngyro( " + gyro +
                                " ) )\nbot( name \"r0\" pose [0 0 0 0] )\nbot( name \"r1\" pose [3 0 0 0] )\n",
                            {.sensors = sensors::world_file_words()});
}

/// A fault of the encoders of r0 from 0.3 s to before 0.6 s.
Fault encoder_fault(FaultKind kind, double amount = 0.0) {
  Fault fault{.kind = kind, .robot = "r0", .type = "encoder", .amount = amount, .from = 0.3, .until = 0.6};
  fault.file = "a.toml", fault.line = 7;
  return fault;
}

/// Readings in order of delivery, with the tick of delivery.
struct Delivered {
  Kept reading;
  std::uint8_t type = 0;
  double sigma = 0.0;
  int tick = 0;
};

struct FaultRun {
  std::vector<Delivered> readings;
  std::vector<base::FaultMark> marks;
  FarmStats stats;
  std::uint64_t hash = 0;
  const Delivered* find(std::uint8_t type, std::uint32_t mover, std::uint32_t sequence) const {
    for (const Delivered& d : readings)
      if (d.type == type && d.reading.mover == mover && d.reading.sequence == sequence) return &d;
    return nullptr;
  }
};

/// Runs ticks of 0.1 s in which robots with `moves` drive along curves.
FaultRun run_with(const world::World& world, std::vector<Fault> faults, int ticks = 10, FarmOptions options = {},
                  bool moves = true, std::int64_t tick_time = kTenth) {
  options.faults = std::move(faults);
  if (options.threads == 0) options.threads = 1;
  options.scene.caster = &raycast::host_caster;
  Farm farm(world, host_device(), options);
  farm.subscribe_all();
  FaultRun run;
  std::vector<base::Report> reports = robots::states_at_load(world);
  for (int tick = 0; tick < ticks; ++tick) {
    for (const base::ReadingBlock& r : farm.tick(tick * tick_time, reports))
      run.readings.push_back({keep(r), r.type, r.sigma, tick});
    run.marks.insert(run.marks.end(), farm.fault_marks().begin(), farm.fault_marks().end());
    for (base::Report& report : reports)
      if (moves) report.X_WM.x += 0.0213, report.X_WM.yaw += 0.01, report.velocity = {0.2, 0, 0.1};
  }
  run.stats = farm.stats();
  run.hash = farm.hash();
  return run;
}

/// Expects that values of r0's encoders are `expected(clean values, seconds since 0.3 s)` in the interval of the fault,
/// and all other readings unchanged.
template <class Expected>
void expect_effect(const Fault& fault, Expected&& expected) {
  const world::World world = two_robots();
  const FaultRun clean = run_with(world, {}), faulty = run_with(world, {fault});
  ASSERT_EQ(clean.readings.size(), faulty.readings.size());
  for (std::size_t i = 0; i < clean.readings.size(); ++i) {
    const auto& [before, type, sigma, tick] = clean.readings[i];
    const Kept& after = faulty.readings[i].reading;
    const bool affected = type == sensors::kEncoder && before.mover == 0 && tick >= 3 && tick < 6;
    if (!affected) {
      EXPECT_EQ(after, before) << "tick " << tick;
      continue;
    }
    EXPECT_EQ(after.values, expected(before.values, 0.1 * (tick - 3))) << "tick " << tick;
    EXPECT_EQ(after.bound, HUGE_VAL);
    EXPECT_EQ(faulty.readings[i].sigma, HUGE_VAL);
  }
  EXPECT_EQ(faulty.stats.faults[static_cast<std::size_t>(fault.kind)], 3u);
  ASSERT_EQ(faulty.marks.size(), 3u);
  EXPECT_EQ(faulty.marks[1], (base::FaultMark{0, 0, sensors::kEncoder, 4, 4 * kTenth, base::fault_bit(fault.kind)}));
}

using Values = std::vector<double>;

TEST(Faults, BiasDriftAndScaleAlterOneColumn) {
  expect_effect(encoder_fault(FaultKind::bias, 0.5), [](Values v, double) { return v[0] += 0.5, v; });
  expect_effect(encoder_fault(FaultKind::scale, -3.0), [](Values v, double) { return v[0] *= -3.0, v; });
  Fault right = encoder_fault(FaultKind::bias, 0.5);
  right.column = "right_m";
  expect_effect(right, [](Values v, double) { return v[1] += 0.5, v; });
  const std::int64_t start = base::nanoseconds(0.3);
  expect_effect(encoder_fault(FaultKind::drift, 2.0), [start](Values v, double since) {
    const std::int64_t time = start + std::llround(since * 10.0) * kTenth;
    return v[0] += 2.0 * (1e-9 * static_cast<double>(time - start)), v;
  });
}

TEST(Faults, QuantizationRoundsToSteps) {
  expect_effect(encoder_fault(FaultKind::quantization, 0.05),
                [](Values v, double) { return v[0] = 0.05 * std::round(v[0] / 0.05), v; });
}

TEST(Faults, StuckRepeatsTheLastReadingBefore) {
  const FaultRun clean = run_with(two_robots(), {});
  const Values last = clean.find(sensors::kEncoder, 0, 2)->reading.values;
  EXPECT_NE(last, clean.find(sensors::kEncoder, 0, 3)->reading.values);
  expect_effect(encoder_fault(FaultKind::stuck), [&](const Values&, double) { return last; });
}

TEST(Faults, SwapExchangesColumns) {
  Fault fault = encoder_fault(FaultKind::swap);
  fault.swapped_columns = {"left_m", "right_m"};
  expect_effect(fault, [](Values v, double) { return std::swap(v[0], v[1]), v; });
}

TEST(Faults, EarlierFaultsActFirst) {
  const Fault bias = encoder_fault(FaultKind::bias, 1.0), scale = encoder_fault(FaultKind::scale, 2.0);
  const world::World world = two_robots();
  const double clean = run_with(world, {}).find(sensors::kEncoder, 0, 4)->reading.values[0];
  EXPECT_EQ(run_with(world, {bias, scale}).find(sensors::kEncoder, 0, 4)->reading.values[0], (clean + 1.0) * 2.0);
  EXPECT_EQ(run_with(world, {scale, bias}).find(sensors::kEncoder, 0, 4)->reading.values[0], clean * 2.0 + 1.0);
}

TEST(Faults, DropoutLosesReadingsAndKeepsNumbers) {
  const world::World world = two_robots();
  const FaultRun clean = run_with(world, {}), faulty = run_with(world, {encoder_fault(FaultKind::dropout)});
  EXPECT_EQ(faulty.readings.size(), clean.readings.size() - 3);
  for (std::uint32_t k = 0; k < 10; ++k)
    EXPECT_EQ(faulty.find(sensors::kEncoder, 0, k) == nullptr, k >= 3 && k < 6) << "reading " << k;
  EXPECT_EQ(faulty.find(sensors::kEncoder, 0, 6)->reading, clean.find(sensors::kEncoder, 0, 6)->reading);
  EXPECT_EQ(faulty.stats.faults[static_cast<std::size_t>(FaultKind::dropout)], 3u);
  EXPECT_EQ(faulty.marks.size(), 3u) << "lost readings are marked, too";
}

/// The reading of 0.5 s is delivered at 0.8 s, after those of 0.6 s and 0.7 s.
TEST(Faults, DelayChangesTheOrderOfDelivery) {
  const world::World world = two_robots();
  const FaultRun clean = run_with(world, {}), faulty = run_with(world, {encoder_fault(FaultKind::delay, 0.25)});
  std::vector<std::uint32_t> order;
  for (const Delivered& d : faulty.readings) {
    if (d.type != sensors::kEncoder || d.reading.mover != 0) continue;
    order.push_back(d.reading.sequence);
    const bool late = d.reading.sequence >= 3 && d.reading.sequence < 6;
    EXPECT_EQ(d.tick, static_cast<int>(d.reading.sequence) + (late ? 3 : 0));
    EXPECT_EQ(d.reading, clean.find(sensors::kEncoder, 0, d.reading.sequence)->reading) << "values and bound unchanged";
  }
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0, 1, 2, 3, 6, 4, 7, 5, 8, 9}));
  Farm farm(world, host_device(), {.threads = 1, .faults = {encoder_fault(FaultKind::delay, 0.25)}});
  farm.subscribe_all();
  for (int tick = 0; tick <= 3; ++tick) farm.tick(tick * kTenth, {});
  EXPECT_EQ(farm.next_delivery(), 3 * kTenth + base::kSecond / 4);
}

TEST(Faults, ElementsOfAScanSwapWithTheirHits) {
  const world::World world = small_world(1);
  const Fault fault{.kind = FaultKind::swap, .robot = "*", .type = "laser", .swapped_elements = {0, 40}};
  Kept expected = run_with(world, {}, 1).readings.at(0).reading;
  const FaultRun faulty = run_with(world, {fault}, 1);
  ASSERT_NE(expected.values[0], expected.values[40]);
  std::swap(expected.values[0], expected.values[40]);
  std::swap(expected.hits[0], expected.hits[40]);
  EXPECT_EQ(faulty.readings.at(0).reading.values, expected.values);
  EXPECT_EQ(faulty.readings.at(0).reading.hits, expected.hits);
}

/// Ranges stay within the sensor's limits, and beams without an echo stay without.
TEST(Faults, RangesKeepTheirLimits) {
  constexpr double kMost = 4.0;
  world::World world = scenes::boxes(20, 12.0, 3);
  scenes::add_robots(world, 1, scenes::laser(kBeams, M_PI, kMost), 5);
  const std::vector<double> clean = run_with(world, {}, 1).readings.at(0).reading.values;
  ASSERT_GT(std::ranges::count(clean, kMost), 5);
  ASSERT_LT(std::ranges::count(clean, kMost), 55) << "some beams have an echo";
  Fault fault{.kind = FaultKind::bias, .robot = "*", .type = "laser"};
  for (const double amount : {100.0, -100.0}) {
    fault.amount = amount;
    const std::vector<double> values = run_with(world, {fault}, 1).readings.at(0).reading.values;
    for (std::size_t i = 0; i < clean.size(); ++i)
      EXPECT_EQ(values[i], amount > 0.0 || clean[i] == kMost ? kMost : 0.0) << "beam " << i;
  }
  fault.element = 7, fault.amount = -0.25;
  const std::vector<double> one = run_with(world, {fault}, 1).readings.at(0).reading.values;
  for (std::size_t i = 0; i < clean.size(); ++i)
    EXPECT_EQ(one[i], i == 7 && clean[i] < kMost ? std::max(0.0, clean[i] - 0.25) : clean[i]) << "beam " << i;
}

/// Depths are ranges. Beams without an echo and with one that is too near keep all columns but the colour.
TEST(Faults, PixelsAndEchoesKeepTheLimitsOfRanges) {
  const world::World world = world::build_world(
      "camera.world",
      "model( pose [3 0 0 0] size [1 2 1] color \"red\" ) position( name \"bot\" size [0.2 0.2 0.4]\n"
      "camera( resolution [5 1] fov 90 range [0.5 8] normals 1 rgb 1 )\n"
      "camera( resolution [3 1] fov 20 range [4 8] )\n"
      "camera( resolution [1 1] range [0.5 8] mono 1 )\n"
      "lidar( channels 1 fov_v [0 0] columns 4 range [0.5 8] intensity 1 ) )",
      {.sensors = sensors::world_file_words()});
  const auto values = [&](std::vector<Fault> faults, std::size_t reading) {
    return run_with(world, std::move(faults), 1).readings.at(reading).reading.values;
  };
  const auto fault = [](const char* type, double bias, const char* column = "", std::uint32_t sensor = 0) {
    return Fault{
        .kind = FaultKind::bias, .robot = "*", .type = type, .sensor = sensor, .column = column, .amount = bias};
  };
  std::size_t lidar = 0, near = 0;
  const auto all = run_with(world, {}, 1).readings;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].type == sensors::kLidar) lidar = i;
    if (all[i].type == sensors::kCamera && all[i].reading.sensor == 1) near = i;
  }
  const std::size_t seen = near - 1;
  const Values clean = values({}, seen);
  ASSERT_EQ(clean[0], 8.0) << "the first pixel sees nothing";
  ASSERT_NEAR(clean[2 * 5], 2.5, 1e-9) << "the middle one sees the box";
  for (const double bias : {100.0, -100.0}) {
    const Values depths = values({fault("camera", bias)}, seen);
    EXPECT_EQ(depths[0], 8.0);
    EXPECT_EQ(depths[2 * 5], bias > 0.0 ? 8.0 : 0.5);
  }
  const Values normals = values({fault("camera", 0.25, "normal_x")}, seen);
  EXPECT_EQ(normals[2], clean[2]) << "no surface, no normal";
  EXPECT_EQ(normals[2 * 5 + 2], clean[2 * 5 + 2] + 0.25);
  EXPECT_EQ(normals[2 * 5 + 3], clean[2 * 5 + 3]) << "normal_y";
  EXPECT_EQ(values({fault("camera", 1.0, "rgb")}, seen)[1], clean[1] + 0x010101) << "the sky has a colour";
  EXPECT_EQ(values({fault("camera", 300.0, "rgb")}, seen)[1], 0xFFFFFF) << "no channel carries into another";
  EXPECT_EQ(values({fault("camera", -300.0, "rgb")}, seen)[1], 0.0);
  Fault noise = fault("camera", 40.0, "rgb");
  noise.kind = FaultKind::noise;
  const Values noisy = values({noise}, seen);
  for (const std::uint32_t channel : {0xFF0000u, 0xFF00u, 0xFFu}) {
    int changed = 0;
    for (std::size_t i = 1; i < clean.size(); i += 5)
      changed += (static_cast<std::uint32_t>(noisy[i]) & channel) != (static_cast<std::uint32_t>(clean[i]) & channel);
    EXPECT_GE(changed, 2) << "each channel has its own noise";
  }
  const Values grey = values({fault("camera", -7.0, "rgb", 2)}, near + 1), was_grey = values({}, near + 1);
  EXPECT_EQ(grey[1], was_grey[1] - 0x070707);
  EXPECT_EQ(values({fault("camera", 1.0, "", 1)}, near), (Values{4.0, 4.0, 4.0})) << "too near";
  const Values echoes = values({fault("lidar", 0.5, "intensity")}, lidar), before = values({}, lidar);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(echoes[2 * i + 1], before[2 * i + 1] + (before[2 * i] < 8.0 ? 0.5 : 0.0)) << "beam " << i;

  const sensors::SensorSet sensor_set(world);
  const auto refusal = [&](const Fault& of) {
    return refusal_of([&] { check_faults(std::span(&of, 1), world, sensor_set); });
  };
  Fault swap{.kind = FaultKind::swap, .robot = "*", .type = "camera", .swapped_columns = {"depth_m", "rgb"}};
  expect_in("are of different kinds; expected two ranges, two counts, or two other columns", refusal(swap));
  swap.swapped_columns = {"normal_x", "depth_m"};
  expect_in("are of different kinds", refusal(swap));
  swap.swapped_columns = {"normal_x", "normal_z"};
  EXPECT_EQ(refusal(swap), "");
  expect_in("camera has no column 'rgb'", refusal(fault("camera", 1.0, "rgb", 1)));
}

constexpr int kDraws = 4000;
constexpr std::int64_t kHundredth = base::kSecond / 100;

/// The gyro of r0 at rest, read `kDraws` times, without and with a fault: differences of readings that were delivered.
std::vector<double> gyro_differences(Fault fault, const std::string& gyro = "rate 100 noise 1") {
  fault.robot = "r0", fault.type = "gyro", fault.until = HUGE_VAL;
  const world::World world = two_robots(gyro);
  const auto values = [&](std::vector<Fault> faults) {
    std::map<std::uint32_t, double> found;
    for (const Delivered& d : run_with(world, std::move(faults), kDraws, {}, false, kHundredth).readings)
      if (d.type == sensors::kGyro && d.reading.mover == 0) found[d.reading.sequence] = d.reading.values[0];
    return found;
  };
  const auto clean = values({});
  std::vector<double> differences;
  for (const auto& [sequence, value] : values({fault})) differences.push_back(value - clean.at(sequence));
  return differences;
}

double share(const std::vector<double>& of, auto&& is) {
  return static_cast<double>(std::ranges::count_if(of, is)) / kDraws;
}

/// Four standard deviations of a share of `kDraws`.
double slack(double p) { return 4.0 * std::sqrt(p * (1.0 - p) / kDraws); }

TEST(Faults, SpikesHaveTheirProbabilityAndEitherSign) {
  const auto d = gyro_differences({.kind = FaultKind::spikes, .amount = 0.5, .probability = 0.2});
  ASSERT_EQ(d.size(), static_cast<std::size_t>(kDraws));
  EXPECT_NEAR(share(d, [](double x) { return std::abs(x - 0.5) < 1e-12; }), 0.1, slack(0.1));
  EXPECT_NEAR(share(d, [](double x) { return std::abs(x + 0.5) < 1e-12; }), 0.1, slack(0.1));
  EXPECT_NEAR(share(d, [](double x) { return x == 0.0; }), 0.8, slack(0.8));
}

TEST(Faults, DropoutHasItsProbability) {
  const auto d = gyro_differences({.kind = FaultKind::dropout, .probability = 0.3});
  EXPECT_NEAR(static_cast<double>(d.size()) / kDraws, 0.7, slack(0.3));
  EXPECT_TRUE(std::ranges::all_of(d, [](double x) { return x == 0.0; })) << "the others are unchanged";
  EXPECT_EQ(gyro_differences({.kind = FaultKind::dropout}).size(), 0u);
}

/// Added noise is normal: its shares within 1 and 2 standard deviations. A multiple k adds sigma sqrt(k^2 - 1).
TEST(Faults, NoiseIsNormal) {
  const double sigma = sensors::SensorSet(two_robots("rate 100 noise 1")).of(sensors::kGyro, 0)[0].sigma;
  ASSERT_GT(sigma, 0.0);
  for (const bool multiplies : {false, true}) {
    const auto d = gyro_differences({.kind = FaultKind::noise, .amount = 3.0, .multiplies = multiplies});
    const double added = multiplies ? sigma * std::sqrt(8.0) : 3.0;
    ASSERT_EQ(d.size(), static_cast<std::size_t>(kDraws));
    double mean = 0.0;
    for (const double x : d) mean += x / kDraws;
    EXPECT_NEAR(mean, 0.0, 4.0 * added / std::sqrt(kDraws));
    for (const auto& [within, p] : {std::pair{1.0, 0.682689}, {2.0, 0.954500}})
      EXPECT_NEAR(share(d, [&, k = within](double x) { return std::abs(x) < k * added; }), p, slack(p)) << within;
  }
  const Fault multiple{.kind = FaultKind::noise, .robot = "r0", .type = "gyro", .amount = 3.0, .multiplies = true};
  EXPECT_EQ(run_with(two_robots("noise 1"), {multiple}, 3, {.noise = false}).find(sensors::kGyro, 0, 1)->reading.values,
            run_with(two_robots("noise 1"), {}, 3, {.noise = false}).find(sensors::kGyro, 0, 1)->reading.values)
      << "a run without noise has none to multiply";
}

/// The deviation of a reading's noise is known beside errors that last, and for each axis.
TEST(Faults, NoiseIsKnownBesideBiases) {
  const world::World world = world::build_world(
      "noise.world",
      "position( imu( rate 100 gyro_noise 0.1 gyro_bias 1 accel_noise 0.01 accel_bias 1 )\n"
      "compass( noise 3e-7 bias 1e-6 ) altimeter( noise 0.1 bias 2 ) inclinometer( noise 0.05 bias 1 )\n"
      "gyro( noise 1 bias 1 ) gps( noise 0.5 ) )",
      {.sensors = sensors::world_file_words()});
  const sensors::SensorSet sensor_set(world);
  struct Case {
    const char *type, *column;
    double noise;  ///< [unit of the column]; 0: not stated
  };
  for (const Case& c : {Case{"imu", "", kDegree},  // 0.1 deg/s sqrt(s), over a hundredth of a second
                        {"imu", "rate_z_rad_s", kDegree},
                        {"imu", "force_y_m_s2", 0.1},
                        {"imu", "saturated", 0.0},
                        {"compass", "field_T", 0.0},
                        {"compass", "field_z_T", 3e-7},
                        {"compass", "heading_rad", 0.0},
                        {"altimeter", "", 0.1},
                        {"inclinometer", "pitch_rad", 0.05 * kDegree},
                        {"gyro", "", kDegree},
                        {"gps", "y_m", 0.0}}) {
    const Fault fault{
        .kind = FaultKind::noise, .robot = "*", .type = c.type, .column = c.column, .amount = 2.0, .multiplies = true};
    const std::string refused = refusal_of([&] { check_faults(std::span(&fault, 1), world, sensor_set); });
    EXPECT_EQ(refused.empty(), c.noise > 0.0) << c.type << " " << c.column << ": " << refused;
  }
  for (const auto& [type, offset, noise] :
       {std::tuple{sensors::kImu, 0u, kDegree}, {sensors::kImu, 5u, 0.1}, {sensors::kCompass, 3u, 3e-7}}) {
    const sensors::SensorSet::Group& group = *sensor_set.group(type);
    EXPECT_NEAR(own_noise(group, group.rows[0], offset), noise, 1e-12) << static_cast<int>(type) << " " << offset;
  }
}

TEST(Faults, DrawsDifferByRobotAndFault) {
  const Fault noise{.kind = FaultKind::noise, .robot = "*", .type = "gyro", .amount = 1.0};
  const world::World world = two_robots();
  const FaultRun once = run_with(world, {noise}, 2, {}, false), twice = run_with(world, {noise, noise}, 2, {}, false);
  const double first = once.find(sensors::kGyro, 0, 0)->reading.values[0];
  EXPECT_NE(first, once.find(sensors::kGyro, 1, 0)->reading.values[0]);
  EXPECT_NE(first, once.find(sensors::kGyro, 0, 1)->reading.values[0]);
  EXPECT_NE(twice.find(sensors::kGyro, 0, 0)->reading.values[0], 2.0 * first);
}

/// One hash for any number of threads, and for readings of resting robots that are reused or measured again.
TEST(Faults, ThreadsAndReuseDoNotChangeAByte) {
  const world::World world = small_world(150);
  std::vector<Fault> faults;
  for (const FaultKind kind : {FaultKind::spikes, FaultKind::stuck, FaultKind::dropout, FaultKind::delay}) {
    faults.push_back({.kind = kind, .robot = "*", .type = "laser", .amount = 0.3, .from = 0.2, .until = 0.8});
    faults.back().probability = 0.3;
  }
  const FaultRun one = run_with(world, faults, 12, {.seed = 5, .threads = 1}, false);
  const FaultRun three = run_with(world, faults, 12, {.seed = 5, .threads = 3}, false);
  const FaultRun fresh = run_with(world, faults, 12, {.seed = 5, .reuse_unchanged = false}, false);
  EXPECT_EQ(one.hash, three.hash);
  EXPECT_EQ(one.marks, three.marks);
  EXPECT_EQ(one.hash, fresh.hash);
  EXPECT_GT(one.stats.reused, 0u);
  EXPECT_NE(one.hash, run_with(world, faults, 12, {.seed = 6}, false).hash);
  EXPECT_NE(one.hash, run_with(world, {}, 12, {.seed = 5}, false).hash);
  for (const FaultKind kind : {FaultKind::spikes, FaultKind::stuck, FaultKind::dropout, FaultKind::delay})
    EXPECT_GT(one.stats.faults[static_cast<std::size_t>(kind)], 50u) << static_cast<int>(kind);
}

/// A robot that joins has the faults of all robots, and those of its name; a stuck sensor stays stuck.
TEST(Faults, RobotsThatJoinHaveFaultsToo) {
  world::World world = two_robots();
  Fault all = encoder_fault(FaultKind::bias, 2.0), later = encoder_fault(FaultKind::bias, 5.0);
  all.robot = "*", all.from = 0.0, all.until = HUGE_VAL;
  later.robot = "r2", later.until = HUGE_VAL;
  const Fault stuck{.kind = FaultKind::stuck, .robot = "r0", .type = "gyro"};
  Farm farm(world, host_device(), {.threads = 1, .faults = {all, later, stuck}});
  farm.subscribe_all();
  std::vector<base::Report> reports = robots::states_at_load(world);
  const auto turn = [&](int tick) {
    for (const base::ReadingBlock& r : farm.tick(tick * kTenth, reports))
      if (r.type == sensors::kGyro && r.mover == 0) return r.values[0];
    return -1.0;
  };
  reports[0].velocity.turn = 0.5;
  EXPECT_EQ(turn(0), 0.5);
  reports[0].velocity.turn = 0.9;
  EXPECT_EQ(turn(1), 0.5);
  world::append_robot(world, 0, "r2", {5.0, 0.0, 0.0, 0.0});
  const auto before = farm.add_mover();
  farm.subscribe(2, kAllSensorTypes);
  EXPECT_EQ(turn(2), 0.5);
  reports.push_back({2, 0, world.movers[2].X_WM, {}});
  double joined = -1.0;
  for (const base::ReadingBlock& r : farm.tick(3 * kTenth, reports))
    if (r.type == sensors::kEncoder && r.mover == 2) joined = r.values[0];
  EXPECT_EQ(joined, 7.0);
}

TEST(Faults, InvalidOnesAreRefusedAtTheirLine) {
  const world::World world = two_robots("noise 1");
  const sensors::SensorSet sensor_set(world);
  const auto refusal = [&](const Fault& fault) {
    return refusal_of([&] { check_faults(std::span(&fault, 1), world, sensor_set); });
  };
  const auto with = [&](auto&& change, FaultKind kind = FaultKind::bias) {
    Fault fault = encoder_fault(kind, 1.0);
    change(fault);
    return refusal(fault);
  };
  EXPECT_EQ(with([](Fault&) {}), "");
  EXPECT_EQ(with([](Fault& f) { f.robot = "*"; }), "");
  expect_in("a.toml:7: no robot is called 'r3'; did you mean 'r0'?", with([](Fault& f) { f.robot = "r3"; }));
  expect_in("a.toml:7: no robot of the world has a sensor 'encodr'; did you mean 'encoder'?",
            with([](Fault& f) { f.type = "encodr"; }));
  expect_in("'r0' has no sensor encoder:1", with([](Fault& f) { f.sensor = 1; }));
  expect_in("encoder has no column 'lft_m'; did you mean 'left_m'?", with([](Fault& f) { f.column = "lft_m"; }));
  expect_in("has no element 1; expected a number from 0 to 0", with([](Fault& f) { f.element = 1; }));
  expect_in("has no element 3", with([](Fault& f) { f.swapped_elements = {0, 3}; }, FaultKind::swap));
  expect_in("its standard deviation is 0; expected sigma",
            with([](Fault& f) { f.multiplies = true; }, FaultKind::noise));
  expect_in("hold back", with([](Fault& f) { f.amount = 1e9; }, FaultKind::delay));
}

}  // namespace
}  // namespace sf::farm
