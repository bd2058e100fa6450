#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "tests/world/read_world.h"

namespace sf::world {
namespace {

World rooms() { return load_world(SF_SOURCE_DIR "/worlds/rooms.world"); }

TEST(Snapshot, ARoundTripKeepsEverything) {
  World world = rooms();
  world.warnings.push_back({"some.world", 3, "text"});
  world.kept["camera"] = 2;
  world.magnets.push_back({{1.0, 2.0}, -0.04, 0.5, 0.01, 1});
  world.stripes.push_back({{{0.0, 0.0}, {1.0, 0.5}, {2.0, 0.5}}, 0.02, 0xFFFFCC00u});
  world.road_resolution = 0.005;
  world.magnet_cutoff = 3.0;
  world.movers.at(0).magnets.push_back({{0.1, 0.0}, 0.2, -1.0, 0.02, 0});
  world.movers.at(0).sensors.push_back(
      {"magnetometer",
       "m",
       {0.2, 0.0, 0.1, 0.0},
       0.05,
       0.01,
       1.0,
       {{"scount", {5.0}, "", 7, "some.world"}, {"sum", {}, "vector", 8, "some.world"}},
       6,
       "some.world"});
  finish(world);
  const auto bytes = snapshot(world);
  const World again = from_snapshot(bytes);
  EXPECT_EQ(again.hash, world.hash);
  EXPECT_EQ(snapshot(again), bytes);  // so also names, colours, warnings and counts
  EXPECT_EQ(again.extent.x_max, world.extent.x_max);
  EXPECT_EQ(again.movers.at(0).sensors.at(0).settings.at(1).text, "vector");
  EXPECT_EQ(again.stripes.at(0).line.at(1).y, 0.5);
  EXPECT_EQ(again.movers.at(1).lasers.at(0).color, world.movers.at(1).lasers.at(0).color);
}

TEST(Snapshot, EveryCutIsRefused) {
  const auto bytes = snapshot(rooms());
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_THROW(from_snapshot({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), base::InputError)
        << size;
  }
}

TEST(Snapshot, ChangedBytesAreRefusedOrHarmless) {
  const auto bytes = snapshot(rooms());
  for (std::uint32_t k = 0; k < 2000; ++k) {
    auto changed = bytes;
    const auto words = base::random_words({1, base::Stream::place, 0, 0, 0}, k);
    changed[words[0] % changed.size()] ^= static_cast<std::uint8_t>(1 + words[1] % 255);
    try {
      const World world = from_snapshot(changed);
      for (const Segment& wall : world.walls) ASSERT_LT(wall.model, world.models.size());
    } catch (const base::InputError&) {
      continue;
    }
  }
}

TEST(Snapshot, AnotherVersionIsNamed) {
  auto bytes = snapshot(rooms());
  bytes[4] = 99;
  try {
    from_snapshot(bytes);
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("version 99"), std::string::npos);
  }
}

TEST(Hash, DependsOnWhatAReadingDependsOn) {
  const std::string text = "model( name \"m\" size [1 1 1] ) position( laser() )";
  const auto hash = read_world(text).hash;
  EXPECT_EQ(read_world("# words only\n" + text).hash, hash);
  EXPECT_EQ(read_world("model( name \"m\" size [1 1 1] color \"blue\" ) position( laser( laser_color \"red\" ) )").hash,
            hash);
  EXPECT_NE(read_world("model( name \"m\" size [1 1 2] ) position( laser() )").hash, hash);
  EXPECT_NE(read_world("model( name \"m\" size [1 1 1] ) position( laser( samples 181 ) )").hash, hash);
  EXPECT_NE(read_world("model( name \"m\" size [1 1 1] laser_return 0 ) position( laser() )").hash, hash);
  EXPECT_NE(read_world("model( name \"m\" size [1 1 1] ) position( pose [0 0 0 1] laser() )").hash, hash);
}

TEST(Translate, MovesEverythingThatHasAPlace) {
  const World before = rooms();
  World after = before;
  translate(after, 100'000.0, -50'000.0);
  EXPECT_EQ(after.walls[3].a.x, before.walls[3].a.x + 100'000.0);
  EXPECT_EQ(after.movers[1].X_WM.y, before.movers[1].X_WM.y - 50'000.0);
  EXPECT_EQ(after.models[2].X_WM.x, before.models[2].X_WM.x + 100'000.0);
  EXPECT_EQ(after.movers[1].body[0].a.x, before.movers[1].body[0].a.x);  // bodies have frames of their own
  EXPECT_EQ(after.extent.x_max, before.extent.x_max + 100'000.0);
  EXPECT_NE(after.hash, before.hash);
}

}  // namespace
}  // namespace sf::world
