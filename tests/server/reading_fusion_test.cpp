#include "server/reading_fusion.h"

#include "sensors/bumper.h"
#include "sensors/infrared.h"
#include "sensors/sonar.h"
#include "tests/server/fixture.h"
#include "world/world.h"

namespace sf::server {
namespace {

constexpr double kNone = HUGE_VAL;
const double kUnknown = std::nan("");
constexpr std::int64_t kMs = 1'000'000;

/// A robot with a laser of 5 beams over 180 degrees from 0.1 m to 8 m, and two more sensors.
world::World lab() {
  world::World world = scenes::boxed_world(6.0, 4.0, {-3.0, -2.0});
  world::Mover& robot = scenes::add_mover(world, {}, scenes::rectangle({0.0, 0.0}, 0.3, 0.3));
  robot.sensors.push_back(sensors::laser_sensor(
      {{.name = "laser", .fov = M_PI, .samples = 5, .range_min = 0.1, .range_max = 8.0}, 10.0, 0.0, 0.0}));
  for (const char* type : {"infrared", "bumper"})
    robot.sensors.push_back({.type = type, .name = type, .settings = {}, .file = "lab.world"});
  return world;
}

struct Lab {
  world::World world = lab();
  sensors::SensorSet sensor_set{world};
  LogPipe pipe;
  netio::RateLimitedLog log{pipe.descriptor()};
  FusionOptions options;
  ReadingFusion fusion{world, sensor_set, options};
  std::vector<double> ranges{2.0, 2.0, 2.0, 2.0, 8.0};
  std::vector<std::uint32_t> hits{3, 3, 3, 3, base::kNoHit};
  std::vector<base::QualityFlag> quality;

  void send(const std::vector<double>& own, std::int64_t sent, std::int64_t now, std::uint32_t total = 5,
            std::uint32_t first = 0, std::uint32_t fov = 3'141'593, std::uint16_t sensor = 0,
            std::uint32_t session = 1) {
    base::Bytes words;
    for (const double range : own) netio::put_own_range(range, words);
    const netio::OwnReadings body{.type = netio::kOwnLaser,
                                  .count = static_cast<std::uint16_t>(own.size()),
                                  .total = total,
                                  .first = first,
                                  .fov = fov,
                                  .words = words};
    fusion.take({.robot = 1, .sensor = sensor, .time = sent, .session = session}, body, 0, now, log);
  }
  base::ReadingBlock fused(std::int64_t now) {
    base::ReadingBlock block{.type = sensors::kLaser,
                             .time = now,
                             .values = ranges,
                             .hits = hits,
                             .bound = 1e-6,
                             .bound_without_noise = 1e-6,
                             .quality = quality};
    fusion.fuse({&block, 1});
    return block;
  }
};

std::vector<double> list(std::span<const double> values) { return {values.begin(), values.end()}; }

// 10 s and 1 ms of offset of the sender's clock.
TEST(ReadingFusion, TheNearerEchoOfBothWorldsCounts) {
  Lab lab;
  lab.send({1.5, kNone, kUnknown, 2.5, 7.0}, 11'000 * kMs, 1001 * kMs);
  const base::ReadingBlock fused = lab.fused(1050 * kMs);
  EXPECT_TRUE(fused.fused);
  EXPECT_EQ(list(fused.values), (std::vector<double>{1.5, 2.0, 2.0, 2.0, 7.0}));
  EXPECT_EQ(std::vector(fused.hits.begin(), fused.hits.end()),
            (std::vector<std::uint32_t>{base::kNoHit, 3, 3, 3, base::kNoHit}));
  EXPECT_EQ(fused.bound, HUGE_VAL);
  EXPECT_EQ(fused.sigma, HUGE_VAL);
  EXPECT_TRUE(fused.quality.empty());
  EXPECT_EQ(lab.ranges[0], 2.0) << "the virtual reading is kept as it was";
  EXPECT_EQ(lab.fusion.counts(), (FusionCounts{.taken = 1, .fused = 1, .age_s = 0.049, .oldest_s = 0.049}));
}

// A wall of both worlds is seen once, and twice fused is fused.
TEST(ReadingFusion, IsIdempotent) {
  Lab lab;
  lab.send(lab.ranges, 0, 0);
  EXPECT_EQ(list(lab.fused(0).values), lab.ranges);
  lab.send({1.0, 1.0, 1.0, 1.0, 1.0}, kMs, kMs);
  const std::vector<double> once = list(lab.fused(kMs).values);
  lab.ranges = once;
  EXPECT_EQ(list(lab.fused(kMs).values), once);
}

// Boundaries: the limits of the virtual sensor, 0.1 and 8 m.
TEST(ReadingFusion, RangesAreCutToTheVirtualSensorsLimits) {
  Lab lab;
  lab.ranges = {8.0, 8.0, 8.0, 0.1, 8.0};
  lab.quality = std::vector(5, base::QualityFlag::none);
  lab.quality[3] = base::QualityFlag::too_near;
  lab.send({0.1, 0.0999, 8.0, 0.2, 20.0}, 0, 0);
  const base::ReadingBlock fused = lab.fused(0);
  EXPECT_EQ(list(fused.values), (std::vector<double>{0.1, 0.1, 8.0, 0.1, 8.0}));
  using base::QualityFlag;
  EXPECT_EQ(std::vector(fused.quality.begin(), fused.quality.end()),
            (std::vector{QualityFlag::none, QualityFlag::too_near, QualityFlag::none, QualityFlag::too_near,
                         QualityFlag::none}));
}

TEST(ReadingFusion, NothingOldIsFused) {
  Lab lab;
  lab.send({1, 1, 1, 1, 1}, 5000 * kMs, 100 * kMs);
  EXPECT_TRUE(lab.fused(350 * kMs).fused) << "250 ms: the largest age";
  const base::ReadingBlock late = lab.fused(351 * kMs);
  EXPECT_FALSE(late.fused);
  EXPECT_EQ(list(late.values), lab.ranges);
  EXPECT_EQ(late.bound, 1e-6);
  // A packet that was 400 ms under way is known to be old, since the clock is known from the one before.
  lab.send({1, 1, 1, 1, 1}, 5300 * kMs, 800 * kMs);
  EXPECT_FALSE(lab.fused(800 * kMs).fused);
  lab.send({1, 1, 1, 1, 1}, 5400 * kMs, 2000 * kMs);
  EXPECT_EQ(lab.fusion.counts(),
            (FusionCounts{.taken = 2, .mistimed = 1, .fused = 1, .too_old = 2, .age_s = 0.25, .oldest_s = 0.25}));
}

TEST(ReadingFusion, AReadingWithoutAKnownValueIsNotFused) {
  Lab lab;
  lab.send(std::vector(5, kUnknown), 0, 0);
  EXPECT_FALSE(lab.fused(0).fused);
  EXPECT_EQ(lab.fusion.counts(), (FusionCounts{.taken = 1}));
}

TEST(ReadingFusion, OvertakenReadingsAndThoseOfAnEarlierSessionDoNotCount) {
  Lab lab;
  lab.send({1, 1, 1, 1, 1}, 9000 * kMs, 100 * kMs);
  lab.send({0.5, 1, 1, 1, 1}, 9000 * kMs, 110 * kMs);
  lab.send({0.5, 1, 1, 1, 1}, 8990 * kMs, 110 * kMs);
  EXPECT_EQ(lab.fused(120 * kMs).values[0], 1.0);
  EXPECT_EQ(lab.fusion.counts().overtaken, 2u);
  lab.send({kUnknown, 1.5, 1, 1, 1}, 0, 150 * kMs, 5, 0, 3'141'593, 0, 2);
  EXPECT_EQ(list(lab.fused(150 * kMs).values), (std::vector<double>{2, 1.5, 1, 1, 1})) << "a new clock";
}

/// A sensor of the session before is not compared by the new clock.
TEST(ReadingFusion, ANewSessionForgetsAllSensors) {
  world::World world = room(10.0);
  world.movers[0].sensors.push_back(world.movers[0].sensors[0]);
  world.movers[0].sensors[1].name = "rear";
  const sensors::SensorSet sensor_set(world);
  ReadingFusion fusion(world, sensor_set, {});
  netio::RateLimitedLog log(-1);
  base::Bytes words;
  for (int i = 0; i < 91; ++i) netio::put_own_range(0.5, words);
  const auto fov = static_cast<std::uint32_t>(std::llround(1e6 * sensor_set.of(sensors::kLaser, 0)[0].fov));
  const netio::OwnReadings own{.type = netio::kOwnLaser, .count = 91, .total = 91, .fov = fov, .words = words};
  fusion.take({.robot = 1, .sensor = 1, .time = 900'000 * kMs, .session = 1}, own, 0, 0, log);
  fusion.take({.robot = 1, .sensor = 0, .time = 0, .session = 2}, own, 0, 60'000 * kMs, log);
  const std::vector<double> ranges(91, 2.0);
  std::vector<base::ReadingBlock> blocks(2, {.type = sensors::kLaser, .time = 60'000 * kMs, .values = ranges});
  blocks[1].sensor = 1;
  fusion.fuse(blocks);
  EXPECT_TRUE(blocks[0].fused);
  EXPECT_FALSE(blocks[1].fused);
}

TEST(ReadingFusion, RefusesOtherBeamsWithOneLine) {
  Lab lab;
  lab.send({1, 1, 1, 1}, 0, 0, 4);
  lab.send({1, 1, 1, 1}, kMs, kMs, 4);
  EXPECT_NE(lab.pipe.read_all().find("OWN_READINGS of laser 0 of robot1 (id 1) are dropped: they have 4 values, and "
                                     "those of 'laser' in the world file 5\n"),
            std::string::npos);
  lab.send({1, 1, 1, 1, 1}, kMs, kMs, 5, 0, 3'139'000);
  EXPECT_NE(lab.pipe.read_all().find("their field of view is 3.139 rad, and that of 'laser' in the world file 3.142"),
            std::string::npos);
  lab.send({1, 1, 1, 1, 1}, kMs, kMs, 5, 0, 3'141'593, 1);
  EXPECT_NE(lab.pipe.read_all().find("laser 1 of robot1 (id 1) are dropped: the world file gives it fewer sensors"),
            std::string::npos);
  EXPECT_FALSE(lab.fused(kMs).fused);
  EXPECT_EQ(lab.fusion.counts(), (FusionCounts{.unfit = 4}));
  for (std::uint16_t sensor = 60; sensor < 1000; ++sensor) lab.send({1, 1, 1, 1, 1}, 0, 0, 5, 0, 3'141'593, sensor);
  EXPECT_EQ(lab.fusion.counts().unfit, 944u);
}

/// Boundaries: a first part, a last one, a lost one.
TEST(ReadingFusion, LargeScansArriveInParts) {
  world::World world = room(10.0, 0.0, 700);
  const sensors::SensorSet sensor_set(world);
  ReadingFusion fusion(world, sensor_set, {});
  netio::RateLimitedLog log(-1);
  const auto fov = static_cast<std::uint32_t>(std::llround(1e6 * sensor_set.of(sensors::kLaser, 0)[0].fov));
  const auto send = [&](std::uint32_t first, std::int64_t time, double range) {
    const auto count = std::min(310u, 700 - first);
    base::Bytes words;
    for (std::uint32_t i = 0; i < count; ++i) netio::put_own_range(range, words);
    fusion.take({.robot = 1, .time = time, .session = 1},
                {netio::kOwnLaser, static_cast<std::uint16_t>(count), 700, first, fov, words}, 0, time, log);
  };
  const std::vector<double> ranges(700, 2.0);
  const auto fused = [&](std::int64_t now) {
    base::ReadingBlock block{.type = sensors::kLaser, .time = now, .values = ranges};
    fusion.fuse({&block, 1});
    return list(block.values);
  };
  send(0, 0, 1.0), send(310, 0, 1.1);
  EXPECT_EQ(fused(0), ranges) << "not whole yet";
  send(620, 0, 1.2);
  std::vector<double> expected(700, 1.0);
  std::fill(expected.begin() + 310, expected.end(), 1.1);
  std::fill(expected.begin() + 620, expected.end(), 1.2);
  EXPECT_EQ(fused(0), expected);
  send(0, kMs, 0.5), send(620, kMs, 0.5), send(310, kMs, 0.5);
  EXPECT_EQ(fused(kMs), expected) << "out of order: the last whole one counts";
  send(310, 2 * kMs, 0.5), send(620, 2 * kMs, 0.5);
  send(0, 3 * kMs, 0.5), send(310, 3 * kMs, 0.5);
  send(0, 4 * kMs, 0.4), send(310, 4 * kMs, 0.4), send(620, 4 * kMs, 0.4);
  EXPECT_EQ(fused(4 * kMs), std::vector(700, 0.4));
  EXPECT_EQ(fusion.counts(),
            (FusionCounts{.taken = 2, .incomplete = 3, .fused = 3, .age_s = 0.001, .oldest_s = 0.001}));
}

/// A real robot at the origin, facing +x, shows walls to a simulated one 1 m behind it until it sees through them.
TEST(ReadingFusion, RealWallsStandInTheWayOfSimulatedRobots) {
  world::World world = room(10.0, 0.0, 3);
  const sensors::SensorSet sensor_set(world);
  ReadingFusion fusion(world, sensor_set, {});
  netio::RateLimitedLog log(-1);
  const auto fov = static_cast<std::uint32_t>(std::llround(1e6 * sensor_set.of(sensors::kLaser, 0)[0].fov));
  const std::vector<double> ranges(3, 6.0);
  const auto run = [&](std::int64_t time, std::int64_t age, double ahead, double yaw = 0.0) {
    base::Bytes words;
    for (const double range : {kUnknown, ahead, kUnknown}) netio::put_own_range(range, words);
    fusion.take({.robot = 1, .time = time - age, .session = 1}, {netio::kOwnLaser, 3, 3, 0, fov, words}, 0, time, log);
    std::vector<base::ReadingBlock> blocks(2, {.type = sensors::kLaser, .time = time, .values = ranges});
    blocks[0].X_WS.yaw = yaw;
    blocks[1].mover = 1;
    blocks[1].X_WS = {-1.0, 0.0, 0.0, 0.0};
    fusion.fuse(blocks);
    EXPECT_EQ(list(blocks[0].values)[1], std::min(6.0, ahead)) << "of both worlds at once";
    EXPECT_EQ(blocks[1].fused, blocks[1].values[1] < 6.0);
    EXPECT_EQ(blocks[1].values[0], 6.0);
    return blocks[1].values[1];
  };
  constexpr double kNear = 1.001 * RealWalls::kCell;
  EXPECT_EQ(run(0, 0, 2.0), 6.0) << "its pose is known from the second reading on";
  EXPECT_NEAR(run(100 * kMs, 0, 2.0), 3.0, kNear);
  EXPECT_NEAR(run(200 * kMs, 0, HUGE_VAL), 3.0, kNear) << "no echo shows nothing";
  EXPECT_NEAR(run(300 * kMs, 100 * kMs - 1, 1.0, 1.5), 2.0, kNear) << "measured before it turned by 1.5 rad";
  EXPECT_NEAR(run(400 * kMs, 0, 2.5), 3.5, kNear) << "seen through, after one echo";
  EXPECT_NEAR(run(900 * kMs, 100 * kMs, 1.0), 3.5, kNear) << "too long since the last reading to know its pose";
  EXPECT_EQ(fusion.counts().mapped, 5u);
}

// The range of 0.02 m is 1023 x (1 - 0.4) of the response; a bumper is pressed if either is.
TEST(ReadingFusion, InfraredRespondsToTheNearerAndBumpersToBoth) {
  Lab lab;
  base::Bytes words;
  netio::put_own_range(0.02, words);
  lab.fusion.take({.robot = 1, .time = 0, .session = 1},
                  {.type = netio::kOwnInfrared, .count = 1, .total = 1, .words = words}, 0, 0, lab.log);
  const std::vector<double> far{0.05, 0.0}, pressed{1.0}, free{0.0};
  base::ReadingBlock block{.type = sensors::kInfrared, .values = far};
  lab.fusion.fuse({&block, 1});
  EXPECT_EQ(list(block.values), (std::vector{0.02, 614.0}));
  for (const int own : {0, 1}) {
    const std::uint8_t bits[] = {static_cast<std::uint8_t>(own), 0, 0, 0};
    lab.fusion.take({.robot = 1, .time = 1 + own, .session = 1},
                    {.type = netio::kOwnBumper, .count = 1, .total = 1, .words = bits}, 0, 0, lab.log);
    for (const auto& values : {pressed, free}) {
      base::ReadingBlock bumper{.type = sensors::kBumper, .values = values};
      lab.fusion.fuse({&bumper, 1});
      EXPECT_TRUE(bumper.fused);
      EXPECT_EQ(list(bumper.values), own == 1 || values == pressed ? pressed : free);
    }
  }
  EXPECT_EQ(lab.pipe.read_all(), "");
}

/// By time of arrival, timestamps do not count.
TEST(ReadingFusion, DatesReadingsByTheClockThatIsChosen) {
  for (const auto source : {estimation::ClockSource::arrival, estimation::ClockSource::trusted}) {
    Lab lab{.options = {.clock = {.source = source}, .epoch = 1000 * kMs}};
    lab.send({1, 1, 1, 1, 1}, 900 * kMs, 200 * kMs);
    const bool by_arrival = source == estimation::ClockSource::arrival;
    EXPECT_EQ(lab.fused(200 * kMs).fused, by_arrival) << "300 ms under way";
    lab.send({1, 1, 1, 1, 1}, (by_arrival ? 800 : 1100) * kMs, 200 * kMs);
    EXPECT_TRUE(lab.fused(300 * kMs).fused);
    EXPECT_EQ(lab.fused(450 * kMs).fused, by_arrival);
  }
}

/// A robot of its own process, in the room with another.
struct RealLink {
  Fixture f;
  RobotLink link{f.world,
                 f.sensor_set,
                 1,
                 f.layout,
                 {.farm = {netio::kLoopback, f.service->port()}},
                 [](const netio::Packet&, std::int64_t) {}};
  std::vector<double> own = std::vector(91, kNone);

  /// Runs a tick in which the robot stands, and sends its own reading `age` ago by its clock.
  void run(std::int64_t age = 0) {
    link.send_state({.X_WR = {2.0, 1.0, 0.0, 0.0}}, f.now);
    const double fov = f.sensor_set.of(sensors::kLaser, 1)[0].fov;
    if (link.last_answer())
      link.send_own_reading({.type = sensors::kLaser, .time = f.now - age, .values = own, .fov = fov}, f.now);
    f.run(1);
    link.run(f.now);
  }
  base::ReadingBlock newest() { return link.readings()[0].block; }
};

// The reading reaches the robot fused, by the packets of both directions; the other robot's is not changed.
TEST(ReadingFusion, AServiceSendsFusedReadings) {
  RealLink real;
  for (int i = 0; i < 4; ++i) real.run();
  const std::vector<double> alone = list(real.newest().values);
  EXPECT_TRUE(real.newest().fused) << "with no echo, but known";
  real.own[45] = 0.25;
  real.run();
  std::vector<double> expected = alone;
  expected[45] = 0.25;
  EXPECT_EQ(list(real.newest().values), expected);
  EXPECT_TRUE(real.newest().fused);
  EXPECT_EQ(real.newest().sigma, 0.0) << "what a packet cannot say";
  EXPECT_EQ(real.newest().bound, HUGE_VAL);
  for (int i = 0; i < 3; ++i) {  // it sends no more
    real.link.send_state({.X_WR = {2.0, 1.0, 0.0, 0.0}}, real.f.now);
    real.f.run(1);
    real.link.run(real.f.now);
  }
  EXPECT_FALSE(real.newest().fused);
  EXPECT_EQ(list(real.newest().values), alone);
  const FusionCounts counts = real.f.service->stats().fusion;
  EXPECT_EQ(counts.taken, counts.fused - 2) << "the last one in two more ticks";
  EXPECT_EQ(counts.too_old, 1u);
  EXPECT_EQ(real.f.log.read_all(), "");
}

}  // namespace
}  // namespace sf::server
