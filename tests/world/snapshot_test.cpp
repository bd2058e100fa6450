#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/random.h"
#include "tests/world/read_world.h"

namespace sf::world {
namespace {

World rooms() { return load_world(SF_SOURCE_DIR "/worlds/rooms.world", kWithLasers); }

/// Adds one row to each table that is empty in rooms.world.
void add_street(World& world) {
  world.paths.push_back({"lane", {{{1.0, 2.0, 0.0, 0.5}, 2.72, 0.0, 0.5}, {{3.0, 2.0, 0.0, 0.5}, 1.46, 1.07, 0.6}}});
  world.lights.push_back({"light",
                          1,
                          {4.0, 2.0, 0.0, 1.0},
                          true,
                          {{LightState::green, 8.0}, {LightState::flashing_yellow, 2.5}},
                          -3.0,
                          {"3.1.11", "4.2.5"}});
  world.emitters.push_back({Emitter::Kind::dock, 1, {0.5, 0.25, 0.05, 2.0}, 1.8, 0.7, 0.6});
  world.earth_field = {1e-5, -2e-6, -4e-5};
  world.fiducials.push_back({1, {1.0, 2.0, 0.5, 0.3}, 7, 1, Fiducial::Type::threat});
  world.lamps.push_back({1, {1.0, 2.0, 2.5, 0.3}, 80.0, 3.0});
  world.ambient_light = 20.0;
  world.heat_sources.push_back({1, {1.0, 2.0}, -4.0, 0.5});
  world.temperature = 21.0;
  world.floor_holes.push_back({{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, 1});
  world.road_files.push_back("some.rndf");
  Mover& mover = world.movers.at(0);
  mover.drive = Drive::skid;
  mover.actuator_model = ActuatorModel::player_create;
  mover.max_acceleration = 2.0;
  mover.max_turn_acceleration = 5.0;
  mover.track = 0.258;
}

/// Measured quantities are finite, wherever a recording was made. Quantities that may be unbounded stay unbounded.
TEST(Snapshot, NonFiniteNumbersAreRejected) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    World world = rooms();
    world.movers[0].sensors.push_back({.type = "laser", .settings = {{.key = "fov", .numbers = {90.0}}}});
    world.movers[0].body.push_back(world.walls[0]);
    world.magnets.push_back({{1.0, 2.0}, 0.0, 1.0, 0.01, 0});
    world.lane_markings.push_back({{{0.0, 0.0}, {1.0, 0.0}}, 0.1});
    update_extent_and_hash(world);
    EXPECT_NO_THROW(from_snapshot(snapshot(world)));
    for (double* const number :
         {&world.walls[0].a.x, &world.walls[1].z_max, &world.movers[0].X_WM.yaw, &world.movers[0].body[0].b.y,
          &world.movers[0].sensors.back().settings[0].numbers[0], &world.movers[0].sensors.back().X_MS.z,
          &world.magnets.back().moment, &world.lane_markings.back().width, &world.lane_markings.back().line[1].x,
          &world.interval}) {
      const double good = std::exchange(*number, bad);
      update_extent_and_hash(world);
      EXPECT_THROW(from_snapshot(snapshot(world)), base::InputError);
      *number = good;
    }
    world.movers[0].max_acceleration = HUGE_VAL;
    update_extent_and_hash(world);
    EXPECT_NO_THROW(from_snapshot(snapshot(world)));
  }
}

World street() {
  World world = rooms();
  add_street(world);
  update_extent_and_hash(world);
  return world;
}

TEST(Snapshot, RowsThatBreakInvariantsAreRejected) {
  const auto refused = [](auto&& spoil) {
    World world = street();
    spoil(world);
    update_extent_and_hash(world);
    return sf::refusal_of([&] { from_snapshot(snapshot(world)); }).find("corrupt world snapshot") != std::string::npos;
  };
  EXPECT_FALSE(refused([](World&) {}));
  EXPECT_TRUE(refused([](World& w) { w.lights[0].phases.clear(); })) << "a light that shows nothing";
  EXPECT_TRUE(refused([](World& w) { w.lights[0].phases[1].duration = 0.0; }));
  EXPECT_TRUE(refused([](World& w) { w.lights[0].phases[1].duration = HUGE_VAL; })) << "a cycle without an end";
  EXPECT_TRUE(refused([](World& w) { w.lights[0].offset = NAN; }));
  EXPECT_TRUE(refused([](World& w) { w.lights[0].model = 9999; }));
  EXPECT_TRUE(refused([](World& w) { w.emitters[0].model = 9999; }));
  EXPECT_TRUE(refused([](World& w) { w.emitters[0].range = 0.0; }));
  EXPECT_TRUE(refused([](World& w) { w.floor_holes[0].model = 9999; }));
  EXPECT_TRUE(refused([](World& w) { w.floor_holes[0].outline.pop_back(); }));
  EXPECT_TRUE(refused([](World& w) { w.paths[0].pieces.clear(); }));
  EXPECT_TRUE(refused([](World& w) { w.paths[0].pieces[0].length = 0.0; }));
  EXPECT_TRUE(refused([](World& w) { w.movers[0].track = 0.0; }));
  EXPECT_TRUE(refused([](World& w) { w.interval = 0.0; })) << "a run of no time";
  EXPECT_TRUE(refused([](World& w) { w.movers[0].drive = static_cast<Drive>(4); })) << "no such drive";
  EXPECT_TRUE(refused([](World& w) { w.lights[0].phases[0].state = static_cast<LightState>(6); }));
}

/// Sets each link of each table one row past the end of its target, and far past it; and kNone if the row is required.
TEST(Snapshot, LinksPastTheEndAreRejected) {
  World world = street();
  world.magnets.push_back({{1.0, 2.0}, -0.04, 0.5, 0.01, 1});
  world.movers[0].magnets.push_back({{0.1, 0.0}, 0.2, -1.0, 0.02, 0});
  world.movers[0].body.push_back(world.walls[0]);
  const auto models = static_cast<std::uint32_t>(world.models.size());
  const auto movers = static_cast<std::uint32_t>(world.movers.size());
  const auto refused = [&](std::uint32_t& link, std::uint32_t row) {
    const std::uint32_t good = std::exchange(link, row);
    update_extent_and_hash(world);
    const std::string what = sf::refusal_of([&] { from_snapshot(snapshot(world)); });
    link = good;
    return what.find("refers to a row that does not exist") != std::string::npos;
  };
  struct Link {
    std::uint32_t* row;
    std::uint32_t count;
    bool optional;
  };
  Mover& mover = world.movers[0];
  for (const Link& link :
       {Link{&world.walls[0].model, models, false}, Link{&world.magnets[0].model, models, false},
        Link{&world.models[0].parent, models, true}, Link{&world.models[0].mover, movers, true},
        Link{&mover.model, models, false}, Link{&mover.body.back().model, models, false},
        Link{&mover.magnets[0].model, models, false}, Link{&world.lights[0].model, models, false},
        Link{&world.emitters[0].model, models, false}, Link{&world.lamps[0].model, models, false},
        Link{&world.heat_sources[0].model, models, false}, Link{&world.fiducials[0].model, models, false},
        Link{&world.floor_holes[0].model, models, false}}) {
    EXPECT_FALSE(refused(*link.row, link.count - 1)) << "the last row";
    EXPECT_TRUE(refused(*link.row, link.count)) << "one past the end";
    EXPECT_TRUE(refused(*link.row, link.count + 1));
    EXPECT_EQ(refused(*link.row, kNone), !link.optional);
  }
}

TEST(Snapshot, EveryTruncationIsRejected) {
  const auto bytes = snapshot(street());
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_THROW(from_snapshot({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), base::InputError)
        << size;
  }
}

TEST(Snapshot, ChangedBytesAreRejectedOrHarmless) {
  const auto bytes = snapshot(street());
  for (std::uint32_t k = 0; k < 2000; ++k) {
    auto changed = bytes;
    const auto words = base::random_words({1, base::RandomStream::placement, 0, 0, 0}, k);
    changed[words[0] % changed.size()] ^= static_cast<std::uint8_t>(1 + words[1] % 255);
    try {
      const World world = from_snapshot(changed);
      for (const Segment& wall : world.walls) ASSERT_LT(wall.model, world.models.size());
      for (const Light& light : world.lights) ASSERT_FALSE(light.phases.empty());
    } catch (const base::InputError&) {
      continue;
    }
  }
}

/// Worlds without heat sources and temperature have the bytes of version 7, those without fiducials have the bytes of
/// version 6, which ends before them. Those without the Earth's field, lamps and ambient light have the bytes of
/// version 5.
TEST(Snapshot, WorldsWithoutNewFieldsHaveTheVersionBefore) {
  EXPECT_EQ(snapshot(street())[4], 9);
  World world = street();
  world.heat_sources.clear(), world.temperature = 0.0;
  EXPECT_EQ(snapshot(world)[4], 7);
  world.fiducials.clear();
  update_extent_and_hash(world);
  EXPECT_EQ(snapshot(world)[4], 6);
  EXPECT_EQ(from_snapshot(snapshot(world)).hash, world.hash);
  world.earth_field = {};
  world.lamps.clear();
  world.ambient_light = 0.0;
  update_extent_and_hash(world);
  auto bytes = snapshot(world);
  EXPECT_EQ(bytes[4], 5);
  EXPECT_EQ(from_snapshot(bytes).hash, world.hash);
  bytes.pop_back();
  EXPECT_THROW(from_snapshot(bytes), base::InputError);
  World raised = world;
  raised.ramps.push_back({{0, 0}, {1, 0}, 0.0, 0.5, 0.25});
  raised.marking_heights.resize(raised.lane_markings.size(), {0.0, 0.5});
  update_extent_and_hash(raised);
  EXPECT_NE(raised.hash, world.hash);
  EXPECT_EQ(snapshot(raised)[4], 7);
  EXPECT_EQ(from_snapshot(snapshot(raised)).ramps.at(0).z_b, 0.5);
  EXPECT_EQ(from_snapshot(snapshot(raised)).hash, raised.hash);
  for (int i = 0; i < 3; ++i) {
    World one = world;
    if (i == 0) one.earth_field.y = 1e-5;
    if (i == 1) one.lamps.push_back({1, {}, 5.0});
    if (i == 2) one.ambient_light = 1.0;
    update_extent_and_hash(one);
    EXPECT_EQ(snapshot(one)[4], 6) << i;
    EXPECT_EQ(from_snapshot(snapshot(one)).hash, one.hash) << i;
  }
}

TEST(Snapshot, OtherVersionIsNamed) {
  auto bytes = snapshot(rooms());
  bytes[4] = 99;
  expect_in("version 99", sf::refusal_of([&] { from_snapshot(bytes); }));
}

TEST(Hash, DependsOnWhateverReadingsDependOn) {
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

/// The reflectances of the ground are part of the hash and of snapshots, whose version they raise.
TEST(Hash, DependsOnTheReflectanceOfTheGround) {
  const auto hash = read_world("model( )").hash;
  for (const char* key : {"floor_reflectance 0.2 ", "paint_reflectance 0.2 "}) {
    const World world = read_world(std::string(key) + "model( )");
    EXPECT_NE(world.hash, hash) << key;
    EXPECT_EQ(snapshot(world)[4], 16);
    EXPECT_EQ(from_snapshot(snapshot(world)).hash, world.hash) << key;
  }
  for (const char* key : {"floor_reflectance -0.1 ", "paint_reflectance 101 ", "paint_reflectance nan "})
    EXPECT_THROW(read_world(std::string(key) + "model( )"), base::InputError) << key;
}

/// Each changes the hash, and its absence leaves the hash of older versions.
TEST(Hash, DependsOnTheEarthsFieldAndLight) {
  const std::string text = "model( name \"m\" size [1 1 1] ) position( laser() )";
  const auto hash = read_world(text).hash;
  for (const char* key : {"earth_field [0 0 1e-9] ", "earth_location [0 0] ", "ambient_light 1 ", "temperature 1 "})
    EXPECT_NE(read_world(key + text).hash, hash) << key;
  for (const char* key : {"earth_field [0 0 0] ", "earth_field [-0 0 0] ", "ambient_light 0 ", "temperature 0 "})
    EXPECT_EQ(read_world(key + text).hash, hash) << key;
  EXPECT_NE(read_world("model( lamp_intensity 1 )").hash, read_world("model( lamp_intensity 2 )").hash);
  EXPECT_NE(read_world("model( lamp_intensity 1 )").hash, read_world("model( )").hash);
  EXPECT_NE(read_world("model( fiducial_return 1 )").hash, read_world("model( fiducial_return 2 )").hash);
  EXPECT_NE(read_world("model( fiducial_return 1 )").hash,
            read_world("model( fiducial_return 1 fiducial_type \"threat\" )").hash);
  EXPECT_EQ(read_world("model( fiducial_return 0 )").hash, read_world("model( )").hash);
}

TEST(Hash, DependsOnLightsEmittersHolesAndKinematics) {
  const std::string rest = "model( name \"m\" )";
  const auto hash = [&](const std::string& text) { return read_world(text + rest).hash; };
  EXPECT_NE(hash("light( name \"l\" phases 1 phase[0] [\"red\" 1] )"),
            hash("light( name \"l\" phases 1 phase[0] [\"green\" 1] )"));
  EXPECT_NE(hash("model( ir_emitter \"dock\" )"), hash("model( ir_emitter \"virtual_wall\" )"));
  EXPECT_NE(hash("model( ir_emitter \"dock\" )"), hash("model( ir_emitter \"dock\" ir_halo 0.2 )"));
  EXPECT_NE(hash("model( cliff_return 1 size [1 1 1] )"), hash("model( cliff_return 1 size [1 2 1] )"));
  EXPECT_NE(hash("position( )"), hash("position( track 0.2 )"));
  EXPECT_NE(hash("position( )"), hash("position( command_law \"player_create\" )"));
  EXPECT_NE(hash("position( )"), hash("position( acceleration_bounds [-1 1] )"));
}

TEST(Translate, MovesEverythingWithAPosition) {
  const World before = street();
  World after = before;
  translate(after, 100'000.0, -50'000.0);
  EXPECT_EQ(after.walls[3].a.x, before.walls[3].a.x + 100'000.0);
  EXPECT_EQ(after.movers[1].X_WM.y, before.movers[1].X_WM.y - 50'000.0);
  EXPECT_EQ(after.models[2].X_WM.x, before.models[2].X_WM.x + 100'000.0);
  EXPECT_EQ(after.movers[1].body[0].a.x, before.movers[1].body[0].a.x);  // bodies are in the mover's frame
  EXPECT_EQ(after.paths[0].pieces[1].X_WP.x, before.paths[0].pieces[1].X_WP.x + 100'000.0);
  EXPECT_EQ(after.lights[0].X_WL.y, before.lights[0].X_WL.y - 50'000.0);
  EXPECT_EQ(after.emitters[0].X_WE.x, before.emitters[0].X_WE.x + 100'000.0);
  EXPECT_EQ(after.floor_holes[0].outline[1].y, before.floor_holes[0].outline[1].y - 50'000.0);
  EXPECT_EQ(after.extent.x_max, before.extent.x_max + 100'000.0);
  EXPECT_NE(after.hash, before.hash);
}

}  // namespace
}  // namespace sf::world
