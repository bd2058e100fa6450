// Objects that change their shape, size and colour during a run.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "raycast/casters.h"
#include "record/recorder.h"
#include "record/recording.h"
#include "scenarios/recorded_states.h"
#include "scenarios/recording_verification.h"
#include "scenarios/run_info.h"
#include "scenarios/runner.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/cluster/thread_ranks.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "world/shapes.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

/// Two robots far from each other, each with sensors of several kinds; the object is in the range of the first only.
constexpr const char* kProbes = R"(
interval_sim 100
define probe position
(
  size [0.3 0.3 0.2]
  laser ( name "front" samples 91 fov 180 range_max 4 rate 10 noise [0.02 0 0] )
  laser ( name "exact" samples 31 fov 360 range_max 4 rate 7 latency 0.25 )
  sonar ( scount 2 spose[0] [0.1 0 0] spose[1] [0.1 0.1 30] range [0 3] fov 20 )
  infrared ( icount 2 ipose[0] [0.1 0 0] ipose[1] [0.1 0.1 60] )
  encoder ( slip 0.1 )
  gyro ( )
)
probe ( name "a" )
probe ( name "b" pose [40 0 0 0] )
)";

world::World room(const std::string& object, const std::string& shapes = "") {
  return world::build_world("shapes.world", shapes + kProbes + object, {.sensors = sensors::world_file_words()});
}

constexpr const char* kBlocks =
    "block( points 3 point[0] [0 0] point[1] [2 0] point[2] [0.3 1.7] z [0 1] ) block( points 4 point[0] [0 0] "
    "point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0.2 0.9] )";
const std::string kShapes = std::string(
                                "shape( name \"crate\" size [0.7 0.31 0.4] color \"red\" ) shape( name \"wedge\" "
                                "size [0.9 0.77 0.3] ") +
                            kBlocks + " )\n";

std::string tag(const std::string& rest) { return "model( name \"tag3\" pose [1.3 0.2 0 20] " + rest + " )\n"; }

SimulationOptions standing(const char* caster) {
  SimulationOptions options{.seed = 5};
  options.actor.controller.name.clear();
  options.caster = raycast::caster_named(caster);
  return options;
}

/// The readings of one robot at one tick.
std::vector<double> readings_of(const base::TickRecord& tick, std::uint32_t mover) {
  std::vector<double> all;
  for (const base::ReadingBlock& r : tick.readings) {
    if (r.mover != mover) continue;
    all.insert(all.end(), {double(r.type), double(r.sensor), double(r.sequence), double(r.time)});
    all.insert(all.end(), r.values.begin(), r.values.end());
    all.insert(all.end(), r.hits.begin(), r.hits.end());
  }
  return all;
}

/// Steps two simulations, and returns the ticks at which robots 0 and 1 read the same in both, bitwise.
struct Agreement {
  std::vector<bool> first, second;
};
template <class Before>
Agreement compare(Simulation& one, Simulation& other, int ticks, Before&& before) {
  Agreement agreement;
  for (int tick = 0; tick < ticks; ++tick) {
    before(tick);
    const base::TickRecord a = one.step();
    const std::vector<double> seen[] = {readings_of(a, 0), readings_of(a, 1)};
    const base::TickRecord b = other.step();
    agreement.first.push_back(seen[0] == readings_of(b, 0));
    agreement.second.push_back(seen[1] == readings_of(b, 1));
  }
  return agreement;
}

/// A gear, whose outline exceeds the device's reserve for outlines that change.
std::string gear() {
  constexpr int kPoints = 600;
  std::string block = fmt::format("block( points {}", kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * M_PI * i / kPoints, radius = i % 2 == 0 ? 0.5 : 0.45;
    block += fmt::format(" point[{}] [{:.6f} {:.6f}]", i, radius * std::cos(angle), radius * std::sin(angle));
  }
  return block + " z [0 1] )";
}

/// A change to a shape that the file could have given from the start: the same bytes after it, latency included.
TEST(ShapeChange, EqualsAWorldWithTheNewShapeFromTheStart) {
  struct Case {
    std::string written;
    world::ShapeChange change;
  };
  const Case cases[] = {{"size [0.7 0.31 0.4] color \"red\"", {.shape = "crate"}},
                        {std::string("size [0.9 0.77 0.3] ") + kBlocks, {.shape = "wedge"}},
                        {"size [0.8 0.8 0.4] " + gear(), {.shape = "gear"}},
                        {"size [0.43 0.87 0.33]", {.size = glm::dvec3{0.43, 0.87, 0.33}}},
                        {"size [0.43 0.87 0.33]", {.shape = "crate", .size = glm::dvec3{0.43, 0.87, 0.33}}}};
  for (const char* caster : {"host", "vulkan"})
    for (const Case& c : cases) {
      const std::string shapes = kShapes + "shape( name \"gear\" size [0.8 0.8 0.4] " + gear() + " )\n";
      world::World changing = room(tag("size [0.2 0.2 0.3]"), shapes);
      const world::World fixed = room(tag(c.written), shapes);
      Simulation one(changing, device(), standing(caster)), other(fixed, device(), standing(caster));
      const Agreement same =
          compare(one, other, 20, [&](int tick) { tick == 8 ? one.set_shape(changing, 2, c.change) : void(); });
      int differed = 0;
      for (int tick = 0; tick < 20; ++tick) {
        EXPECT_TRUE(same.second[tick]) << caster << " " << c.written << ", tick " << tick;
        if (tick < 8) differed += !same.first[tick];
        EXPECT_TRUE(tick < 12 || same.first[tick]) << caster << " " << c.written << ", tick " << tick;
      }
      EXPECT_GT(differed, 4) << c.written;
    }
}

/// Walls did not change, so their lists need not be built again.
TEST(ShapeChange, ListsOfWallsStay) {
  for (const char* caster : {"host", "vulkan"}) {
    world::World world = room(tag("size [0.2 0.2 0.3]"), kShapes);
    Simulation simulation(world, device(), standing(caster));
    for (int tick = 0; tick < 10; ++tick) simulation.step();
    const std::uint64_t built = simulation.farm().stats().work.cells_built;
    EXPECT_GT(built, 0u);
    simulation.set_shape(world, 2, {.shape = "crate"});
    for (int tick = 0; tick < 10; ++tick) simulation.step();
    EXPECT_EQ(simulation.farm().stats().work.cells_built, built) << caster;
  }
}

TEST(ShapeChange, RevertingRestoresTheBytes) {
  for (const char* caster : {"host", "vulkan"}) {
    world::World changing = room(tag(std::string("size [0.2 0.5 0.3] origin [0.1 0 0 30] ") + kBlocks), kShapes);
    const world::World fixed = changing;
    Simulation one(changing, device(), standing(caster)), other(fixed, device(), standing(caster));
    const Agreement same = compare(one, other, 24, [&](int tick) {
      if (tick == 6) one.set_shape(changing, 2, {.shape = "crate", .color = 0xFF00FF00u});
      if (tick == 9) one.set_shape(changing, 2, {.size = glm::dvec3{1.0, 1.0, 1.0}});
      if (tick == 12) one.set_shape(changing, 2, {.shape = "original"});
    });
    for (int tick = 0; tick < 24; ++tick) {
      EXPECT_TRUE((tick >= 6 && tick < 16) || same.first[tick]) << caster << ", tick " << tick;
      EXPECT_TRUE(same.second[tick]) << caster << ", tick " << tick;
    }
    EXPECT_FALSE(same.first[8]);
    EXPECT_EQ(changing.models[changing.movers[2].model].color, fixed.models[fixed.movers[2].model].color);
  }
}

TEST(ShapeChange, RobotsTouchTheNewOutline) {
  double stopped[2] = {};
  for (const bool grown : {false, true}) {
    world::World world = room(tag("size [0.2 0.2 0.3]"), kShapes);
    world.movers[2].X_WM.yaw = 0.0;
    Simulation simulation(world, device(), standing("host"));
    const std::vector<base::Twist> ahead{{0.5, 0.0, 0.0}, {}, {}};
    bool contact = false;
    for (int tick = 0; tick < 40; ++tick) {
      if (tick == 3 && grown) simulation.set_shape(world, 2, {.size = glm::dvec3{1.2, 1.0, 0.3}});
      simulation.command(ahead);
      const base::TickRecord record = simulation.step();
      stopped[grown] = record.reports[0].X_WM.x;
      contact = contact || record.contacts[0] != 0;
    }
    EXPECT_TRUE(contact);
  }
  EXPECT_NEAR(stopped[0] - stopped[1], 0.5, 2e-3);
}

/// Delayed scans, samples between ticks and plain C++ use the geometry of their times.
TEST(ShapeChange, RecordingsAreVerified) {
  world::World world = room(tag("size [0.2 0.2 0.3] origin [0.05 0 0 10]"), kShapes);
  const std::string folder = (std::filesystem::temp_directory_path() / "shape_change").string();
  {
    const sensors::SensorSet sensor_set(world);
    record::Recorder recorder(folder, run_info(world, sensor_set, {.seed = 5, .record_readings = true}));
    Simulation simulation(world, device(), standing("host"));
    for (int tick = 0; tick < 40; ++tick) {
      if (tick % 5 == 2) simulation.set_shape(world, 2, {.shape = "wedge"});
      if (tick % 7 == 3) simulation.set_shape(world, 2, {.size = glm::dvec3{0.9, 0.4, 0.3}});
      if (tick % 11 == 6) simulation.set_shape(world, 2, {.shape = "original", .color = 0xFF00FF00u});
      recorder.write(simulation.step());
    }
  }
  record::Recording recording = record::open_recording(folder);
  EXPECT_TRUE(recording.damage.empty());
  EXPECT_GT(recording.shapes.size(), 10u);
  const Verification v = verify(recording, device(), {.sample = 0});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  EXPECT_GT(v.reference.readings, 60u);
  world::World replayed = recorded_world(recording);
  RecordedShapes shapes(recording, replayed);
  EXPECT_TRUE(shapes.go_to(recording.end_time));
  EXPECT_EQ(replayed.movers[2].body.size(), world.movers[2].body.size());
  EXPECT_EQ(replayed.models[replayed.movers[2].model].color, world.models[world.movers[2].model].color);
  shapes.go_to(0);
  EXPECT_EQ(replayed.movers[2].body.size(), 4u);
  EXPECT_EQ(shapes.changed().size(), 1u);
  EXPECT_TRUE(replayed.changed_shapes.empty());
  recording.shapes.clear();
  EXPECT_FALSE(verify(recording, device(), {.sample = 0}).sound());
}

/// A robot that joins as a copy has the shape that its original had at the start, as in a recording.
TEST(ShapeChange, CopiesHaveTheOriginalShape) {
  world::World world = room("", kShapes);
  Simulation simulation(world, device(), standing("host"));
  simulation.set_shape(world, 0, {.shape = "wedge", .color = 0xFF00FF00u});
  simulation.step();
  const std::uint32_t row = simulation.add_robot(world, {.name = "c", .like = "a", .X_WM = {8.0, 0.0, 0.0, 0.0}});
  EXPECT_EQ(world.movers[row].body.size(), world.movers[1].body.size());
  EXPECT_EQ(world.movers[row].radius, world.movers[1].radius);
  EXPECT_EQ(world.models[world.movers[row].model].color, world.models[world.movers[1].model].color);
  simulation.set_shape(world, row, {.shape = "wedge"});
  simulation.step();
  EXPECT_EQ(world.movers[row].body.size(), world.movers[0].body.size());
}

std::string event_text(const std::string& events) {
  return "world = \"shapes.world\"\nduration = 2\n[default]\ncontroller = \"none\"\n" + events;
}

TEST(ShapeChange, ScenariosHaveEvents) {
  const std::string folder = std::filesystem::temp_directory_path().string();
  std::ofstream(folder + "/shapes.world") << kShapes << kProbes << tag("size [0.2 0.2 0.3]");
  const auto run = [&](const std::string& events) {
    return run_scenario(parse_scenario(folder + "/shapes.toml", event_text(events)), device());
  };
  const std::string event = "[[event]]\nat = 1\nobject = \"tag3\"\n";
  EXPECT_NE(run(event + "shape = \"crate\"\n").hash, run("").hash);
  EXPECT_NE(run(event + "size = [0.7, 0.31, 0.4]\npresent = true\n").hash, run("").hash);
  EXPECT_EQ(run(event + "shape = \"crate\"\n").hash, run(event + "size = [0.7, 0.31, 0.4]\n").hash);
  EXPECT_EQ(run(event + "color = \"#00ff00\"\n").hash, run("").hash);
  const std::pair<std::string, std::string> kCorpus[] = {
      {"", "shapes.toml:5: 'present' is missing"},
      {"shape = \"crat\"\n", "shapes.toml:5: "},
      {"shape = 3\n", "shapes.toml:8: 'shape' expects"},
      {"color = \"redd\"\n", "shapes.toml:8: unknown colour"},
      {"size = [1, 2]\n", "shapes.toml:8: 'size' expects a list [x, y, z] in metres"},
      {"size = [1, 2, 0]\n", "shapes.toml:5: 'tag3' cannot change: size (1, 2, 0); expected lengths above 0"}};
  for (const auto& [text, message] : kCorpus)
    EXPECT_EQ(refusal_from("shapes.toml", [&] { run(event + text); }).substr(0, message.size()), message) << text;
}

TEST(ShapeChange, RefusesInOneLine) {
  world::World world = room(tag("size [0.2 0.2 0.3]") + "model( name \"tag4\" pose [5 0 0 0] noblocks 1 )\n", kShapes);
  const auto refusal = [&](std::uint32_t mover, const world::ShapeChange& change) {
    return refusal_of([&] { world::check_change(world, mover, change); });
  };
  EXPECT_EQ(refusal(2, {.size = glm::dvec3{1.0, 0.0, 1.0}}),
            "'tag3' cannot change: size (1, 0, 1); expected lengths above 0 and at most 1000 m");
  EXPECT_NE(refusal(2, {.size = glm::dvec3{NAN, 1.0, 1.0}}), "");
  EXPECT_NE(refusal(2, {.size = glm::dvec3{1.0, 1.0, HUGE_VAL}}), "");
  EXPECT_EQ(refusal(2, {.shape = "crat"}),
            "shapes.world: has no shape 'crat'; did you mean 'crate'? Expected one of: original, crate, wedge");
  EXPECT_EQ(refusal(3, {.size = glm::dvec3{1.0, 1.0, 1.0}}),
            "'tag4' cannot change: it has no outline of its own to scale; give a shape, too");
  EXPECT_EQ(refusal(3, {.shape = "crate", .size = glm::dvec3{1.0, 1.0, 1.0}}), "");
  Simulation simulation(world, device(), standing("host"));
  for (std::size_t i = 0; i < Simulation::kMostShapeChanges; ++i)
    simulation.set_shape(world, 2, {.color = 0xFF000000u});
  EXPECT_EQ(refusal_of([&] { simulation.set_shape(world, 2, {.shape = "crate"}); }),
            "more than 1000 changes of shapes in one tick; expected fewer");
  simulation.step();
  simulation.set_shape(world, 2, {.shape = "crate"});
}

TEST(ShapeChange, RanksAgreeAndTilesRefuse) {
  const auto go = [](Simulation& simulation, world::World& world) {
    for (int tick = 0; tick < 20; ++tick) {
      if (tick == 7) simulation.set_shape(world, 2, {.shape = "wedge"});
      if (tick == 13) simulation.set_shape(world, 2, {.size = glm::dvec3{0.5, 1.5, 0.4}});
      simulation.step();
    }
    simulation.settle();
  };
  world::World alone = room(tag("size [0.2 0.2 0.3]"), kShapes);
  Simulation one(alone, device(), standing("host"));
  go(one, alone);
  gpu::Device devices[2];
  cluster::ThreadRanks(2).run([&](cluster::Ranks& rank) {
    world::World world = room(tag("size [0.2 0.2 0.3]"), kShapes);
    SimulationOptions shared = standing("host");
    shared.threads = 1;
    shared.ranks = &rank;
    Simulation simulation(world, devices[rank.rank()], shared);
    go(simulation, world);
    if (rank.rank() == 0) {
      EXPECT_EQ(simulation.farm().hash(), one.farm().hash());
    }
    shared.tiles = true;
    Simulation tiled(world, devices[rank.rank()], shared);
    EXPECT_EQ(refusal_of([&] { tiled.set_shape(world, 2, {.shape = "wedge"}); }),
              "objects cannot change their shapes with --tiles; expected ranks that share the whole world");
  });
}

}  // namespace
}  // namespace sf::scenarios
