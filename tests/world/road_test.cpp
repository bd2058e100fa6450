// Road networks in a world file: `road( rndf "FILE" )`.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/world/read_world.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

/// Returns a road entity, with paths relative to `worlds/`.
std::string road(const std::string& more) { return "road( rndf \"simville/simville.rndf\"\n" + more + ")"; }

TEST(Road, PaintIsThatOfTheNetwork) {
  const World world = read_world(road(""));
  std::vector<Warning> warnings;
  const RoadNetwork roads = load_roads(SF_SOURCE_DIR "/worlds/simville/simville.rndf", warnings);
  EXPECT_EQ(world.lane_markings.size(), lane_markings_of(roads).size());
  EXPECT_TRUE(world.magnets.empty());
  ASSERT_EQ(world.models.size(), 1u);
  EXPECT_EQ(world.models[0].name, "SimVille");
  ASSERT_EQ(world.road_files.size(), 1u);
  EXPECT_EQ(load_roads(world.road_files[0], warnings).lanes.size(), roads.lanes.size()) << "can be opened again";
  EXPECT_EQ(warnings_of(world), "");
}

TEST(Road, MagnetsAreUnderTheNamedLanes) {
  const World world = read_world(road("magnetic_moment 10000 magnet_spacing 0.071 magnet_lanes \"6.1 6.2\""));
  std::vector<Warning> warnings;
  const RoadNetwork roads = load_roads(SF_SOURCE_DIR "/worlds/simville/simville.rndf", warnings);
  std::size_t expected = 0;
  for (const RoadLane& lane : roads.lanes)
    if (lane_name(roads, lane) == "6.1" || lane_name(roads, lane) == "6.2")
      expected += static_cast<std::size_t>(length_of(lane) / 0.071) + 1;
  EXPECT_EQ(world.magnets.size(), expected);
  std::set<long> lanes;
  for (const Magnet& magnet : world.magnets) lanes.insert(std::lround(magnet.p.y * 1000.0));
  EXPECT_EQ(lanes, (std::set<long>{3250, 3750})) << "West Street runs along y = 3.5 m";
}

TEST(Road, AllLanesUnlessNamed) {
  EXPECT_GT(read_world(road("magnetic_moment 1 magnet_spacing 0.1")).magnets.size(), 400u);
}

TEST(Road, ErrorsNameTheirLine) {
  EXPECT_EQ(error_of("\nroad( )"), "test.world:2: a road requires its network: rndf \"FILE\"");
  EXPECT_EQ(error_of("road(\nrndf \"nowhere.rndf\" )"),
            "test.world:2: cannot find the road network \"nowhere.rndf\"; searched the folders of this file and of the "
            "world file, $STAGEPATH and the installed worlds");
  const std::string unknown = error_of(road("magnetic_moment 1 magnet_spacing 0.1 magnet_lanes \"6.1 99.1\""));
  EXPECT_EQ(unknown.substr(0, unknown.find(" has")),
            "test.world:2: 'magnet_lanes' is \"6.1 99.1\"; expected \"all\", or lanes that " SF_SOURCE_DIR
            "/worlds/simville/simville.rndf");
  EXPECT_EQ(error_of(road("magnetic_moment 1 magnet_spacing 1e-7")),
            "test.world:2: 'magnet_spacing' gives more than a million magnets; expected a larger one");
}

TEST(Road, NetworkAloneIsNotAWorld) {
  expect_in("is not a world, but a world file can include it",
            sf::refusal_of([] { load_world(SF_SOURCE_DIR "/worlds/simville/simville.rndf"); }));
}

TEST(Road, TwoRoadsHaveDifferentNames) {
  const World world = read_world(road("") + road(""));
  EXPECT_NE(world.models[0].name, world.models[1].name);
}

}  // namespace
}  // namespace sf::world
