#include "world/stage/build_world.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/refusal.h"
#include "tests/units.h"
#include "tests/world/read_world.h"

namespace sf::world {
namespace {

const Mover& only_mover(const World& world) {
  EXPECT_EQ(world.movers.size(), 1u);
  return world.movers.at(0);
}

// --- Grammar ---

TEST(Stage, BracketsNeedNoBlanksAndAllLineEndsCount) {
  const World world = read_world("define box model(size[1 2 3])\r\nbox(pose[1 2 0 0])\rbox(\n)# end");
  ASSERT_EQ(world.models.size(), 2u);
  EXPECT_EQ(world.models[0].size.y, 2.0);
  EXPECT_EQ(world.models[0].type, "box");
}

TEST(Stage, MacroIsCopiedAndOverridden) {
  const World world = read_world(
      "define a model( size [1 1 1] color \"red\" model() )\ndefine b a( color \"blue\" )\nb( size [2 2 2] model() )");
  ASSERT_EQ(world.models.size(), 3u);
  EXPECT_EQ(world.models[0].size.x, 2.0);
  EXPECT_EQ(world.models[0].color, 0xFF0000FFu);
}

TEST(Stage, FirstDefineCountsAndTheSecondIsReported) {
  const World world = read_world("define a model( size [1 1 1] )\ndefine a model( size [2 2 2] )\na()");
  EXPECT_EQ(world.models[0].size.x, 1.0);
  EXPECT_NE(warnings_of(world).find("2: 'a' is defined again"), std::string::npos);
}

TEST(Stage, LastOfTwoEqualPropertiesCounts) {
  const World world = read_world("model( size [1 1 1]\n size [2 2 2] )");
  EXPECT_EQ(world.models[0].size.x, 2.0);
  EXPECT_EQ(warnings_of(world),
            "2: 'size' is given twice in the same 'model': the last one is used, not that of line 1\n");
}

/// From a published benchmark world that has its fifth corner twice.
TEST(Stage, LastOfTwoEqualIndicesCounts) {
  const World world = read_world(
      "model( size [1 1 1] block( points 3 z [0 1]\n point[0] [0 0]\n point[1] [1 0]\n point[2] [9 9]\n"
      " point[2] [0 1] ) )");
  EXPECT_EQ(world.hash, read_world("model( size [1 1 1] block( points 3 z [0 1] point[0] [0 0] point[1] [1 0] point[2] "
                                   "[0 1] ) )")
                            .hash);
  EXPECT_EQ(warnings_of(world),
            "5: 'point[2]' is given twice in the same 'block': the last one is used, not that of line 4\n");
}

/// Repeated numbers stand for the numbers that are missing, for all keys that have a count.
TEST(Stage, RepeatedIndicesTakeTheMissingNumbers) {
  const struct {
    const char* name;
    std::string start;
    std::vector<std::string> lines;  ///< one per line, from line 2
    std::vector<std::string> meant;  ///< the same, numbered
  } rows[] = {
      {"all alike",
       "model( block( points 3",
       {"point[0] [0 0]", "point[0] [1 0]", "point[0] [0 1]"},
       {"point[0] [0 0]", "point[1] [1 0]", "point[2] [0 1]"}},
      {"one of three",
       "model( block( points 3",
       {"point[0] [0 0]", "point[1] [1 0]", "point[1] [0 1]"},
       {"point[0] [0 0]", "point[1] [1 0]", "point[2] [0 1]"}},
      {"before other numbers",
       "model( block( points 3",
       {"point[1] [1 0]", "point[1] [0 0]", "point[2] [0 1]"},
       {"point[1] [1 0]", "point[0] [0 0]", "point[2] [0 1]"}},
      {"an older form",
       "model( blocks 1 block[0].points 3 block[0].z [0 1]",
       {"block[0].point[0] [0 0]", "block[0].point[0] [1 0]", "block[0].point[0] [0 1]"},
       {"block[0].point[0] [0 0]", "block[0].point[1] [1 0]", "block[0].point[2] [0 1]"}},
      {"phases",
       "light( phases 2",
       {"phase[0] [\"green\" 8]", "phase[0] [\"red\" 4]"},
       {"phase[0] [\"green\" 8]", "phase[1] [\"red\" 4]"}},
      {"two keys of one count",
       "path( pieces 3 left \"solid_white\" magnetic_moment 1 magnet_spacing 0.5",
       {"straight[0] [2 0.5]", "arc[1] [1 90 0.5]", "straight[0] [1 0.5]"},
       {"straight[0] [2 0.5]", "arc[1] [1 90 0.5]", "straight[2] [1 0.5]"}},
      {"fewer than missing",
       "model( block( points 4",
       {"point[0] [0 0]", "point[0] [1 0]", "point[3] [0 1]"},
       {"point[0] [0 0]", "point[1] [1 0]", "point[3] [0 1]"}},
  };
  for (const auto& [name, start, lines, meant] : rows) {
    SCOPED_TRACE(name);
    const std::string end(static_cast<std::size_t>(std::count(start.begin(), start.end(), '(')), ')');
    std::string written = start, numbered = start;
    for (const std::string& line : lines) written += "\n" + line;
    for (const std::string& line : meant) numbered += "\n" + line;
    const World world = read_world(written + end);
    EXPECT_EQ(world.hash, read_world(numbered + end).hash);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string key = lines[i].substr(0, lines[i].find(' ')), other = meant[i].substr(0, meant[i].find(' '));
      const std::string expected = std::to_string(i + 2) + ": '" + key + "' is given again";
      EXPECT_EQ(warnings_of(world).find(expected) != std::string::npos, key != other) << warnings_of(world);
      if (key == other) continue;
      EXPECT_NE(warnings_of(world).find("read as '" + other + "'"), std::string::npos) << warnings_of(world);
    }
  }
}

/// Without a count, or with too few free numbers, the last one counts.
TEST(Stage, RepeatedIndicesWithoutRoomOverride) {
  for (const char* count : {"", "points 2", "points [3 3]", "points \"three\""}) {
    const std::string error = sf::refusal_of([&] {
      const World world =
          read_world(std::string("model( block( ") + count + "\npoint[0] [0 0]\npoint[0] [2 0]\npoint[0] [3 0] ) )");
      EXPECT_NE(warnings_of(world).find("4: 'point[0]' is given twice"), std::string::npos) << count;
    });
    EXPECT_EQ(error.find("read as"), std::string::npos) << count;
  }
  const World macro = read_world(
      "define b block( points 3 z [0 1] point[0] [0 0] point[1] [1 0] point[2] [0 1] )\n"
      "model( size [1 1 1] b( point[2] [5 5]\npoint[2] [0 2] ) )");
  EXPECT_EQ(warnings_of(macro),
            "3: 'point[2]' is given twice in the same 'b': the last one is used, not that of line 2\n")
      << "a macro's numbers are not free";
}

// Radians in an angle in degrees, millimetres in a range in metres.
TEST(Stage, WarnsAboutProbableUnitMistakes) {
  const auto said = [](const std::string& keys, const std::string& root = "") {
    return warnings_of(read_world(root + "position( laser( " + keys + " ) )"));
  };
  EXPECT_EQ(said("fov 3.14"), "1: 'fov' is in degrees, and 3.14 looks like radians: write 180 if it is\n");
  EXPECT_EQ(said("range_max 8000"),
            "1: 'range_max' is in metres, and 8000 m looks like millimetres: write 8 if it is\n");
  for (const char* fov : {"1.57", "4.71", "6.283", "2.094", "4.18879", "4.18"})
    EXPECT_NE(said(std::string("fov ") + fov), "") << fov;
  for (const auto& [fov, degrees] : {std::pair{"0.44", "25"},
                                     {"0.4363", "25"},    // rounded
                                     {"0.43", "25"},      // truncated
                                     {"3.84", "220"},     // a step of 20 degrees
                                     {"4.363", "250"},    // same, with more digits
                                     {"0.96", "55"},      // with two decimals only rounder angles count
                                     {"0.9599", "55"},    // more digits
                                     {"1.0123", "58"},    // of a camera
                                     {"6.2832", "360"}})  // full turn
    if (std::string(fov) == "0.96")
      EXPECT_EQ(said(std::string("fov ") + fov), "");
    else
      EXPECT_NE(said(std::string("fov ") + fov).find(fmt::format("write {} if", degrees)), std::string::npos) << fov;
  for (const char* fov :
       {"3", "3.2", "0.25", "1.66", "180", "360", "6.5", "0.35", "1.75", "3.75", "5.73", "2.5", "4.2"})
    EXPECT_EQ(said(std::string("fov ") + fov), "") << fov << " may be degrees";
  EXPECT_EQ(said("range_max 999"), "");
  EXPECT_NE(said("range_max 1000"), "");
  EXPECT_EQ(said("fov 3.14", "unit_angle \"radians\" "), "");
  EXPECT_EQ(said("fov 6.2832", "unit_angle \"radians\" "), "");
  EXPECT_EQ(said("fov 220", "unit_angle \"radians\" "),
            "1: 'fov' is in radians (unit_angle), and 220 looks like degrees: write 3.84 if it is\n");
  EXPECT_EQ(said("range_max 8000", "unit_length \"mm\" "), "");
  const auto ranger = [](const std::string& keys) {
    return warnings_of(read_world("position( ranger( sensor( " + keys + " ) ) )"));
  };
  EXPECT_NE(ranger("range [0 5000]"), "");
  EXPECT_NE(ranger("view [0 5 3.14]"), "");
  EXPECT_EQ(ranger("range [0 5] fov 20"), "");
}

// Short-range sensors: millimetres are likely long before a kilometre.
TEST(Stage, WarnsAboutProbableUnitMistakesOfConesAndEmitters) {
  static constexpr std::string_view kKeys[] = {"fov", "range", "sview"};
  static constexpr SensorKeyword kCones[] = {{"sonar", kKeys}, {"infrared", kKeys}};
  const auto said = [](const std::string& sensor) {
    return warnings_of(read_world("position( " + sensor + " )", LoadOptions{.sensors = kCones}));
  };
  EXPECT_EQ(said("infrared( range [0 800] )"),
            "1: 'range' is in metres, and 800 m looks like millimetres: write 0.8 if it is\n");
  EXPECT_NE(said("infrared( range [20 100] )"), "");
  EXPECT_EQ(said("infrared( range [0 60] )"), "") << "the farthest that are sold";
  EXPECT_NE(said("sonar( range [0 400] )"), "");
  EXPECT_NE(said("sonar( sview [0 6450 15] )"), "");
  EXPECT_EQ(said("sonar( range [0 150] )"), "") << "under water";
  EXPECT_NE(said("sonar( fov 0.44 )").find("write 25 if"), std::string::npos);
  const auto emitter = [](const std::string& keys) {
    return warnings_of(read_world("model( ir_emitter \"dock\" " + keys + " )"));
  };
  EXPECT_EQ(emitter("ir_range 1.8 ir_fov 40"), "");
  EXPECT_NE(emitter("ir_range 1800").find("write 1.8 if"), std::string::npos);
  EXPECT_NE(emitter("ir_fov 0.698").find("write 40 if"), std::string::npos);
}

TEST(Stage, WarnsAboutUnitsOncePerLine) {
  EXPECT_EQ(read_world("define r position( laser( fov 3.14 ) )\nr()\nr( pose [3 0 0 0] )\n").warnings.size(), 1u);
}

TEST(Stage, WarningsOfRepeatedKeysAreLimited) {
  std::string text = "model(";
  for (int i = 0; i < 20'000; ++i) text += " mass 1\n";
  EXPECT_EQ(read_world(text + ")").warnings.size(), 10'001u);
}

TEST(Stage, ExponentsAreNumbersToo) { EXPECT_EQ(read_world("model( size [1e-1 +2 .5] )").models[0].size.x, 0.1); }

// --- Units ---

TEST(Stage, CentimetresAndRadians) {
  const World world =
      read_world("unit_length \"cm\" unit_angle \"radians\" model( pose [100 50 0 1.5] size [10 20 30] )");
  EXPECT_DOUBLE_EQ(world.models[0].X_WM.x, 1.0);
  EXPECT_DOUBLE_EQ(world.models[0].X_WM.yaw, 1.5);
  EXPECT_DOUBLE_EQ(world.walls[0].z_max, 0.3);
}

TEST(Stage, UnitsApplyToTheWholeFileFromAnyPosition) {
  EXPECT_DOUBLE_EQ(read_world("model( size [10 20 30] ) unit_length \"mm\"").models[0].size.x, 0.01);
}

// --- Bodies ---

TEST(Stage, ModelWithoutBlocksIsABoxOfItsSize) {
  const World world = read_world("model( size [2 1 0.5] pose [10 0 0 90] )");
  ASSERT_EQ(world.walls.size(), 4u);
  EXPECT_NEAR(world.extent.x_min, 9.5, 1e-12);
  EXPECT_NEAR(world.extent.y_max, 1.0, 1e-12);
  EXPECT_EQ(world.walls[0].z_max, 0.5);
  EXPECT_TRUE(world.walls[0].solid_left);
}

TEST(Stage, BlocksAreScaledTogetherToTheSize) {
  const World world = read_world(
      "model( size [2 4 1] block( points 4 point[0] [0 0] point[1] [5 0] point[2] [5 5] point[3] [0 5] z [0 10] )"
      " block( points 4 point[0] [5 5] point[1] [10 5] point[2] [10 20] point[3] [5 20] z [5 20] ) )");
  ASSERT_EQ(world.walls.size(), 8u);
  EXPECT_EQ(world.extent.x_min, -1.0);
  EXPECT_EQ(world.extent.x_max, 1.0);
  EXPECT_EQ(world.extent.y_min, -2.0);
  EXPECT_EQ(world.extent.y_max, 2.0);
  EXPECT_DOUBLE_EQ(world.walls[0].z_max, 0.5);
  EXPECT_DOUBLE_EQ(world.walls[4].z_min, 0.25);
  EXPECT_DOUBLE_EQ(world.walls[4].z_max, 1.0);
}

TEST(Stage, BlocksOfTheOldestFormAreTheSame) {
  const std::string points =
      "points 3 block[0].point[0] [0 0] block[0].point[1] [1 0] block[0].point[2] [0 1] block[0].z [0 1]";
  const World old_form = read_world("model( size [1 1 1] blocks 1 block[0]." + points + " )");
  const World new_form =
      read_world("model( size [1 1 1] block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] ) )");
  EXPECT_EQ(old_form.hash, new_form.hash);
  EXPECT_EQ(warnings_of(old_form), "");
}

TEST(Stage, MissingPointIsTheOriginAsInStage) {  // Block::Load of Stage 3 and 4: (0, 0) unless the file has it
  const World world = read_world(
      "model( size [2 1 1]\n block( points 4 point[1] [2 0] point[2] [2 1] z [0 1] ) )");  // point[0], point[3]
  const World whole = read_world(
      "model( size [2 1 1]\n block( points 4 point[0] [0 0] point[1] [2 0] point[2] [2 1] point[3] [0 0] z [0 1] ) )");
  EXPECT_EQ(world.hash, whole.hash);
  EXPECT_EQ(warnings_of(world), "2: 'point[0]' (and 1 more) of this 'block' is missing: [0 0] is used, as in Stage\n");
  EXPECT_EQ(warnings_of(whole), "");
}

TEST(Stage, ThinWallIsOneSegmentWithoutSides) {
  const World world = read_world("model( size [0 2 1] block( points 2 point[0] [3 0] point[1] [3 1] ) )");
  ASSERT_EQ(world.walls.size(), 1u);
  EXPECT_FALSE(world.walls[0].solid_left);
  EXPECT_EQ(world.walls[0].a.x, 0.0);
  EXPECT_EQ(std::abs(world.walls[0].a.y), 1.0);
}

TEST(Stage, BoundaryIsAFrameOfFourWalls) {
  const World world = read_world("model( size [4 2 1] boundary 1 )");
  ASSERT_EQ(world.walls.size(), 8u);
  double area = 0.0;
  for (const Segment& wall : world.walls) area += base::cross(wall.a, wall.b) / 2;
  EXPECT_NEAR(area, 4 * 2 - 3.98 * 1.98, 1e-12);  // the frame is solid, but not its inside
}

TEST(Stage, OriginShiftsTheBodyNotThePose) {
  const World world = read_world("model( size [1 1 1] pose [5 0 0 90] origin [1 0 0.5 0] )");
  EXPECT_EQ(world.models[0].X_WM.x, 5.0);
  EXPECT_NEAR(world.extent.y_max, 1.5, 1e-12);
  EXPECT_EQ(world.walls[0].z_min, 0.5);
}

TEST(Stage, ChildrenAreOnTopOfTheirParentByDefault) {
  const World on = read_world("model( size [1 1 0.4] pose [0 0 0.1 0] model( pose [0 0 0.05 0] ) )");
  EXPECT_DOUBLE_EQ(on.models[1].X_WM.z, 0.55);
  const World in = read_world("model( size [1 1 0.4] pose [0 0 0.1 0] stack_children 0 model( pose [0 0 0.05 0] ) )");
  EXPECT_DOUBLE_EQ(in.models[1].X_WM.z, 0.15000000000000002);
}

TEST(Stage, BitmapWallsStopRobotsExceptUnderStagesRule) {
  const std::string text =
      "model( size [16 16 1] bitmap \"bitmaps/cave.png\" obstacle_return 0 ) model( obstacle_return 0 )";
  const World ours = read_world(text);
  EXPECT_TRUE(ours.walls.front().stops_robots);
  EXPECT_FALSE(ours.walls.back().stops_robots);  // only floor plans become solid
  LoadOptions options;
  options.stage_obstacles = true;
  EXPECT_FALSE(read_world(text, options).walls.front().stops_robots);
  EXPECT_FALSE(read_world("stage_obstacles 1 " + text).walls.front().stops_robots);
  EXPECT_NE(warnings_of(ours).find("1: floor plans stop robots, also with 'obstacle_return 0'"), std::string::npos);
  EXPECT_EQ(warnings_of(read_world("stage_obstacles 0 " + text)), "");
  EXPECT_EQ(warnings_of(read_world(text, options)), "");
}

/// Only the noise of rangers has this form in Stage.
TEST(Stage, NoiseVarianceOfStageIsAWarningUnlessTheFileDecides) {
  const auto world = [](const char* key, const char* noise) {
    return read_world(
        fmt::format("{}\nposition( ranger( sensor( noise [{} 0 0] ) sensor( noise [{} 0 0] ) ) )", key, noise, noise));
  };
  EXPECT_EQ(warnings_of(world("", "0.1")),
            "2: the first number of 'noise' is a standard deviation here, but a variance in Stage: --stage-noise or "
            "the world key stage_noise 1 reads it as a variance, stage_noise 0 confirms a standard deviation\n");
  EXPECT_EQ(warnings_of(world("stage_noise 0", "0.1")), "");
  EXPECT_EQ(warnings_of(world("", "0")), "");
  EXPECT_EQ(world("stage_noise 0", "0.04").movers[0].sensors[0].settings[0].numbers[0], 0.04);
  EXPECT_EQ(world("stage_noise 1", "0.04").movers[0].sensors[0].settings[0].numbers[0], 0.2);
  EXPECT_EQ(warnings_of(read_world("position( laser( noise [0.1 0 0] ) )")), "");
}

TEST(Stage, ReturnsHideFromLasers) {
  EXPECT_FALSE(read_world("model( laser_return 0 )").walls[0].seen_by_laser);
  EXPECT_FALSE(read_world("model( ranger_return -1 )").walls[0].seen_by_laser);
  EXPECT_TRUE(read_world("model( laser_return 2 )").walls[0].seen_by_laser);
  EXPECT_TRUE(read_world("model( ranger_return 0.5 )").walls[0].seen_by_laser);
  EXPECT_TRUE(read_world("model( ranger_return 0 )").walls[0].seen_by_laser) << "dark, but there: only below 0 is none";
  EXPECT_FALSE(read_world("model( laser_return 0 ranger_return 1 )").walls[0].seen_by_laser) << "either hides it";
}

// --- Movers ---

TEST(Stage, PositionMovesAndCarriesItsChildren) {
  const World world = read_world(
      "position( name \"r0\" pose [3 4 0 90] size [0.4 0.4 0.2] model( name \"mast\" size [0.1 0.1 0.5] pose [0.1 0 0 "
      "0] ) )");
  const Mover& robot = only_mover(world);
  EXPECT_TRUE(world.walls.empty());
  ASSERT_EQ(robot.body.size(), 8u);
  EXPECT_EQ(robot.X_WM.x, 3.0);
  EXPECT_DOUBLE_EQ(robot.X_WM.yaw, M_PI / 2);
  EXPECT_DOUBLE_EQ(robot.body[4].z_min, 0.2);  // on top of the robot, for any robot pose
  EXPECT_DOUBLE_EQ(robot.body[4].z_max, 0.7);
  EXPECT_EQ(world.models[1].name, "r0.mast");
  EXPECT_EQ(world.models[1].mover, 0u);
  EXPECT_DOUBLE_EQ(world.models[1].X_WM.y, 4.1);
  EXPECT_DOUBLE_EQ(robot.radius, std::hypot(0.2, 0.2));
}

TEST(Stage, BoundsDriveAndWheelbaseAreRead) {
  const World world = read_world(
      "position( drive \"car\" wheelbase 0.3 velocity_bounds [-1 2 0 0 0 0 -90 45] ) position( drive \"omni\" ) "
      "position()");
  EXPECT_EQ(world.movers[0].drive, Drive::car);
  EXPECT_EQ(world.movers[0].wheelbase, 0.3);
  EXPECT_EQ(world.movers[0].max_forward, 2.0);
  EXPECT_DOUBLE_EQ(world.movers[0].max_turn, 45 * kDegree);
  EXPECT_EQ(world.movers[1].drive, Drive::omni);
  EXPECT_EQ(world.movers[2].drive, Drive::differential);
  EXPECT_EQ(world.movers[2].max_forward, 1.0);  // Stage's default
  EXPECT_DOUBLE_EQ(world.movers[2].max_turn, 90 * kDegree);
}

TEST(Stage, IdsAreTakenFromNamesThenFillGaps) {
  const World world = read_world(
      "position( name \"a\" ) position( name \"roomba1\" ) model( name \"tag1\" ) model( name \"khepera3\" ) "
      "position() position() position()");
  std::vector<std::uint32_t> ids;
  for (const Mover& mover : world.movers) ids.push_back(mover.id);
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{0, 1, 1, 3, 2, 4, 5}));
  EXPECT_TRUE(world.movers[2].is_tag);
  EXPECT_FALSE(world.movers[3].is_tag);
}

TEST(Stage, TagMayBeMountedAnywhereOnItsModel) {
  const World world = read_world(
      "unit_length \"cm\" unit_angle \"radians\"\n"
      "model( name \"tag1\" tag_pose [10 -20 30 1.5] ) model( name \"tag2\" )");
  const Pose& X_MT = world.movers[0].X_MT;
  EXPECT_DOUBLE_EQ(X_MT.x, 0.1);
  EXPECT_DOUBLE_EQ(X_MT.y, -0.2);
  EXPECT_DOUBLE_EQ(X_MT.z, 0.3);
  EXPECT_DOUBLE_EQ(X_MT.yaw, 1.5);
  EXPECT_EQ(world.movers[1].X_MT.x, 0.0);
  EXPECT_EQ(warnings_of(world), "");
}

/// Robots report their own pose, and carried models do not follow packets.
TEST(Stage, TagPoseWithoutATagIsIgnoredWithAWarning) {
  const World world = read_world(
      "position( name \"roomba1\" tag_pose [1 0 0 0]\n model( name \"tag3\" tag_pose [1 0 0 0] ) )\n"
      "model( tag_pose [1 0 0 0] )");
  EXPECT_EQ(only_mover(world).X_MT.x, 0.0);
  for (const char* const line : {"1: 'tag_pose' is ignored: expected it on a free-standing model named tag<N>",
                                 "2: 'tag_pose' is ignored", "3: 'tag_pose' is ignored"})
    EXPECT_NE(warnings_of(world).find(line), std::string::npos) << line;
}

TEST(Stage, TagPoseOfThreeNumbersIsReadLikeAPose) {
  const World world = read_world("model(\n name \"tag1\" tag_pose [1 0 90] )");
  EXPECT_EQ(world.movers[0].X_MT.z, 90.0);
  EXPECT_EQ(world.movers[0].X_MT.yaw, 0.0);
  EXPECT_NE(warnings_of(world).find("2: 'tag_pose' has three numbers, read as [x y z]"), std::string::npos)
      << warnings_of(world);
}

TEST(Stage, WarnsOfNumbersBeyondATuple) {
  const World world = read_world("model( size [1 2 3 4] )\nmodel( size [1 2 3] )");
  EXPECT_NE(warnings_of(world).find("1: 'size' has 4 numbers; only 3 are read: [x y z]"), std::string::npos);
  EXPECT_EQ(warnings_of(world).find("2: 'size'"), std::string::npos) << "as many as are read";
}

TEST(Stage, OtherNamesLinkNothing) {
  const World world = read_world(
      "model( name \"roomba\" ) model( name \"tag\" ) model( name \"tag0\" ) model( name \"roombax1\" )"
      " model( name \"mytag1\" ) model( name \"tag1b\" ) model( name \"tag12345678901\" )");
  EXPECT_TRUE(world.movers.empty());
}

TEST(Stage, RobotOnARobotIsCarried) {
  const World world = read_world("position( name \"r\" position( name \"tag3\" ) )");
  EXPECT_EQ(only_mover(world).body.size(), 8u);
  EXPECT_NE(warnings_of(world).find("'tag3' is mounted on 'r'"), std::string::npos);
}

TEST(Stage, TagOnAShelfMovesByItself) {
  const World world =
      read_world("model( name \"shelf\" pose [1 0 0 90] size [1 1 1] model( name \"tag5\" pose [1 0 0 0] ) )");
  const Mover& tag = only_mover(world);
  EXPECT_EQ(world.walls.size(), 4u);
  EXPECT_DOUBLE_EQ(tag.X_WM.y, 1.0);
  EXPECT_DOUBLE_EQ(tag.X_WM.z, 1.0);
  EXPECT_EQ(tag.name, "shelf.tag5");
}

TEST(Stage, NamesAreUnique) {
  const World world =
      read_world("model( name \"a\" ) model( name \"a\" ) model() model() model( model() model( name \"/b\" ) )");
  std::vector<std::string> names;
  for (const Model& model : world.models) names.push_back(model.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "a#2", "model:0", "model:1", "model:2", "model:2.model:0", "b"}));
  EXPECT_NE(warnings_of(world).find("a second model named 'a'"), std::string::npos);
}

// --- Kept, ignored and suggested entities ---

TEST(Stage, UnmodelledTypesAreKeptCountedAndReportedOnce) {
  const World world = read_world(
      "position( fiducial() camera() )\nposition( pose [1 0 0 0] fiducial( fov 60 ) bumper( size [.1 .1 .1 0] ) )");
  EXPECT_EQ(world.unmodelled, (std::map<std::string, int>{{"bumper", 1}, {"camera", 1}, {"fiducial", 2}}));
  EXPECT_EQ(world.warnings.size(), 4u) << warnings_of(world);  // and a size has four numbers
  EXPECT_EQ(world.movers[0].body.size(), 8u);                  // the camera is a box; a fiducial finder has no body
}

TEST(Stage, UnknownTypeIsKeptWithASuggestion) {
  const World world = read_world("define mybot position()\n\nmybto( size [1 1 1] )");
  EXPECT_EQ(world.unmodelled.at("mybto"), 1);
  EXPECT_EQ(world.walls.size(), 4u);
  EXPECT_NE(
      warnings_of(world).find("3: unknown type 'mybto' is kept as a body that does nothing; did you mean 'mybot'?"),
      std::string::npos)
      << warnings_of(world);
}

TEST(Stage, MisspeltKeyInAMacroGetsOneWarningWithASuggestion) {
  const World world = read_world("define a model(\n sise [1 1 1] )\na() a() a()");
  EXPECT_EQ(warnings_of(world), "2: unknown property 'sise' of 'a' is ignored; did you mean 'size'?\n");
}

TEST(Stage, SuggestsOnlyValidKeys) {
  EXPECT_NE(warnings_of(read_world("unit_lenght \"m\"")).find("did you mean 'unit_length'"), std::string::npos);
  EXPECT_EQ(warnings_of(read_world("model( sampels 3 )")).find("did you mean"), std::string::npos);
}

TEST(Stage, UnmodelledStageKeysAreSilentlyAccepted) {
  const World world = read_world(
      "quit_time 3600 paused 1 speedup 2 threads 4 window( size [1 2] bogus 3 )\n"
      "position( ctrl \"wander\" gui_nose 1 localization \"gps\" localization_origin [0 0 0 0] trail_length 400 joules "
      "10 )");
  EXPECT_EQ(warnings_of(world), "");
}

TEST(Stage, BlocksWithoutASizeGetAdvice) {
  const char* const blocks = "block( points 4 point[0] [0 0] point[1] [12 0] point[2] [12 8] point[3] [0 8] z [0 3] )";
  const World world = read_world(fmt::format("define house model( {} )\nhouse()", blocks));
  EXPECT_EQ(
      warnings_of(world),
      "2: 'house' has blocks of 12 x 8 m but no 'size': they are scaled to 0.1 x 0.1 x 0.1 m; write size [12 8 3] "
      "for the size of the blocks\n");
  EXPECT_NEAR(world.extent.x_max, 0.05, 1e-12) << "it is Stage's rule all the same";
  EXPECT_EQ(warnings_of(read_world(fmt::format("model( size [12 8 3] {} )", blocks))), "");
  const World millimetres = read_world(fmt::format("unit_length \"mm\"\nmodel( {} )", blocks));
  EXPECT_NE(warnings_of(millimetres).find("write size [12 8 3]"), std::string::npos) << "in the file's own unit";
  EXPECT_NE(warnings_of(read_world("model( bitmap \"bitmaps/cave.png\" )")).find("has no 'size': it is 0.1 x 0.1 m"),
            std::string::npos);
  // As large as the resulting size, so no misunderstanding is possible.
  EXPECT_EQ(
      warnings_of(read_world("model( block( points 3 z [0 1] point[0] [0 0] point[1] [0.1 0] point[2] [0 0.1] ) )")),
      "");
}

TEST(Stage, PosesOfThreeNumbersGetAdvice) {
  EXPECT_EQ(
      warnings_of(read_world("model( name \"tag1\"\n pose [1.5 -2 335] )")),
      "2: 'pose' has three numbers, read as [x y z] with yaw 0: z is 335; write [1.5 -2 335 0], or [1.5 -2 0 335] "
      "where the third is an angle\n");
}

TEST(Stage, PluginsOfStageAreNotRun) {
  const World world = read_world(
      "position( name \"a\" ctrl \"wander\" )\nposition( name \"b\"\n ctrl \"fasr\" )\nposition( name \"c\" ctrl "
      "\"fasr\" )\n"
      "position( name \"d\" )\nmodel( name \"e\" noblocks 1 ctrl \"wander\" )\nposition( ctrl \"wander fast\" )");
  EXPECT_EQ(world.movers.at(0).controller, "wander");
  EXPECT_EQ(world.movers.at(1).controller, "");
  EXPECT_EQ(world.movers.at(3).controller, "");
  EXPECT_EQ(world.movers.at(4).controller, "wander");
  EXPECT_EQ(warnings_of(world),
            "3: ctrl \"fasr\" names a plug-in of Stage, which is not run; choose a controller with --controller NAME, "
            "or write ctrl \"wander\"\n"
            "6: ctrl \"wander\" of 'e' is ignored: it is not a robot; expected ctrl inside a robot's parentheses, or a "
            "model controller: in a file (./libmine.so, mine.py:MyClass), or the name of a loaded one\n"
            "7: 'fast' in ctrl \"wander\" is ignored: expected a setting KEY=VALUE\n"
            "4: 5 robots overlap others at the start: 'a', 'b', 'c' and 2 more; 'c' starts at (0, 0), in 'a': expected "
            "separate poses\n");
}

/// Returns one robot with this `ctrl`. Known controllers: route, wander.
World with_ctrl(const std::string& ctrl) {
  return read_world("position(\n ctrl " + ctrl + " )", {.controllers = [] {
                      return std::vector<std::string_view>{"route", "wander"};
                    }});
}

TEST(Stage, ACtrlWithoutAControllerIsWarnedOf) {
  for (const char* empty : {"\"\"", "\"  \""})
    EXPECT_EQ(warnings_of(with_ctrl(empty)),
              "2: 'ctrl' names no controller and is ignored; write ctrl \"none\" for a robot that stays at rest\n");
}

TEST(Stage, CtrlNamesAControllerWithItsSettings) {
  using Settings = std::vector<std::pair<std::string, std::string>>;
  const World world = with_ctrl("\"route  park='a b' checkpoints=[1 2]\tspeed=0.3 empty=\"");
  const Mover& mover = world.movers.at(0);
  EXPECT_EQ(mover.controller, "route");
  EXPECT_EQ(mover.controller_settings,
            (Settings{{"park", "'a b'"}, {"checkpoints", "[1 2]"}, {"speed", "0.3"}, {"empty", ""}}));
  EXPECT_TRUE(mover.controller_at.ends_with(":2: ")) << mover.controller_at;
  EXPECT_EQ(warnings_of(world), "");
  EXPECT_EQ(with_ctrl("\"none\"").movers.at(0).controller, "none");
  EXPECT_EQ(with_ctrl("\"\"").movers.at(0).controller, "");
  // Files are relative to the world file, and are not loaded with the world.
  EXPECT_EQ(with_ctrl("\"/no/libmine.so:go\"").movers.at(0).controller, "/no/libmine.so:go");
  EXPECT_TRUE(with_ctrl("\"mine.py:Go near=1\"").movers.at(0).controller.ends_with("mine.py:Go"));
}

/// A model with a file of code moves like an object of TAG packets, whose numbers it may not take.
TEST(Stage, CtrlMakesAModelMove) {
  const World world = read_world(
      "model( name \"gate\" pose [1 2 0 90] model( name \"door\" pose [0 3 0 0]\n ctrl \"/a/libdoor.so:slide speed=1\" "
      "model( name \"knob\" ) ) )\nmodel( name \"tag1\" ctrl \"door.py:Door\" )\nmodel( name \"tag7\" ctrl \"none\" )");
  EXPECT_EQ(warnings_of(world), "");
  ASSERT_EQ(world.movers.size(), 3u);
  const Mover& door = world.movers[0];
  EXPECT_EQ(door.name, "gate.door");
  EXPECT_TRUE(door.is_tag);
  EXPECT_EQ(door.id, 2u) << "1 belongs to tag1";
  EXPECT_EQ(door.drive, Drive::omni);
  EXPECT_NEAR(door.X_WM.x, -2.0, 1e-12);
  EXPECT_EQ(door.body.size(), 8u) << "with its knob";
  EXPECT_EQ(door.controller, "/a/libdoor.so:slide");
  EXPECT_EQ(door.controller_settings.at(0).second, "1");
  EXPECT_TRUE(door.controller_at.ends_with(":2: ")) << door.controller_at;
  EXPECT_TRUE(world.movers[1].controller.ends_with("door.py:Door"));
  EXPECT_EQ(world.movers[2].controller, "");
}

/// The names of loaded controllers of models are known to models only.
TEST(Stage, CtrlOfAModelNamesALoadedController) {
  const World world = read_world(
      "model( name \"door\" ctrl \"slide speed=1\" )\nmodel( name \"tag1\" pose [5 0 0 0] ctrl \"slid\" )\n"
      "position( name \"r\" pose [0 5 0 0] ctrl \"slide\" )",
      {.controllers = [] { return std::vector<std::string_view>{"route"}; },
       .model_controllers = [] { return std::vector<std::string_view>{"slide"}; }});
  ASSERT_EQ(world.movers.size(), 3u);
  EXPECT_EQ(world.movers[0].controller, "slide");
  EXPECT_EQ(world.movers[0].controller_settings.at(0).second, "1");
  EXPECT_EQ(world.movers[0].drive, Drive::omni);
  EXPECT_EQ(world.movers[1].controller, "");
  EXPECT_EQ(world.movers[2].controller, "");
  expect_in("2: ctrl \"slid\" of 'tag1' is ignored: it is not a robot", warnings_of(world));
  expect_in("or the name of a loaded one; did you mean 'slide'?", warnings_of(world));
  expect_in("3: ctrl \"slide\" is ignored: there is no controller of this name", warnings_of(world));
}

TEST(Stage, ModelsThatCannotMoveHaveNoController) {
  const std::pair<const char*, const char*> kCorpus[] = {
      {"position( name \"r\" model( name \"arm\"\n ctrl \"./a.so\" ) )",
       ":2: 'arm' is mounted on 'r', which moves it, so it can have no controller"},
      {"light( ctrl \"./a.so\" )", ":1: a light cannot move"},
      {"model( ctrl \"./a.so\"\n lamp_intensity 3 )", ":2: a lamp cannot move"},
      {"model( ctrl \"./a.so\"\n ir_emitter \"dock\" )", ":2: an infrared emitter cannot move"},
  };
  for (const auto& [text, message] : kCorpus) expect_in(message, sf::refusal_of([&] { read_world(text); }));
}

TEST(Stage, MistakesInCtrlAreReported) {
  const std::pair<const char*, const char*> kCorpus[] = {
      {"\"roote speed=1\"",
       "2: ctrl \"roote\" is ignored: there is no controller of this name; did you mean 'route'? Expected one of: "
       "route, wander, none, or a file (./libmine.so, mine.py:MyClass)\n"},
      {"\"route speed=1 =2 speed=3\"",
       "2: '=2' in ctrl \"route\" is ignored: expected a setting KEY=VALUE\n"
       "2: 'speed=3' in ctrl \"route\" is ignored: the setting is given twice\n"},
      {"[\"route\" \"wander\"]", "2: 'ctrl' expects one controller per model; only the first is used\n"},
  };
  for (const auto& [ctrl, warnings] : kCorpus) EXPECT_EQ(warnings_of(with_ctrl(ctrl)), warnings) << ctrl;
}

TEST(Stage, MisplacedBlocksAndSensorsAreReported) {
  const World world = read_world("block( points 0 )\nmodel( sensor() )");
  EXPECT_NE(warnings_of(world).find("1: 'block' is ignored here"), std::string::npos);
  EXPECT_NE(warnings_of(world).find("2: 'sensor' is ignored here"), std::string::npos);
}

TEST(Stage, MagnetsAreReadInEitherSpelling) {
  const World world = read_world(
      "model( pose [1 2 -0.09 30] size [0.05 0.04 0.1] magnetic_moment 10000 ) model( magneticmoment -2 )\n"
      "model( magnetic_moment 0 ) model( magnetic_moment 5 magnetometer_return 0 )");
  ASSERT_EQ(world.magnets.size(), 2u);
  const Magnet& m = world.magnets[0];
  EXPECT_EQ(m.moment, 1.0) << "the file counts 1e-4 A m^2";
  EXPECT_EQ(m.p.x, 1.0);
  EXPECT_EQ(m.p.y, 2.0);
  EXPECT_NEAR(m.z, -0.04, 1e-15) << "the middle of the model";
  EXPECT_EQ(m.radius, 0.02) << "half the smaller side";
  EXPECT_EQ(m.model, 0u);
  EXPECT_EQ(world.magnets[1].moment, -2e-4);
}

TEST(Stage, MagnetOfARobotMovesWithIt) {
  const World world =
      read_world("position( name \"a\" pose [3 0 0 90] model( pose [0.1 0 0.2 0] magnetic_moment 1 ) )");
  EXPECT_TRUE(world.magnets.empty());
  ASSERT_EQ(world.movers.at(0).magnets.size(), 1u);
  EXPECT_EQ(world.movers[0].magnets[0].p.x, 0.1);
}

TEST(Stage, GivenSensorTypesClaimTheirSensors) {
  constexpr std::string_view keys[] = {"scount", "spose[]"};
  const SensorKeyword words[] = {{"magnetometer", keys}, {"laneedge", {}}};
  LoadOptions options;
  options.sensors = words;
  const World world = read_world(
      "position( name \"a\"\n magnetometer( pose [0.2 0 0.1 90] scount 2 spose[1] [1 2 3] rate 5 color \"red\"\n scont "
      "3 )\n"
      " laser( name \"laneedge\" range_max 1 ) )\nmagnetometer()",
      options);
  const Mover& mover = world.movers.at(0);
  ASSERT_EQ(mover.sensors.size(), 2u);
  EXPECT_EQ(mover.sensors[0].type, "magnetometer");
  EXPECT_EQ(mover.sensors[0].line, 2);
  ASSERT_EQ(mover.sensors[0].settings.size(), 3u) << "what every model may say is no setting";
  EXPECT_EQ(mover.sensors[0].settings[1].numbers, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(mover.sensors[1].type, "laneedge");
  EXPECT_EQ(warnings_of(world),
            "3: unknown property 'scont' of 'magnetometer' is ignored; did you mean 'scount'?\n"
            "4: unknown property 'range_max' of 'laser' is ignored\n"
            "5: 'magnetometer' is not mounted on a robot: kept as a body that measures nothing\n");
}

TEST(Stage, ColoursByNameNumberAndRandomly) {
  const World world = read_world(
      "model( color \"steel blue\" ) model( color \"gray50\" ) model( color_rgba [1 0 0.2 0.4] ) model( color "
      "\"random\" )"
      " model( color \"no such\" ) model()");
  EXPECT_EQ(world.models[0].color, 0xFF4682B4u);
  EXPECT_EQ(world.models[1].color, 0xFF808080u);
  EXPECT_EQ(world.models[2].color, 0x66FF0033u);
  EXPECT_EQ(world.models[3].color >> 24, 0xFFu);
  EXPECT_EQ(world.models[4].color, world.models[5].color);
  EXPECT_NE(warnings_of(world).find("unknown colour"), std::string::npos);
}

TEST(Stage, IntervalIsInMilliseconds) {
  EXPECT_DOUBLE_EQ(read_world("interval_sim 50").interval, 0.05);
  EXPECT_DOUBLE_EQ(read_world("").interval, 0.1);
}

TEST(Stage, EmptyWorldIsAWorld) {
  const World world = read_world("# nothing\n");
  EXPECT_TRUE(world.models.empty());
  EXPECT_EQ(world.extent.x_max, 0.0);
  EXPECT_EQ(world.name, "test");
  const std::string nothing = "0: no wall, robot or other known model in this file";
  EXPECT_NE(warnings_of(world).find(nothing), std::string::npos);
  for (const char* text : {"FORMAT 0.7", "window( size [1 1] )", "define a model( )", "bumper2( size [0 0 0] )"})
    EXPECT_NE(warnings_of(read_world(text)).find(nothing), std::string::npos) << text;
  for (const char* text :
       {"model( )", "define a model( )\na( )", "position( )", "light( phases 1 phase[0] [\"red\" 1] )"})
    EXPECT_EQ(warnings_of(read_world(text)).find(nothing), std::string::npos) << text;
}

/// A room of 4 m with walls of 0.2 m, like a floor plan. Robots are discs of 0.2 m, or points without a body.
TEST(Stage, ImpossibleStartPoseIsAWarning) {
  const std::string room =
      "define wall model( size [4.4 0.2 1] )\n"
      "wall( name \"south\" pose [0 -2.1 0 0] ) wall( name \"north\" pose [0 2.1 0 0] )\n";
  const auto said = [&](const std::string& pose) {
    return warnings_of(read_world(room + "position( name \"bob\" size [0.4 0.4 0.2] pose " + pose + " )"));
  };
  EXPECT_EQ(said("[0 0 0 0]"), "");
  EXPECT_EQ(said("[0 -1.8 0 0]"), "") << "touching is fine";
  EXPECT_EQ(said("[0 -1.75 0 0]"), "");
  EXPECT_EQ(said("[0 -1.7 1 0]"), "") << "above the wall";
  EXPECT_EQ(said("[0 -2.1 0 0]"), "3: 'bob' starts at (0, -2.1), within a wall; expected a 'pose' in free space\n");
  EXPECT_EQ(said("[1 -1.85 0 0]"),
            "3: 'bob' starts at (1, -1.85), partly in a wall of 'south'; expected a 'pose' in free space\n");
  EXPECT_EQ(said("[9 9 0 0]"), "") << "there is no plan to be outside of";
  EXPECT_EQ(warnings_of(read_world("model( size [1 1 1] obstacle_return 0 ) position( )")), "") << "it stops no robot";
  EXPECT_EQ(warnings_of(read_world("model( size [1 1 1] ) position( name \"tag1\" )")), "") << "tags may be anywhere";
}

/// One warning for each kind of place.
TEST(Stage, ManyRobotsInAWallAreOneWarning) {
  std::string text = "model( name \"rock\" size [20 20 1] )\n";
  for (int i = 0; i < 5; ++i) text += fmt::format("position( name \"r{0}\" pose [{0} 0 0 0] size [0.4 0.4 0.2] )\n", i);
  EXPECT_EQ(warnings_of(read_world(text)),
            "2: 5 robots start within a wall: 'r0', 'r1', 'r2' and 2 more; the first: 'r0' starts at (0, 0), within a "
            "wall; expected a 'pose' in free space\n");
  EXPECT_EQ(
      warnings_of(read_world("model( name \"a\" size [1 1 1] )\nmodel( name \"b\" size [1 1 1] pose [5 0 0 0] )\n"
                             "position( name \"p\" pose [0.5 0.5 0 0] size [0.4 0.4 0.2] )\n"
                             "position( name \"q\" pose [5.5 0.6 0 0] size [0.4 0.4 0.2] )\n")),
      "3: 2 robots start partly in a wall: 'p', 'q'; the first: 'p' starts at (0.5, 0.5), partly in a wall of 'a'; "
      "expected a 'pose' in free space\n");
}

TEST(Stage, RobotOutsideTheFloorPlanIsAWarning) {
  const std::string plan = "model( name \"plan\" bitmap \"bitmaps/cave.png\" size [16 16 0.5] )\n";
  EXPECT_NE(warnings_of(read_world(plan + "position( name \"bob\" pose [9 0 0 0] )"))
                .find("2: 'bob' starts at (9, 0), outside 'plan'; expected"),
            std::string::npos);
  const World small_picture = read_world(
      "model( bitmap \"bitmaps/cave.png\" size [1 1 0.5] )\nmodel( pose [5 5 0 0] )\n"
      "position( name \"bob\" pose [3 3 0 0] )");
  EXPECT_EQ(warnings_of(small_picture), "") << "a picture that small is no floor plan";
}

}  // namespace
}  // namespace sf::world
