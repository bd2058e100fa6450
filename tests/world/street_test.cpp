// Lights, infrared emitters, holes in the floor, and the motion properties of positions.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/read_world.h"
#include "world/lights.h"

namespace sf::world {
namespace {

constexpr const char* kLight = R"(light( name "l1" pose [1 2 0 90] lamps 1 phases 3
  phase[0] ["green" 8] phase[1] ["yellow" 2] phase[2] ["flashing red" 10] offset 4 stop_lines "3.1.11  4.2.5" ))";

TEST(Light, IsReadWithItsPlan) {
  const World world = read_world(kLight);
  EXPECT_EQ(warnings_of(world), "");
  ASSERT_EQ(world.lights.size(), 1u);
  const Light& light = world.lights[0];
  EXPECT_EQ(light.name, "l1");
  EXPECT_EQ(world.models[light.model].name, "l1");
  EXPECT_EQ(light.X_WL.x, 1.0);
  EXPECT_DOUBLE_EQ(light.X_WL.yaw, M_PI / 2);
  EXPECT_TRUE(light.single);
  ASSERT_EQ(light.phases.size(), 3u);
  EXPECT_EQ(light.phases[2].state, LightState::flashing_red);
  EXPECT_EQ(light.phases[2].duration, 10.0);
  EXPECT_EQ(light.points, (std::vector<std::string>{"3.1.11", "4.2.5"}));
  EXPECT_EQ(signal_at(light, 4.0).state, LightState::green) << "the first phase begins at the offset";
  EXPECT_EQ(signal_at(light, 3.9).state, LightState::flashing_red) << "and the plan was there before";
}

TEST(Light, EveryStateHasItsWord) {
  for (const char* word : {"dark", "red", "yellow", "green", "flashing red", "flashing yellow"}) {
    const World world = read_world(std::string("light( phases 1 phase[0] [\"") + word + "\" 1] )");
    EXPECT_EQ(light_state_name(world.lights.at(0).phases.at(0).state), word);
  }
}

TEST(Light, IsAPoleWithAHead) {
  const World world = read_world(R"(light( phases 1 phase[0] ["red" 1] ))");
  ASSERT_EQ(world.walls.size(), 8u);
  EXPECT_EQ(world.walls[0].z_min, 0.0);
  EXPECT_EQ(world.walls[0].z_max, world.walls[4].z_min) << "the head is on the pole";
  EXPECT_DOUBLE_EQ(world.walls[4].z_min, 0.36);
  EXPECT_DOUBLE_EQ(read_world(kLight).walls[4].z_min, 0.48) << "one lamp is a smaller head";
  EXPECT_EQ(world.walls[4].z_max, 0.6);
  EXPECT_LT(length(world.walls[0].b - world.walls[0].a), length(world.walls[4].b - world.walls[4].a));
  EXPECT_TRUE(world.walls[0].solid_left);
  EXPECT_TRUE(world.walls[0].stops_robots);
}

TEST(Light, MayHaveItsOwnBodyOrNone) {
  EXPECT_EQ(read_world(R"(light( phases 1 phase[0] ["red" 1] noblocks 1 ))").walls.size(), 0u);
  EXPECT_EQ(read_world(R"(light( phases 1 phase[0] ["red" 1]
    block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] ) ))")
                .walls.size(),
            3u);
}

TEST(Light, IsPlacedFromAMacroInAModel) {
  const World world = read_world(R"(define signal light( phases 1 phase[0] ["red" 1] )
    model( name "post" pose [1 2 0 90] size [1 1 1] signal( name "s" pose [1 0 0 90] ) ))");
  ASSERT_EQ(world.lights.size(), 1u);
  EXPECT_EQ(world.lights[0].name, "post.s");
  EXPECT_NEAR(world.lights[0].X_WL.x, 1.0, 1e-12);
  EXPECT_NEAR(world.lights[0].X_WL.y, 3.0, 1e-12);
  EXPECT_NEAR(world.lights[0].X_WL.yaw, M_PI, 1e-12);
}

TEST(Light, StopLinesMustExistInWorldsWithRoads) {
  const std::string road = "road( rndf \"simville/simville.rndf\" )\n";
  const auto light = [](const std::string& points) {
    return "light( name \"l\" phases 1 phase[0] [\"red\" 1]\nstop_lines \"" + points + "\" )\n";
  };
  EXPECT_EQ(warnings_of(read_world(light("3.1.11 4.2.5") + road)), "") << "whatever comes first in the file";
  EXPECT_NE(error_of(road + light("3.1.12")).find("test.world:3: 'l' governs way-point 3.1.12, which no lane has"),
            std::string::npos);
  EXPECT_EQ(warnings_of(read_world(road + light("3.1.10"))),
            "3: 'l' governs way-point 3.1.10, which has no stop line\n");
  EXPECT_EQ(warnings_of(read_world(light("99.1.1"))), "") << "a world without roads cannot tell";
}

TEST(Light, UncountedPhasesAreReported) {
  EXPECT_EQ(warnings_of(read_world("light( phases 1 phase[0] [\"red\" 1]\nphase[1] [\"green\" 1] )")),
            "2: 'phase[1]' is not used: 'phases' is 1\n");
}

TEST(Emitter, HasTheCreatesDefaults) {
  const World world = read_world(R"(model( name "w" pose [1 2 0 90] size [0.1 0.1 0.2] ir_emitter "virtual_wall" )
    model( name "d" ir_emitter "dock" ))");
  EXPECT_EQ(warnings_of(world), "");
  ASSERT_EQ(world.emitters.size(), 2u);
  const Emitter& wall = world.emitters[0];
  EXPECT_EQ(wall.kind, Emitter::Kind::virtual_wall);
  EXPECT_EQ(world.models[wall.model].name, "w");
  EXPECT_EQ(wall.range, 2.4);
  EXPECT_EQ(wall.fov, 0.4);
  EXPECT_EQ(wall.halo, 0.45);
  EXPECT_EQ(wall.X_WE.z, 0.1) << "half way up its model";
  EXPECT_DOUBLE_EQ(wall.X_WE.yaw, M_PI / 2);
  EXPECT_EQ(world.emitters[1].kind, Emitter::Kind::dock);
  EXPECT_EQ(world.emitters[1].range, 1.8);
  EXPECT_EQ(world.emitters[1].halo, 0.6);
  EXPECT_EQ(world.walls.size(), 8u) << "an emitter has a body as any model";
}

TEST(Lamp, IsInTheMiddleOfItsModel) {
  const World world = read_world(R"(ambient_light 15
    model( name "l" pose [1 2 2 90] size [0.2 0.2 0.4] lamp_intensity 80 lamp_fov 60 ) model( lamp_intensity 5 ))");
  EXPECT_EQ(warnings_of(world), "");
  EXPECT_EQ(world.ambient_light, 15.0);
  ASSERT_EQ(world.lamps.size(), 2u);
  const Lamp& lamp = world.lamps[0];
  EXPECT_EQ(world.models[lamp.model].name, "l");
  EXPECT_EQ(lamp.X_WL.x, 1.0);
  EXPECT_DOUBLE_EQ(lamp.X_WL.z, 2.2);
  EXPECT_DOUBLE_EQ(lamp.X_WL.yaw, M_PI / 2);
  EXPECT_EQ(lamp.intensity, 80.0);
  EXPECT_DOUBLE_EQ(lamp.fov, M_PI / 3);
  EXPECT_EQ(world.lamps[1].fov, 2.0 * M_PI) << "all round";
  EXPECT_EQ(world.walls.size(), 8u) << "a lamp has a body as any model";
}

TEST(Lamp, InvalidOnesAreRejected) {
  EXPECT_NE(error_of("position(\n lamp_intensity 5 )").find("test.world:2: a lamp cannot move"), std::string::npos);
  EXPECT_NE(error_of("model(\n lamp_intensity 0 )").find("test.world:2: 'lamp_intensity' is 0"), std::string::npos);
  EXPECT_NE(error_of("model(\n lamp_intensity \"on\" )").find("test.world:2: "), std::string::npos);
  EXPECT_NE(warnings_of(read_world("model( lamp_fov 60 )")).find("no effect without 'lamp_intensity'"),
            std::string::npos);
  EXPECT_NE(warnings_of(read_world("model( lamp_intensity 1 lamp_fov 1.5708 )")).find("write 90 if"),
            std::string::npos);
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "model( lamp_intensity 1 )\n";
  EXPECT_EQ(read_world(many).lamps.size(), 1000u);
  EXPECT_NE(error_of(many + "model( lamp_intensity 1 )").find("test.world:1001: more than 1000 lamps"),
            std::string::npos);
}

TEST(Emitter, OverridesDefaults) {
  const World world = read_world(R"(model( ir_emitter "dock" ir_range 1 ir_fov 360 ir_halo 0 ))");
  EXPECT_EQ(world.emitters.at(0).range, 1.0);
  EXPECT_EQ(world.emitters.at(0).fov, 2.0 * M_PI);
  EXPECT_EQ(world.emitters.at(0).halo, 0.0);
}

TEST(FloorHole, IsAHoleInsteadOfAWall) {
  const World world = read_world("model( name \"stairs\" pose [1 2 0 90] size [2 1 1] cliff_return 1 )");
  EXPECT_TRUE(world.walls.empty());
  ASSERT_EQ(world.floor_holes.size(), 1u);
  EXPECT_EQ(world.models[world.floor_holes[0].model].name, "stairs");
  const auto& outline = world.floor_holes[0].outline;
  ASSERT_EQ(outline.size(), 4u);
  EXPECT_NEAR(outline[0].x, 1.5, 1e-12);
  EXPECT_NEAR(outline[0].y, 1.0, 1e-12);
  EXPECT_NEAR(world.extent.y_max, 3.0, 1e-12);
}

TEST(FloorHole, EveryBlockIsAHole) {
  const World world = read_world(R"(model( size [3 1 1] cliff_return 1
    block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] )
    block( points 4 point[0] [2 0] point[1] [3 0] point[2] [3 1] point[3] [2 1] ) ))");
  ASSERT_EQ(world.floor_holes.size(), 2u);
  EXPECT_EQ(world.floor_holes[0].outline.size(), 3u);
  EXPECT_EQ(world.floor_holes[1].outline.size(), 4u);
}

TEST(FloorHole, IsAWallIfThePropertyIsZero) { EXPECT_EQ(read_world("model( cliff_return 0 )").walls.size(), 4u); }

TEST(Position, ReadsMotionProperties) {
  const World world = read_world(R"(position( drive "skid" track 0.4 acceleration_bounds [-1 2 0 0 0 0 -90 180]
    command_law "player_create" ) position( pose [1 0 0 0] ) position( pose [2 0 0 0] acceleration_bounds [-1 2] ))");
  EXPECT_EQ(warnings_of(world), "");
  const Mover& skid = world.movers.at(0);
  EXPECT_EQ(skid.drive, Drive::skid);
  EXPECT_EQ(skid.track, 0.4);
  EXPECT_EQ(skid.max_acceleration, 2.0);
  EXPECT_DOUBLE_EQ(skid.max_turn_acceleration, M_PI);
  EXPECT_EQ(skid.actuator_model, ActuatorModel::player_create);
  EXPECT_EQ(world.movers.at(1).max_acceleration, HUGE_VAL) << "nothing said: no limit";
  EXPECT_EQ(world.movers.at(1).actuator_model, ActuatorModel::direct);
  EXPECT_EQ(world.movers.at(2).max_acceleration, 2.0);
  EXPECT_EQ(world.movers.at(2).max_turn_acceleration, HUGE_VAL);
}

TEST(Position, MotionPropertiesUseTheFilesUnits) {
  const World world = read_world(
      "unit_length \"cm\" unit_angle \"radians\" position( track 40 acceleration_bounds [0 200 0 0 0 0 0 3] )");
  EXPECT_DOUBLE_EQ(world.movers.at(0).track, 0.4);
  EXPECT_DOUBLE_EQ(world.movers.at(0).max_acceleration, 2.0);
  EXPECT_EQ(world.movers.at(0).max_turn_acceleration, 3.0);
}

TEST(Clone, LightsEmittersAndHolesKeepTheirModels) {
  World world = read_world(R"(position( name "r" size [0.2 0.2 0.2] pose [2 2 0 0] model( size [0.1 0.1 0.1] ) )
    model( size [6 6 1] boundary 1 )
    light( name "l" phases 1 phase[0] ["red" 1] )
    model( name "d" pose [1 0 0 0] ir_emitter "dock" ) model( name "h" pose [-1 0 0 0] cliff_return 1 ))");
  clone_robots(world, 5, 1);
  EXPECT_EQ(world.models.at(world.lights.at(0).model).name, "l");
  EXPECT_EQ(world.models.at(world.emitters.at(0).model).name, "d");
  EXPECT_EQ(world.models.at(world.floor_holes.at(0).model).name, "h");
  EXPECT_NO_THROW(from_snapshot(snapshot(world)));
}

}  // namespace
}  // namespace sf::world
