// Tiles give exactly the results of one process: readings, states and contacts.

#include "scenarios/fleet_tiles.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/cluster/thread_ranks.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/scenes.h"
#include "tests/world/read_world.h"

namespace sf::scenarios {

namespace {

world::World read(const std::string& text) {
  return world::read_world("include \"robots.inc\"\n" + text, {.sensors = sensors::world_file_words()});
}

/// Rows of houses, and robots between them with all kinds of sensors that have a state or a long range.
world::World town(unsigned robots) {
  std::string text =
      "define house model( size [2 2 1] )\n"
      "define walker create( create_laser( range_max 2 ) create_map( laser \"\" ) create_encoder( ) create_battery( ) "
      "create_gyro( ) )\n"
      "define driver pioneer3at( pioneer_sonar( ) pioneer_encoder( ) pioneer_battery( ) outdoor_gps( ) mems_gyro( ) "
      ")\n";
  text.replace(text.find(" create_battery( )"), 1, " lidar( channels 2 columns 16 range [0 2] rate 5 rolling 1 ) ");
  text.replace(text.find(" create_gyro( )"), 15, " mems_gyro( latency 0.25 )");
  text.replace(text.find("( laser \"\" )"), 12, "( )");
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 4; ++y)
      text += "house( pose [" + std::to_string(5 * x) + " " + std::to_string(5 * y) + " 0 0] )\n";
  for (unsigned k = 0; k < robots; ++k)
    text += std::string(k % 2 == 0 ? "walker" : "driver") + "( name \"r" + std::to_string(k) + "\" pose [" +
            std::to_string(2.5 + 5.0 * (k % 5)) + " " + std::to_string(0.3 + 1.6 * (k / 5)) + " 0 " +
            std::to_string(75 * k) + "] )\n";
  return read(text);
}

struct Course {
  std::uint64_t hash = 0;
  std::vector<double> states;  ///< of all movers at all ticks, and contacts
  std::uint64_t passed_on = 0;
  bool operator==(const Course& other) const { return hash == other.hash && states == other.states; }
};

Course run(const world::World& world, gpu::Device& on, SimulationOptions options, int ticks) {
  Course course;
  Simulation simulation(world, on, options);
  for (int i = 0; i < ticks; ++i) {
    const base::TickRecord tick = simulation.step();
    for (const base::Report& r : tick.reports)
      for (const double v : {r.X_WM.x, r.X_WM.y, r.X_WM.yaw, r.velocity.forward, r.velocity.turn,
                             double(tick.contacts[r.mover]), double(r.contact_mask)})
        course.states.push_back(v);
    simulation.settle();
  }
  course.hash = simulation.farm().hash();
  course.passed_on = simulation.share().passed_on().value_or(0);
  return course;
}

/// Returns the first rank's course, which has all states, and the number of robots that all ranks have handed over.
Course run_in_tiles(const world::World& world, unsigned ranks, SimulationOptions options, int ticks,
                    bool tiles = true) {
  std::vector<Course> courses(ranks);
  std::vector<std::unique_ptr<gpu::Device>> devices;
  for (unsigned rank = 0; rank < ranks; ++rank) devices.push_back(std::make_unique<gpu::Device>());
  options.tiles = tiles;
  options.threads = 1;
  cluster::ThreadRanks(ranks).run([&](cluster::Ranks& one) {
    SimulationOptions own = options;
    own.ranks = &one;
    courses[one.rank()] = run(world, *devices[one.rank()], own, ticks);
  });
  for (unsigned rank = 1; rank < ranks; ++rank) courses[0].passed_on += courses[rank].passed_on;
  return courses[0];
}

void expect_same(const world::World& world, const SimulationOptions& options, int ticks,
                 std::vector<unsigned> numbers = {3}) {
  const Course alone = run(world, device(), options, ticks);
  for (const unsigned ranks : numbers) {
    const Course tiled = run_in_tiles(world, ranks, options, ticks);
    EXPECT_EQ(tiled.hash, alone.hash) << ranks << " ranks";
    EXPECT_EQ(tiled.states, alone.states) << ranks << " ranks";
    EXPECT_GT(tiled.passed_on, 0u) << ranks << " ranks";
  }
}

TEST(FleetTiles, MatchASingleProcessBitwise) { expect_same(town(30), {.seed = 3}, 150, {2, 3, 5}); }

/// Faults act where a robot's readings are delivered, so ranks give the readings of one process, in tiles and in
/// shares.
TEST(FleetTiles, FaultsOfSensorsAreThose) {
  using Kind = base::FaultKind;
  SimulationOptions options{.seed = 3};
  const auto fault = [&](Kind kind, const char* type, double amount, double from) {
    options.faults.push_back(
        {.kind = kind, .robot = "*", .type = type, .amount = amount, .from = from, .until = from + 3.0});
  };
  fault(Kind::bias, "encoder", 0.2, 1.0), fault(Kind::dropout, "encoder", 0.0, 5.0);
  fault(Kind::noise, "gyro", 0.1, 1.0), fault(Kind::stuck, "gyro", 0.0, 5.0);
  fault(Kind::scale, "laser", 1.2, 0.0), fault(Kind::quantization, "gps", 0.5, 2.0);
  const world::World world = town(20);
  expect_same(world, options, 100);
  EXPECT_NE(run(world, device(), options, 100).hash, run(world, device(), {.seed = 3}, 100).hash);
  EXPECT_EQ(run_in_tiles(world, 3, options, 100, false).hash, run(world, device(), options, 100).hash);
}

TEST(FleetTiles, DelaysAreRefused) {
  SimulationOptions options{.faults = {{.kind = base::FaultKind::delay, .robot = "*", .type = "gyro", .amount = 0.1}}};
  const world::World world = town(4);
  cluster::ThreadRanks(1).run([&](cluster::Ranks& one) {
    options.ranks = &one;
    expect_in("a delay cannot be simulated by several ranks",
              refusal_of([&] { Simulation(world, device(), options); }));
  });
}

/// With a slow link, a robot decides by readings that it received in another tile.
TEST(FleetTiles, MatchASingleProcessBitwiseWithASlowLink) {
  SimulationOptions options{.seed = 4};
  options.actor.link = {.delay = 0.1, .jitter = 0.2, .loss = 0.1, .seed = 7};
  expect_same(town(20), options, 80);
}

/// Times differ between runs, and so do the tiles, but the results do not.
TEST(FleetTiles, RepartitionsChangeNothing) { expect_same(town(24), {.seed = 8, .balance = 0.4}, 100); }

/// The first robot is at rest, which takes no time, so the second one is handed over to its rank, which must have its
/// state before.
TEST(FleetTiles, ARepartitionHandsOverARobotFarFromTheOldEdge) {
  std::string text;
  for (int k = 0; k < 3; ++k)
    text += "create( name \"r" + std::to_string(k) + "\" pose [" + std::to_string(60 * k) +
            " 0 0 20] create_laser( ) )\nmodel( size [1 1 1] pose [" + std::to_string(60 * k + 1) + " 0 0 10] )\n";
  const world::World world = read(text);
  SimulationOptions options{.seed = 9, .balance = 0.2};
  options.actors.assign(3, options.actor);
  options.actors[0].controller.name.clear();
  expect_same(world, options, 60, {2});
}

/// Cars that communicate across the town and follow each other's intents.
TEST(FleetTiles, RobotsCommunicateAcrossEdges) {
  const world::World world =
      world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world", {.sensors = sensors::world_file_words()});
  SimulationOptions options{.seed = 5};
  options.actor.controller.name.clear();
  options.actors.assign(world.movers.size(), options.actor);
  for (std::size_t m = 0; m < world.movers.size(); ++m)
    if (world.movers[m].name.starts_with("roomba") && world.movers[m].name < "roomba3")
      options.actors[m].controller = {"route", 0.0, {"controller 'route'", {{"tour", true, ""}, {"radio", 30.0, ""}}}};
  expect_same(world, options, 300);
}

TEST(FleetTiles, RefusesSimulatedV2v) {
  const world::World world = town(4);
  cluster::ThreadRanks(2).run([&](cluster::Ranks& one) {
    gpu::Device own;
    const SimulationOptions options{.v2v = V2vLinkOptions{}, .ranks = &one, .tiles = true};
    expect_in("[v2v] cannot be simulated with --tiles", refusal_of([&] { Simulation(world, own, options); }));
  });
}

/// The fields of magnets are summed in the order of a single process.
TEST(FleetTiles, CarriedMagnetsAreAvailableEverywhere) {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += "create( name \"r" + std::to_string(k) + "\" pose [" + std::to_string(3 * k) +
            " 0 0 0] create_magnetometer( ) create_laser( )"
            " model( size [0.02 0.02 0.02] magnetic_moment 10000 magnetometer_return 1 obstacle_return 0 ) )\n";
  expect_same(read(text), {.seed = 6}, 60);
}

TEST(FleetTiles, EachRankKeepsItsHouses) {
  const world::World whole = town(30);
  std::vector<std::size_t> walls(4);
  cluster::ThreadRanks(4).run([&](cluster::Ranks& one) {
    world::World part = whole;
    FleetTiles(one, whole).keep_own_part(part);
    walls[one.rank()] = part.walls.size();
  });
  for (const std::size_t count : walls) EXPECT_LT(count, whole.walls.size());
}

/// A world whose houses are in a file; one robot starts in the first house of the second row.
std::string town_in_file() {
  const auto file = std::filesystem::temp_directory_path() / "town.csv";
  std::ofstream out(file);
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 4; ++y)
      out << fmt::format("POLYGON (({0} {1}, {2} {1}, {2} {3}, {0} {3}))\n", 5 * x - 1, 5 * y - 1, 5 * x + 1,
                         5 * y + 1);
  std::string text = "model( outlines \"" + file.string() + "\" size [0 0 1] )\n";
  for (int k = 0; k < 12; ++k)
    text += fmt::format("create( name \"r{}\" pose [{} {} 0 {}] create_laser( range_max 2 ) )\n", k,
                        2.5 + 5.0 * (k % 4), 2.5 + 5.0 * (k / 4), 75 * k);
  return text + "create( name \"lost\" pose [0 5 0 0] )\n";
}

TEST(FleetTiles, RanksReadOnlyTheirPartOfAFile) {
  const std::string text = town_in_file();
  const world::World whole = read(text);
  world::LoadOptions options{.sensors = sensors::world_file_words()};
  options.leave_outlines = true;
  const world::World left = world::read_world("include \"robots.inc\"\n" + text, options);
  ASSERT_EQ(left.walls.size(), 0u);
  const Course alone = run(whole, device(), {.seed = 3}, 60);
  EXPECT_EQ(run_in_tiles(left, 3, {.seed = 3}, 60), alone);
}

TEST(FleetTiles, RobotsInWallsOfAFileAreNoticed) {  // once each rank has its walls; all ranks report the same
  world::LoadOptions options{.sensors = sensors::world_file_words()};
  options.leave_outlines = true;
  const world::World left = world::read_world("include \"robots.inc\"\n" + town_in_file(), options);
  cluster::ThreadRanks(3).run([&](cluster::Ranks& one) {
    world::World part = left;
    FleetTiles tiles(one, left);
    tiles.keep_own_part(part);
    EXPECT_LT(part.walls.size(), 96u);
    const std::vector<world::Warning> warnings = tiles.warnings_of_starts(part);
    ASSERT_EQ(warnings.size(), 1u);
    expect_in("'lost' starts at (0, 5), within a wall", warnings[0].message);
  });
}

}  // namespace

}  // namespace sf::scenarios
