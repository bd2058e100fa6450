// Every command that loads a world prints its warnings.

#include <gtest/gtest.h>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

// Five mistakes, each on a separate line; the robot is still valid.
const char* const kSlips = R"(model( name "box" pose [3 0 0 0] size [1 1 1]
  colour "red"
  masss 3 )
position( name "roomba1" size [0.3 0.3 0.1]
  velocty_bounds [-1 1 0 0 0 0 -90 90]
  laser( samples 5
    range_maxx 3
    fow 90 )
)
)";

struct Said {
  std::string file;
  Outcome outcome;
};

Said said_by(const Folder& folder, const std::string& command, const Words& more = {}) {
  const std::string file = folder.write("slips.world", kSlips);
  const Words words = with({command, file}, more);
  return {file, run_program(words)};
}

void expect_first_three(const Said& said) {
  const std::string& err = said.outcome.err;
  EXPECT_NE(err.find("sensorfarm: 5 warnings; the first 3 follow, `sensorfarm check " + said.file + "` lists all:\n" +
                     said.file + ":2: warning: unknown property 'colour'"),
            std::string::npos)
      << err;
  EXPECT_NE(err.find(said.file + ":5: warning: unknown property 'velocty_bounds' of 'position' is ignored; did you "
                                 "mean 'velocity_bounds'?\n"),
            std::string::npos)
      << err;
  EXPECT_EQ(err.find("range_maxx"), std::string::npos) << err;
}

TEST(Warnings, EveryCommandPrintsTheFirstThree) {
  const Folder folder;
  const std::vector<std::pair<std::string, Words>> commands{
      {"sense", {}},
      {"run", {"--duration", "0.2"}},
      {"serve", {"--port", "0", "--duration", "0.2"}},
      {"draw", {"-o", folder.path("slips.png")}},
      {"explain", {}},
      {"robot", {"--name", "roomba1", "--port", "9", "--duration", "0.1"}},
      {"listen", {"--duration", "0.1", "--laser-port", std::to_string(free_ports(16))}},
  };
  for (const auto& [command, more] : commands) {
    SCOPED_TRACE(command);
    expect_first_three(said_by(folder, command, more));
  }
}

TEST(Warnings, JsonListsAll) {
  const Folder folder;
  for (const auto& [command, more] : std::vector<std::pair<std::string, Words>>{
           {"check", {"--json"}},
           {"sense", {"--json"}},
           {"run", {"--json", "--duration", "0.2"}},
           {"serve", {"--json", "--port", "0", "--duration", "0.2"}},
       }) {
    SCOPED_TRACE(command);
    const Said message = said_by(folder, command, more);
    ASSERT_EQ(message.outcome.code, 0) << message.outcome.err;
    const Json facts(message.outcome.out);
    ASSERT_EQ(facts.size("/warnings"), 5u);
    EXPECT_EQ(facts.text("/warnings/4/file"), message.file);
    EXPECT_EQ(facts.number("/warnings/4/line"), 8);
    EXPECT_NE(facts.text("/warnings/4/message").find("'fow'"), std::string::npos);
  }
  const Outcome fine = run_program({"sense", our_world("rooms.world"), "--json"});
  EXPECT_EQ(Json(fine.out).size("/warnings"), 0u);
}

TEST(Warnings, ScenariosReportWarningsOfTheirWorlds) {
  const Folder folder;
  folder.write("slips.world", kSlips);
  const Outcome outcome = run_successfully(
      {"test", folder.write("a.toml", "world = \"slips.world\"\nduration = 0.2\n[expect]\ncontacts = 9\n")});
  EXPECT_NE(outcome.err.find("sensorfarm: 5 warnings; the first 3 follow"), std::string::npos) << outcome.err;
}

// A robot with a controller in the world file keeps it, unless the command line names one.
TEST(Warnings, TheCommandLineOverridesControllersOfTheWorldFile) {
  const Folder folder;
  const std::string robots =
      "position( name \"roomba1\" size [0.3 0.3 0.1] ctrl \"avoid\" laser( ) )\n"
      "position( name \"roomba2\" pose [2 0 0 0] size [0.3 0.3 0.1] ctrl \"fasr\" laser( ) )\n";
  const std::string world = folder.write("two.world", robots);
  const auto run = [&](const Words& more) { return run_successfully(with({"run", world, "--duration", "0.5"}, more)); };
  const Outcome own = run({"--json"});
  expect_in(
      "1 robot is driven by the controller in the world file (ctrl); use --drive NAME to drive a robot by "
      "'wander'",
      own.err);
  const Json facts(own.out);
  EXPECT_EQ(facts.text("/control/controller"), "avoid, wander");
  ASSERT_EQ(facts.size("/warnings"), 1u);
  EXPECT_EQ(facts.number("/warnings/0/line"), 2);
  EXPECT_NE(facts.text("/warnings/0/message").find("ctrl \"fasr\" names a plug-in of Stage"), std::string::npos);
  expect_in("--controller explore overrides the controller in the world file (ctrl) of 1 robot; --keep-ctrl keeps it",
            run({"--controller", "explore"}).err);
  expect_in("1 robot is driven by the controller in the world file",
            run({"--controller", "explore", "--keep-ctrl"}).err);
  const Outcome ordered = run({"--controller", "explore", "--drive", "roomba1"});
  EXPECT_EQ(ordered.err.find("the controller in the world file"), std::string::npos) << ordered.err;
}

TEST(Warnings, MissionsOfARunReportTheirMistakes) {
  const Folder folder;
  std::string mission = read_file(our_world("simville/simville.mdf"));
  const std::size_t at = mission.find("num_speed_limits");
  ASSERT_NE(at, std::string::npos);
  mission.replace(at, mission.find('\n', at) - at, "num_speed_limits 99");
  const std::string file = folder.write("go.mdf", mission);
  const Outcome outcome = run_successfully({"run", our_world("simville/simville.world"), "--duration", "0.2", "--json",
                                            "--controller", "route", "--set", "mission=" + file, "--drive", "roomba0"});
  EXPECT_NE(outcome.err.find("sensorfarm: 1 warning:\n" + file), std::string::npos) << outcome.err;
  EXPECT_EQ(Json(outcome.out).text("/warnings/0/file"), file);
}

const char* const kSlippedRoads = R"(RNDF_name slips
num_segments 1
num_zones 0
segment 1
lane 1.1
num_waypoints 7
lane_width 12
1.1.1 40.000000 -83.000000
1.1.2 40.000000 -82.999000
end_lane
end_segment
end_file
)";

TEST(Warnings, RoadsWithMistakesAreAcceptedUnlessStrict) {
  const Folder folder;
  const std::string rndf = folder.write("slips.rndf", kSlippedRoads);
  const Outcome check = run_successfully({"check", rndf, "--json"});
  const Json facts(check.out);
  ASSERT_EQ(facts.size("/warnings"), 2u);
  EXPECT_EQ(facts.number("/warnings/0/line"), 6);
  EXPECT_EQ(facts.number("/warnings/1/line"), 4);
  const Outcome draw = run_program({"draw", rndf, "-o", folder.path("slips.png")});
  EXPECT_EQ(draw.code, 0);
  EXPECT_NE(draw.err.find("sensorfarm: 2 warnings:\n" + rndf + ":6: warning: 'num_waypoints' is 7"), std::string::npos)
      << draw.err;
  const Outcome strict = run_program({"check", rndf, "--strict"});
  EXPECT_EQ(strict.code, 2);
  EXPECT_EQ(strict.err,
            "sensorfarm: " + rndf +
                ":6: 'num_waypoints' is 7, but lane 1.1 has 2; correct the number, or add or remove entries\n");
  const std::string world = folder.write("slips.world", "road( rndf \"slips.rndf\" )\n");
  EXPECT_EQ(Json(run_program({"check", world, "--json"}).out).size("/warnings"), 2u);
  EXPECT_EQ(run_program({"check", world, "--strict"}).code, 2);
  const std::string mdf = folder.write("go.mdf",
                                       "MDF_name go\nRNDF x\ncheckpoints\nnum_checkpoints 3\n1\nend_checkpoints\n"
                                       "speed_limits\nnum_speed_limits 0\nend_speed_limits\nend_file\n");
  EXPECT_EQ(run_program({"check", mdf}).code, 0);
  EXPECT_EQ(run_program({"check", mdf, "--strict"}).code, 2);
}

}  // namespace
}  // namespace sf
