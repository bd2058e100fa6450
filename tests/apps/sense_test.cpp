// `sense` against ranges that can be computed by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "apps/reports/camera_image.h"
#include "sensors/sensor_type.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"
#include "tests/units.h"

namespace sf {

namespace {

constexpr double kExact = 1e-5;  ///< [m] the farm's guarantee
constexpr double kRuler = 1e-8;  ///< [m] accuracy for steep rays: nine decimals are printed

// A wall whose face is at x = 0 next to the path along y, a robot with a single forward beam, and a fan in all
// directions.
std::string wall_world(const Folder& folder, double x) {
  const auto at = [](double v) { return std::to_string(v); };
  return folder.write("wall.world", "model( name \"long wall\" pose [" + at(x + 0.5) +
                                        " 0 0 0] size [1 400 1] )\n"
                                        "position( name \"scout\" pose [" +
                                        at(x - 1.0) +
                                        " 0 0 0] size [0.3 0.3 0.1]\n"
                                        "  laser( samples 1 range_max 100 size [0 0 0.2] )\n"
                                        "  laser( samples 181 fov 180 range_max 8 size [0 0 0.2] ) )\n");
}

Json sense(Words words) {
  words.insert(words.begin(), "sense");
  words.push_back("--json");
  return run_json(words);
}

std::string beam(std::size_t i, const std::string& key) { return "/beams/" + std::to_string(i) + "/" + key; }

}  // namespace

TEST(Sense, AnImpossiblePoseIsAWarning) {
  const Folder folder;
  const std::string world = wall_world(folder, 0.0);
  const Outcome within = run_successfully({"sense", world, "--pose", "0.5,0,0"});
  EXPECT_NE(within.err.find("sensorfarm: warning: at (0.5, 0) 'scout' is within a wall\n"), std::string::npos)
      << within.err;
  EXPECT_NE(run_program({"sense", world, "--pose", "-0.1,0,0"}).err.find("is partly in a wall of 'long wall'"),
            std::string::npos);
  EXPECT_EQ(run_program({"sense", world, "--pose", "-1,0,0"}).err.find("warning"), std::string::npos);
  const std::string rooms = our_world("rooms.world");
  EXPECT_NE(run_program({"sense", rooms, "--pose", "1000,2000,0"}).err.find("is outside all walls (x "),
            std::string::npos);
  EXPECT_EQ(run_program({"sense", rooms, "--pose", "1,2,0"}).err.find("warning"), std::string::npos);
}

TEST(Sense, NamesWithCommasAreQuotedInCsv) {
  const Folder folder;
  const std::string text = read_file(wall_world(folder, 0.0));
  const std::string world =
      folder.write("commas.world", std::regex_replace(text, std::regex("long wall"), "wall, long"));
  const std::string csv = run_program({"sense", world}).out;
  EXPECT_NE(csv.find("\n0.000000000000,1.000000000,\"wall, long\"\n"), std::string::npos) << csv;
  const std::string plain = run_program({"sense", wall_world(folder, 0.0)}).out;
  EXPECT_NE(plain.find(",1.000000000,long wall\n"), std::string::npos) << plain;
}

TEST(Sense, EveryBeamOfAFanFollowsTheCosine) {
  const Folder folder;
  const Json scan = sense({wall_world(folder, 0.0), "--sensor", "1", "--no-return", "inf"});
  ASSERT_EQ(scan.size("/beams"), 181u);
  for (std::size_t i = 0; i < 181; ++i) {
    const double bearing = (static_cast<double>(i) - 90.0) * kDegree;
    EXPECT_NEAR(scan.number(beam(i, "bearing_rad")), bearing, 1e-11);
    const double range = 1.0 / std::cos(bearing);
    if (range < 8.0 && i > 0 && i < 180) {
      EXPECT_NEAR(scan.number(beam(i, "range_m")), range, kRuler) << i;
    } else {
      EXPECT_TRUE(scan.is_null(beam(i, "range_m"))) << i;
      EXPECT_TRUE(scan.is_null(beam(i, "hit"))) << i;
    }
  }
}

/// In a world without surfaces, where every value of some types is at least the sensor's `limit`.
TEST(Sense, NoReturnAppliesOnlyToScans) {
  const Folder folder;
  for (const sensors::SensorType* type : sensors::built_in_sensor_types()) {
    if (type->derived != nullptr) continue;  // they need inputs
    const std::string own = std::string(type->word.type) + "( )", laser = own == "laser( )" ? "" : "laser( ) ";
    const std::string world = folder.write("empty.world", "position( name \"scout\" " + laser + own + " )\n");
    const Words words{"sense", world, "--type", std::string(type->name)};
    const Words infinite = with(words, {"--no-return", "inf"});
    const Outcome plain = run_program(words), marked = run_program(infinite);
    EXPECT_EQ(plain.code, 0) << plain.err;
    EXPECT_EQ(marked.out != plain.out, type->is_scan || type->beams != nullptr) << type->name;
  }
}

TEST(Sense, GrazingIncidenceIsExactAtTheOriginAndFarAway) {
  // 0.1 m from the wall, a tenth of a degree off parallel, then 1 mrad: 57.3 m and 99.8 m ahead.
  for (const double x : {0.0, 100'000.0}) {
    const Folder folder;
    const std::string world = wall_world(folder, x);
    for (const double away : {0.1, 0.0574}) {
      const std::string pose = std::to_string(x - 0.1) + ",3," + std::to_string(90.0 - away);
      const Json scan = sense({world, "--pose", pose, "--no-return", "inf"});
      const double range = 0.1 / std::sin(away * kDegree);
      EXPECT_NEAR(scan.number(beam(0, "range_m")), range, kExact) << pose;
      EXPECT_NEAR(scan.number("/pose/2"), (90.0 - away) * kDegree, 1e-12);
    }
  }
}

TEST(Sense, PoseMovesTheRobotAndItsSensor) {
  const Json scan = sense({our_world("cave.world"), "--pose", "-1,2,90"});
  EXPECT_EQ(scan.number("/pose/0"), -1);
  EXPECT_EQ(scan.number("/pose/1"), 2);
  EXPECT_NEAR(scan.number("/pose/2"), M_PI / 2, 1e-15);
  // The scanner is 0.1 m ahead of the robot's centre, which is now towards +y.
  EXPECT_NEAR(scan.number("/sensor_pose/0"), -1.0, 1e-12);
  EXPECT_NEAR(scan.number("/sensor_pose/1"), 2.1, 1e-12);
  EXPECT_NEAR(scan.number("/sensor_pose/2"), M_PI / 2, 1e-15);
}

TEST(Sense, RobotsAndNestedModelsAreNamedAndTheOwnBodyIsNotSeen) {
  const Folder folder;
  const std::string body = " size [0.4 0.4 0.4] laser( samples 1 size [0 0 0.1] pose [0 0 -0.3 0] ) ";
  const std::string world = folder.write("two.world", "position( name \"anna\" pose [0 0 0 0]" + body +
                                                          ")\n"
                                                          "position( name \"bert\" pose [2 0 0 0]" +
                                                          body +
                                                          ")\n"
                                                          "model( name \"house\" pose [0 3 0 0] size [0.1 0.1 0.1]\n"
                                                          "  stack_children 0 model( name \"door\" size [1 1 1] ) )\n");
  const Json ahead = sense({world});
  EXPECT_EQ(ahead.text("/robot"), "anna");
  EXPECT_EQ(ahead.text(beam(0, "hit")), "bert");
  EXPECT_NEAR(ahead.number(beam(0, "range_m")), 1.8, kRuler);
  const Json left = sense({world, "--pose", "0,0,90"});
  EXPECT_EQ(left.text(beam(0, "hit")), "house.door");
  EXPECT_NEAR(left.number(beam(0, "range_m")), 2.5, kRuler);
  const Json other = sense({world, "--robot", "bert", "--pose", "0,1,0"});
  EXPECT_EQ(other.text("/robot"), "bert");
  EXPECT_TRUE(other.is_null(beam(0, "hit")));
}

TEST(Sense, ImagesAndJsonAreBothWritten) {
  const Folder folder;
  const std::string world = folder.write("c.world", "position( camera( resolution [4 2] range [0 9] ) )");
  const Json json = sense({world, "--image", "depth", "-o", folder.path("d.png")});
  EXPECT_EQ(json.number("/depth_m/0"), 9.0);
  EXPECT_TRUE(read_file(folder.path("d.png")).starts_with("\x89PNG"));
}

// Labels are numbers of models plus 2, in 16 bits.
TEST(Sense, LabelsBeyondSixteenBitsAreCounted) {
  const std::vector<std::uint32_t> hits{base::kNoHit, base::kFloorHit, 0, 65533, 65534, 66000};
  EXPECT_EQ(apps::labels_beyond({.hits = hits}), 2u) << "number 65533 has label 65535";
}

TEST(Sense, NoiseIsDisabled) {
  const Words words{"sense", our_world("rooms.world"), "--robot", "roomba2", "--json"};
  const Json scan(run_program(words).out);
  // roomba2's first laser has noise of 1 cm; the far wall straight ahead is beyond its range of 5 m.
  EXPECT_EQ(scan.number(beam(135, "range_m")), 5.0);
  EXPECT_EQ(run_program(words).out, run_program(words).out);
}

TEST(Sense, AWorldWithoutRobotsGetsADefaultOne) {
  const Folder folder;
  const std::string world = folder.write("bare.world", "model( name \"wall\" pose [2.5 0 0 0] size [1 4 1] )\n");
  const Outcome outcome = run_successfully({"sense", world, "--pose", "0,0,0", "--json"});
  EXPECT_NE(outcome.err.find("no robot"), std::string::npos);
  const Json scan(outcome.out);
  ASSERT_EQ(scan.size("/beams"), 361u);
  EXPECT_NEAR(scan.number(beam(180, "range_m")), 2.0, kRuler);
}

TEST(Sense, TheDefaultRobotIsAtAFreePosition) {
  const Folder folder;
  const std::string world = folder.write("pillar.world",
                                         "model( name \"room\" size [6 4 1] boundary 1 noblocks 0 )\n"
                                         "model( name \"pillar\" pose [0 0 0 0] size [2 2 1] )\n");
  const Json scan(run_program({"sense", world, "--json"}).out);
  EXPECT_GT(std::max(std::abs(scan.number("/pose/0")), std::abs(scan.number("/pose/1"))), 1.0);
}

/// Tilted robots, and those above the ground, have six numbers; a laser that tilts has its position and orientation.
TEST(Sense, TiltedPosesHaveSixNumbers) {
  const Folder folder;
  const std::string world = wall_world(folder, 0.0);
  const Json level = sense({world, "--pose", "-2,3,90"});
  EXPECT_EQ(level.size("/pose"), 3u);
  EXPECT_FALSE(level.has("/sensor_orientation"));
  EXPECT_EQ(sense({world, "--pose", "-2,3,-5,0,0,90"}).number("/pose/2"), -5.0);
  const Outcome text = run_successfully({"sense", world, "--pose", "-2,3,0.5,10,-20,90"});
  expect_in(
      "scout at (-2.000000, 3.000000, 0.500000) m, roll 10.000000, pitch -20.000000, yaw 90.000000 deg; its "
      "laser:0 at (",
      text.err);
  const Json tilted = sense({world, "--pose", "-2,3,0.5,10,-20,90"});
  for (const auto& [k, value] : {std::pair{2, 0.5}, {3, 10 * kDegree}, {4, -20 * kDegree}, {5, 90 * kDegree}})
    EXPECT_NEAR(tilted.number("/pose/" + std::to_string(k)), value, 1e-12);
  // The laser is 0.2 m above the origin along the robot's tilted axis.
  EXPECT_NEAR(tilted.number("/sensor_position/2"), 0.5 + 0.2 * std::cos(10 * kDegree) * std::cos(20 * kDegree), 1e-9);
  EXPECT_EQ(tilted.size("/sensor_orientation"), 4u);
  for (const char* pose : {"0,0,0,0,90.1,0", "0,0,0,181,0,0"})
    expect_in("pitch within 90 degrees", run_program({"sense", world, "--pose", pose}).err);
}

}  // namespace sf
