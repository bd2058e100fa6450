#include "scenarios/fleet_spawn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "scenarios/run_metrics.h"
#include "tests/refusal.h"
#include "world/roads/roads.h"

namespace sf::scenarios {
namespace {

constexpr const char* kSpawnFile = SF_SOURCE_DIR "/experiments/test.toml";
const std::string kTown = "world = \"../worlds/simville/simville.world\"\n";

Scenario parse(const std::string& text) { return parse_scenario(kSpawnFile, text); }
world::World town(const std::string& text) { return world_of(parse(kTown + text)); }

constexpr const char* kTen = R"(
robots = 10
place = "lanes"
[default]
controller = "route"
settings = { tour = true, localize = false }
[[robot]]
name = "roomba3"
pose = [10.25, 2.0, 90]
)";

TEST(FleetSpawn, NamedRobotsRemainAndCopiesFillTheLanes) {
  std::string crowded = kTen;
  crowded.replace(crowded.find("10"), 2, "45");  // so many that some would be drawn next to the remaining robot
  const world::World world = town(crowded);
  ASSERT_EQ(world.movers.size(), 46u);
  EXPECT_EQ(world.movers[0].name, "roomba3");
  EXPECT_EQ(world.movers[0].X_WM.x, 10.25);
  std::vector<world::Warning> warnings;
  const world::RoadNetwork roads = world::load_roads(world.road_files.at(0), warnings);
  for (std::size_t i = 1; i < world.movers.size(); ++i) {
    const base::Pose& X = world.movers[i].X_WM;
    double nearest = 1e9;
    for (const world::RoadLane& lane : roads.lanes)
      for (double s = 0.0; s < length_of(lane); s += 0.01) {
        const glm::dvec2 p = point_at(lane.centre, s);
        nearest = std::min(nearest, std::hypot(p.x - X.x, p.y - X.y));
      }
    EXPECT_LT(nearest, 0.006) << i;
    for (std::size_t k = 0; k < i; ++k) {
      const base::Pose& other = world.movers[k].X_WM;
      EXPECT_GE(std::hypot(X.x - other.x, X.y - other.y), 0.5 - 1e-9) << i << " and " << k;
    }
  }
}

/// Numbers and names are unique, and rows in tables are valid.
TEST(FleetSpawn, RowsOfModelsAndMoversMatch) {
  const world::World world = town(kTen);
  std::set<std::uint32_t> ids;
  std::set<std::string> names;
  for (const world::Model& model : world.models) names.insert(model.name);
  EXPECT_EQ(names.size(), world.models.size());
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    const world::Mover& mover = world.movers[row];
    EXPECT_TRUE(ids.insert(mover.id).second) << mover.id;
    EXPECT_EQ(mover.name, "roomba" + std::to_string(mover.id));
    EXPECT_EQ(world.models.at(mover.model).name, mover.name);
    EXPECT_EQ(world.models.at(mover.model).mover, row);
    for (const world::Segment& side : mover.body) EXPECT_EQ(world.models.at(side.model).mover, row);
  }
  EXPECT_EQ(ids.count(3), 1u) << "a remaining robot keeps its number";
  for (const world::Light& light : world.lights) EXPECT_EQ(world.models.at(light.model).name, light.name);
}

TEST(FleetSpawn, PlacesDependOnTheSeedButNotOnTheCount) {
  const world::World few = town("robots = 5\nplace = \"lanes\"\n");
  const world::World many = town("robots = 20\nplace = \"lanes\"\n");
  const world::World other = town("robots = 5\nplace = \"lanes\"\nseed = 2\n");
  int same = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(few.movers[i].X_WM.x, many.movers[i].X_WM.x);
    same += few.movers[i].X_WM.x == other.movers[i].X_WM.x;
  }
  EXPECT_LT(same, 5);
}

TEST(FleetSpawn, CopiesAreOfTheFirstOrTheNamedRobot) {
  EXPECT_EQ(town("robots = 2\n").movers[1].sensors.size(), 6u) << "laser, lane edge, magnetometer, encoder, gyro, gps";
  EXPECT_EQ(town("robots = 2\nof = \"khepera6\"\n").movers[1].name, "khepera2");
  EXPECT_EQ(town("robots = 2\nplace = \"lanes\"\nof = \"khepera6\"\n").movers[1].name, "khepera2");
}

/// A [[robot]] entry may name a copy, whose number is the lowest free one.
TEST(FleetSpawn, CopiesMayBeNamedByScenarios) {
  const world::World world = town(
      "robots = 3\nplace = \"lanes\"\n[[robot]]\nname = \"roomba1\"\n"
      "[[robot]]\nname = \"roomba6\"\npose = [0, 7, 0]\n[[robot]]\nname = \"roomba5\"\n"
      "[[robot]]\nname = \"roomba4\"\n[[robot]]\nname = \"roomba3\"\n");
  ASSERT_EQ(world.movers.size(), 7u);
  EXPECT_EQ(world.movers[5].name, "roomba6") << "1, 3, 4 and 5 stay, 2 and 6 are the smallest free";
  EXPECT_EQ(world.movers[5].X_WM.y, 7.0);
}

TEST(FleetSpawn, MistakesAreRejectedAtTheirLine) {
  const std::string magic = "world = \"../worlds/minimagic/minimagic.world\"\n";
  const std::pair<std::string, std::string> kCorpus[] = {
      {kTown + "robots = 5\nplace = \"street\"\n", "test.toml:3: 'place' expects \"free\" or \"lanes\""},
      {kTown + "place = \"lanes\"\n", "test.toml:2: 'place' applies to copies, but there are none"},
      {kTown + "of = \"roomba1\"\nrobots = 0\n", "test.toml:2: 'of' applies to copies"},
      {kTown + "of = \"roomba9\"\nrobots = 2\n", "test.toml:3: "},
      {kTown + "robots = 2\nof = 3\n", "test.toml:3: 'of' expects a text in quotes"},
      {magic + "robots = 2\nof = \"tag1\"\n", "test.toml:2: 'tag1' is a tag, not a robot"},
      {magic + "robots = 2\nplace = \"lanes\"\n", "test.toml:2: robots on lanes, and "},
      {kTown + "robots = 500\nplace = \"lanes\"\n", "test.toml:2: 500 robots 0.50 m apart do not fit"},
  };
  for (const auto& [text, message] : kCorpus) {
    const std::string error = refusal_from("test.toml", [&] { world_of(parse(text)); });
    EXPECT_EQ(error.substr(0, message.size()), message) << text;
  }
}

/// Ten cars for half a minute: no contacts, no red lights passed, and progress.
TEST(FleetSpawn, TenInTrafficAvoidContactsAndObeyLights) {
  gpu::Device device;
  for (const std::uint64_t seed : {1u, 2u}) {
    Scenario scenario = parse(kTown + kTen);
    scenario.seed = seed;
    const world::World world = world_of(scenario);
    Simulation simulation(world, device, simulation_of(scenario, world));
    RunMetrics metrics(world, simulation);
    for (int tick = 0; tick < 300; ++tick) metrics.update(simulation.step());
    EXPECT_EQ(metrics.contacts(), 0u) << seed;
    EXPECT_EQ(metrics.red_lights_passed(), 0u) << seed;
    double metres = 0.0;
    std::uint64_t stops = 0;
    for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
      metres += metrics.of(row).travelled;
      stops += metrics.of(row).stops;
      EXPECT_TRUE(metrics.of(row).goals.any) << world.movers[row].name;
    }
    EXPECT_GT(metres, 25.0) << seed;
    EXPECT_GT(stops, 5u) << seed;
  }
}

}  // namespace
}  // namespace sf::scenarios
