// `run` and `plot`: a fleet in closed loop, its summary, its recording and its pictures.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <sstream>

#include "record/recording.h"
#include "tests/apps/file_size_limit.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"
#include "viz/trajectory_figure.h"
#include "world/world.h"

namespace sf {

namespace {

Words run_words(const std::string& world, const Words& more) { return with({"run", our_world(world), "--json"}, more); }

Json run(const std::string& world, const Words& more) { return run_json(run_words(world, more)); }

std::string hash(const std::string& world, const Words& more) { return run(world, more).text("/hash"); }

/// Checks the trajectories, and the map that `plot` draws.
void expect_pictures(const std::string& folder) {
  scenes::expect_painted(folder + "/trajectories.png", {{0xFF0072B2u, 60}, {0xFFD55E00u, 60}, {0xFF009E73u, 60}});
  // Occupied, unexplored, free.
  scenes::expect_painted(folder + "/occupancy.png", {{0xFF000000u, 500}, {0xFFCDCDCDu, 5000}, {0xFFFEFEFEu, 5000}});
}

/// Waits until the recording is larger than the world: then the loop is running.
bool records(Program& program, const std::string& file, std::uintmax_t bytes) {
  std::error_code ignored;  // the file does not exist yet
  const auto size = [&] { return std::filesystem::exists(file) ? std::filesystem::file_size(file, ignored) : 0; };
  return until([&] { return size() > bytes || !program.running(); }) && size() > bytes;
}

}  // namespace

/// The reason that stops most robots is first, though the other is first in the alphabet.
TEST(Run, TheReasonOfMostRobotsIsFirst) {
  const Folder folder;
  const std::string world = folder.write("w.world",
                                         "position( name \"a\" pose [0 0 0 0] laneedge( ) )\n"
                                         "position( name \"b\" pose [0 2 0 0] laneedge( phase 100 ) )\n"
                                         "position( name \"c\" pose [0 4 0 0] laneedge( phase 100 ) )\n");
  const Outcome outcome = run_program(
      {"run", world, "--json", "--duration", "5", "--controller", "lane-keeping", "--set", "half_width=0.2"});
  const Json facts(outcome.out);
  ASSERT_EQ(facts.size("/control/standing"), 2u) << outcome.out << outcome.err;
  EXPECT_EQ(facts.text("/control/standing/0/reason"), "no new readings arrive from its lane edge sensor");
  EXPECT_EQ(facts.number("/control/standing/0/robots"), 2);
  EXPECT_EQ(facts.text("/control/standing/1/reason"), "its lane edge sensor detects nothing to follow");
  EXPECT_EQ(facts.number("/control/standing/1/robots"), 1);
}

TEST(Run, ClonesAreOfTheFirstRobotWithSensorsOrANamedOne) {
  const Folder folder;
  const std::string world = folder.write(
      "w.world",
      "position( name \"dummy\" pose [-2 0 0 0] )\nposition( name \"roomba7\" pose [2 0 0 0] laser( samples 5 ) )\n");
  const auto rays = [&](const Words& more) {
    return Json(run_program(with({"run", world, "--json", "--duration", "1", "--robots", "4"}, more)).out)
        .number("/rays");
  };
  EXPECT_EQ(rays({}), 4 * 5 * 10);
  EXPECT_EQ(rays({"--of", "roomba7"}), 4 * 5 * 10);
  EXPECT_EQ(rays({"--of", "dummy"}), 0);
  const std::pair<Words, std::string> refused[] = {
      {{"--robots", "4", "--of", "roomba8"}, "has no robot 'roomba8' to copy; did you mean 'roomba7'?"},
      {{"--of", "roomba7"}, "--of requires --robots"},
      {{"--robots", "4", "--of", ""}, "expected the name of a robot, got ''"},
  };
  for (const auto& [more, message] : refused) {
    expect_refused(with({"run", world, "--duration", "0.1"}, more), message);
  }
}

TEST(Run, SettingsReachTheirController) {
  const Folder folder;
  const std::string world = folder.write(
      "town.world", "road( rndf \"" + our_world("simville/simville.rndf") +
                        "\" )\nposition( name \"car\" pose [2.4 0.75 0 0] size [0.33 0.33 0.1] laser( samples 9 ) )\n");
  const auto route = [&](const std::string& set) {
    return run_program({"run", world, "--json", "--controller", "route", "--duration", "0.2", "--set", set});
  };
  for (const std::string set :
       {"checkpoints=1", "checkpoints=1,2", "checkpoints=[1 2]", "checkpoints=1 2", "park=13.4", "park=\"13.4\""}) {
    const Outcome outcome = route(set);
    EXPECT_EQ(outcome.code, 0) << set << ": " << outcome.err;
    EXPECT_NE(outcome.out.find("\"checkpoints\": 0"), std::string::npos) << set << ": " << outcome.out;
  }
  const std::pair<std::string, std::string> refused[] = {
      {"checkpoints=one",
       "--set checkpoints: 'checkpoints' of controller 'route' expects a list of numbers such as 1,2; got 'one'"},
      {"park=13.99", "there is no parking spot '13.99'"},
      {"loop=yes", "expects true or false; got 'yes'"},
  };
  for (const auto& [set, message] : refused) {
    const Outcome outcome = route(set);
    EXPECT_EQ(outcome.code, 2) << set;
    EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
  }
}

TEST(Run, AControllerWithoutItsSensorIsRejected) {
  const std::pair<Words, std::string> cases[] = {
      {{"magnet-keeping"}, "has no magnetometers; give it a magnetometer( )"},
      {{"lane-keeping", "--set", "half_width=0.2"}, "has no lane edge sensor; give it a laneedge( )"},
      {{"docking"}, "has no infrared receiver; give it an irreceiver( )"},
  };
  for (const auto& [controller, message] : cases) {
    expect_refused(with(run_words("rooms.world", {"--duration", "1", "--controller"}), controller), message);
  }
}

/// In SimVille, two pedestrians are not on a lane.
TEST(Run, OnlyNamedRobotsAreDriven) {
  Words words =
      run_words("simville/simville.world", {"--duration", "2", "--controller", "route", "--set", "tour=true"});
  const std::string hint = "; or name the robots to drive (--drive NAME)";
  expect_refused(words, "robot 'khepera6' is at", hint);

  const Outcome off_the_lane = run_program(with(words, {"--drive", "khepera6"}));
  EXPECT_EQ(off_the_lane.code, 2);
  EXPECT_EQ(off_the_lane.err.find(hint), std::string::npos) << "it is the named robot: " << off_the_lane.err;

  words.insert(words.end(), {"--drive", "roomba0", "--drive", "roomba3"});
  const Outcome two = run_successfully(words);
  EXPECT_EQ(Json(two.out).number("/control/robots"), 2);
  EXPECT_EQ(Json(two.out).number("/robots"), 8);
}

TEST(Run, ADrivenRobotsPathDoesNotDependOnTheOption) {
  const auto some = [](const Words& drive) {
    const Words more = with({"--duration", "3"}, drive);
    return hash("rooms.world", more);
  };
  const std::string all = some({});
  EXPECT_EQ(some({"--drive", "roomba2", "--drive", "roomba1"}), all);
  const std::string one = some({"--drive", "roomba1"});
  EXPECT_NE(one, all);
  EXPECT_NE(some({"--drive", "roomba2"}), one);
  EXPECT_EQ(some({"--drive", "roomba1", "--drive", "roomba1"}), one) << "twice is once";
}

TEST(Run, OnlyExistingRobotsAndClonesMayBeNamed) {
  const Json facts = run("rooms.world", {"--robots", "5", "--duration", "0.1", "--drive", "roomba5"});
  EXPECT_EQ(facts.number("/control/robots"), 1);
  const std::pair<std::string, std::string> refused[] = {
      {"rooomba1", "has no robot 'rooomba1'; did you mean 'roomba1'?"},
      {"Roomba1", "has no robot 'Roomba1'; did you mean 'roomba1'?"},
      {"bob", "has no robot 'bob'; it has roomba1, roomba2"},
      {"roomba1,roomba2", "has no robot 'roomba1,roomba2'; it has roomba1, roomba2"},
      {"", "expected the name of a robot, got ''"},
  };
  for (const auto& [name, message] : refused) {
    expect_refused(run_words("rooms.world", {"--duration", "0.1", "--drive", name}), message);
  }
  // The world may follow the option.
  EXPECT_EQ(run_program({"run", "--drive", "roomba1", our_world("rooms.world"), "--duration", "0.1"}).code, 0);
}

TEST(Run, AFolderThatCannotBeCreatedIsReportedWithARemedy) {
  expect_refused(run_words("cave.world", {"--duration", "0.1", "--record", "/proc/x"}), "that you can write to");
}

TEST(Run, TheSameSeedGivesTheSameBytesForAnyThreadCount) {
  const Words seven{"--robots", "12", "--duration", "3", "--seed", "7"};
  const std::string first = hash("rooms.world", {"--duration", "3", "--seed", "7"});
  EXPECT_EQ(hash("rooms.world", {"--duration", "3", "--seed", "7"}), first);
  EXPECT_NE(hash("rooms.world", {"--duration", "3", "--seed", "8"}), first);
  const std::string many = hash("cave.world", seven);
  for (const std::string threads : {"1", "2", "3"}) {
    const Words words = with(seven, {"--threads", threads});
    EXPECT_EQ(hash("cave.world", words), many) << threads;
  }
}

TEST(Run, StandardErrorIsSilentWithoutATerminal) {
  EXPECT_EQ(run_program(run_words("cave.world", {"--duration", "1"})).err, "");
}

TEST(Run, ZeroDurationHasNoTicks) { EXPECT_EQ(run("cave.world", {"--duration", "0"}).number("/ticks"), 0); }

TEST(Run, RealTimeRunsAtTheSpeedOfTheClock) {
  EXPECT_GE(run("cave.world", {"--duration", "0.5", "--real-time"}).number("/wall_s"), 0.5);
}

TEST(Run, MoreRobotsThanFitAreRejected) {
  expect_refused(run_words("rooms.world", {"--robots", "60000"}), "no free space");
}

TEST(Run, RecordingsAreCompressedByDefault) {
  const Folder folder;
  const auto bytes = [&](const std::string& name, Words options) {
    const Words words = with({"--robots", "4", "--duration", "3", "--record", folder.path(name)}, options);
    return run("cave.world", words).number("/recording_bytes");
  };
  const double compressed = bytes("a", {}), plain = bytes("b", {"--compression", "none"});
  EXPECT_LT(compressed, 0.8 * plain);
  EXPECT_EQ(bytes("c", {"--compression", "zstd"}), compressed);
  EXPECT_TRUE(read_file(folder.path("a/run.mcap")) == read_file(folder.path("c/run.mcap")));
  for (const char* name : {"a", "b"}) EXPECT_EQ(run_program({"verify", folder.path(name)}).code, 0) << name;
}

TEST(Run, ARecordingIsDrawnElsewhere) {
  const Folder folder;
  const Json facts = run("cave.world", {"--robots", "4", "--duration", "5", "--record", folder.path("here")});
  EXPECT_EQ(facts.text("/recording"), folder.path("here/run.mcap"));
  EXPECT_EQ(facts.number("/recording_bytes"),
            static_cast<double>(std::filesystem::file_size(folder.path("here/run.mcap"))));
  std::filesystem::create_directory(folder.path("there"));
  std::filesystem::rename(folder.path("here/run.mcap"), folder.path("there/run.mcap"));
  run_successfully({"plot", folder.path("there"), "-o", folder.path("deep/pictures")});
  expect_pictures(folder.path("deep/pictures"));
}

TEST(Run, RecordingDoesNotChangeTheRun) {
  const Folder folder;
  const Words plain{"--robots", "3", "--duration", "2"};
  const Words recorded = with(plain, {"--record", folder.path("r"), "--record-readings"});
  EXPECT_EQ(hash("cave.world", recorded), hash("cave.world", plain));
}

/// Identical to the byte, and without the tag's track, which the recording contains.
TEST(Run, ItsPictureShowsOnlyItsRobots) {
  const Folder folder;
  run("rooms.world", {"--duration", "2", "--record", folder.path("r")});
  EXPECT_EQ(run_program({"plot", folder.path("r")}).code, 0);
  const record::Recording recording = record::open_recording(folder.path("r"));
  const world::World world = world::from_snapshot(recording.info.snapshot);
  std::vector<viz::Track> tracks;
  for (std::size_t m = 0; m < world.movers.size(); ++m) {
    if (world.movers[m].is_tag) continue;
    viz::Track& track = tracks.emplace_back(viz::Track{.name = world.movers[m].name, .duration = 1.9});
    for (const record::StateSample& s : recording.states[m]) {
      track.poses.push_back(s.X_WM);
      track.contacts.push_back(s.contact);
    }
  }
  EXPECT_LT(tracks.size(), recording.states.size());
  viz::draw_trajectories(world, tracks, folder.path("expected.png"));
  EXPECT_TRUE(read_file(folder.path("r/trajectories.png")) == read_file(folder.path("expected.png")));
  scenes::expect_painted(folder.path("r/occupancy.png"), {{0xFF000000u, 4000}});  // static objects are occupied
}

/// One scan per simulated second: with a tick of 0.1 s, at the first and the eleventh tick.
TEST(Run, ItsMapUsesOneScanPerSecond) {
  const auto map_of = [](const std::string& duration) {
    const Folder folder;
    run("rooms.world", {"--duration", duration, "--record", folder.path("r")});
    EXPECT_EQ(run_program({"plot", folder.path("r")}).code, 0);
    return read_file(folder.path("r/occupancy.png"));
  };
  const std::string first = map_of("0.1");
  EXPECT_TRUE(map_of("1") == first) << "ten ticks are less than a second";
  EXPECT_FALSE(map_of("1.1") == first) << "the eleventh is scanned from where the robots are then";
}

TEST(Run, DrawsTheMapsOfItsRobotsWhileTheyDrive) {
  const Folder folder;
  const std::string picture = folder.path("map.png");
  Program team({"run", our_world("mapping/team.world"), "--controller", "explore", "--set", "team=true", "--map-file",
                picture, "--map-view", "0"});
  EXPECT_TRUE(team.prints("view on http://127.0.0.1:")) << team.err();
  EXPECT_TRUE(until([&] { return std::filesystem::exists(picture) || !team.running(); })) << team.err();
  EXPECT_TRUE(team.running()) << "the picture appears while they drive";
  EXPECT_EQ(team.stop().code, 0);
  EXPECT_GT(scenes::read_png(picture).count(0xFFFEFEFEu), 1000) << "free cells";
}

TEST(Run, MergesMapsOfScansAtTheRobotsOwnPoses) {
  const Folder folder;
  const auto free_cells = [&](const Words& more) {
    run("mapping/team.world",
        with({"--controller", "avoid", "--duration", "1", "--map-file", folder.path("m.png")}, more));
    return scenes::read_png(folder.path("m.png")).count(0xFFFEFEFEu);
  };
  const auto one = free_cells({"--drive", "roomba1"});
  EXPECT_GT(one, 1000);
  EXPECT_GT(free_cells({}), 2 * one) << "three robots far from each other";
  const std::pair<Words, std::string> refused[] = {
      {{"worlds/cave.world", "--robots", "33"}, "at most 32 robots"},
      {{"worlds/cave.world", "--robots", "2", "--drive", "none"}, "none"},
      {{"worlds/cave.world", "--robots", "2", "--video", "a.webm"}, "--map-file excludes --video"},
  };
  for (const auto& [more, message] : refused)
    expect_refused(with({"run", SF_SOURCE_DIR "/" + more[0], "--map-file", folder.path("m.png"), "--duration", "1"},
                        Words(more.begin() + 1, more.end())),
                   message);
}

/// `run` and `plot` count contacts when they begin.
TEST(Run, CountsContactsAsInItsPicture) {
  const Folder folder;
  const Words words{"--robots", "20", "--duration", "60", "--record", folder.path("r")};
  const Json facts = run("rooms.world", words);
  std::size_t began = 0, touching = 0;
  for (const auto& states : record::open_recording(folder.path("r")).states) {
    viz::Track track;
    for (const record::StateSample& s : states) track.contacts.push_back(s.contact), touching += s.contact;
    began += viz::contact_count(track);
  }
  EXPECT_EQ(facts.number("/contacts"), static_cast<double>(began));
  EXPECT_GT(began, 0u);
  EXPECT_LT(began, touching) << "so that the two differ";
}

TEST(Run, AKilledRunCanBeDrawn) {
  const Folder folder;
  Program program(run_words("cave.world", {"--robots", "3", "--duration", "1e6", "--record", folder.path("r")}));
  ASSERT_TRUE(records(program, folder.path("r/run.mcap"), 120'000)) << program.err();
  EXPECT_EQ(program.stop(SIGKILL).signal, SIGKILL);
  const Outcome outcome = run_successfully({"plot", folder.path("r"), "-o", folder.path("p")});
  EXPECT_NE(outcome.err.find("was not finished"), std::string::npos) << outcome.err;
  expect_pictures(folder.path("p"));
}

TEST(Run, StoppingEarlyIsReportedByTheExitCode) {
  for (const int stop : {SIGINT, SIGTERM, SIGHUP}) {
    const Folder folder;
    Program program(run_words("cave.world", {"--robots", "3", "--duration", "1e6", "--record", folder.path("r")}));
    ASSERT_TRUE(records(program, folder.path("r/run.mcap"), 120'000)) << program.err();
    const Outcome outcome = program.stop(stop);
    EXPECT_EQ(outcome.code, 128 + stop) << outcome.err;
    const Json facts(outcome.out);
    EXPECT_TRUE(facts.flag("/interrupted"));
    EXPECT_GT(facts.number("/ticks"), 0);
    EXPECT_LT(facts.number("/simulated_s"), 1e6);
    const Outcome verified = run_successfully({"verify", folder.path("r")});
    EXPECT_EQ(verified.err.find("was not finished"), std::string::npos) << verified.err;
  }
}

/// A file that may not grow (`ulimit -f`) is like a full disk: it is reported, and the finished part remains valid.
TEST(Run, AFileThatMayNotGrowEndsARecordingWithAMessage) {
  const Folder folder;
  const auto run = [&] {
    const FileSizeLimit limit(400'000);
    return run_program(run_words("cave.world", {"--robots", "3", "--duration", "1e6", "--record", folder.path("r")}));
  };
  const Outcome outcome = run();
  EXPECT_EQ(outcome.signal, 0) << "SIGXFSZ is " << SIGXFSZ;
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("run.mcap: cannot take more than"), std::string::npos) << outcome.err;
  run_successfully({"verify", folder.path("r")});
}

TEST(Run, ARecordingOfNoTicksIsSound) {
  const Folder folder;
  run("cave.world", {"--robots", "2", "--duration", "0", "--record", folder.path("r")});
  const Outcome verified = run_successfully({"verify", folder.path("r")});
  EXPECT_NE(verified.out.find("sound"), std::string::npos) << verified.out;
  run_successfully({"plot", folder.path("r")});
}

TEST(Run, TheSpellingOfAWorldsPathDoesNotChangeARecording) {
  const Folder folder;
  std::filesystem::create_directories(folder.path("worlds/inc"));
  folder.write("worlds/inc/bot.inc", "define bot position( size [0.3 0.3 0.1] laser( samples 5 ) gyro( ) )\n");
  folder.write("worlds/w.world",
               "include \"inc/bot.inc\"\nmodel( size [6 4 1] boundary 1 noblocks 0 )\nbot( typo 3 )\n");
  std::string first;
  for (const char* spelt : {"worlds/w.world", "./worlds//w.world", "worlds/inc/../w.world"}) {
    const std::string record = folder.path("r" + std::to_string(first.size()));
    run_successfully({"run", folder.path(spelt), "--duration", "1", "--record", record});
    const std::string bytes = read_file(record + "/run.mcap");
    if (first.empty()) first = bytes;
    EXPECT_TRUE(bytes == first) << spelt;
  }
}

/// The kernel refuses to send to the broadcast address: as on a network that is down, no packet is sent.
TEST(Run, UnsentPacketsAreAFailure) {
  const Outcome outcome = run_program(run_words("cave.world", {"--duration", "0.5", "--send", "255.255.255.255"}));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("5 of 5 packets were not sent: 255.255.255.255:"), std::string::npos) << outcome.err;
  EXPECT_EQ(Json(outcome.out).number("/packets/failed"), 5);
}

/// Stopped at any point, every existing picture is complete.
TEST(Plot, AStopLeavesNoPartialPicture) {
  const Folder folder;
  run("cave.world", {"--robots", "20", "--duration", "300", "--record", folder.path("r")});
  Program plot({"plot", folder.path("r"), "-o", folder.path("p")});
  ASSERT_TRUE(plot.prints("wrote")) << plot.err();
  const Outcome outcome = plot.stop();
  EXPECT_EQ(outcome.signal, 0);
  if (outcome.code != 0) {
    EXPECT_EQ(outcome.code, 130);
    EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
  }
  for (const auto& file : std::filesystem::directory_iterator(folder.path("p"))) {
    const std::string bytes = read_file(file.path().string());
    EXPECT_NE(bytes.find("IEND"), std::string::npos) << file.path();
  }
}

/// Returns the ticks in a run's check points; none without the file.
static std::vector<std::string> check_points(const std::string& folder) {
  std::istringstream lines(read_file(folder + "/checkpoints"));
  std::vector<std::string> ticks;
  std::string line;
  for (std::getline(lines, line); std::getline(lines, line);) ticks.push_back(line.substr(0, line.find(' ')));
  return ticks;
}

TEST(Run, CheckPointsAreWrittenOnDemandAndAResumedRunMeetsThem) {
  const Folder folder;
  const auto recorded = [&](const std::string& name, const Words& more) {
    return run_program(with(run_words("rooms.world", {"--robots", "2", "--record", folder.path(name)}), more));
  };
  EXPECT_EQ(recorded("plain", {"--duration", "1"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.path("plain/checkpoints")));

  ASSERT_EQ(recorded("kept", {"--duration", "1", "--checkpoint", "0.5"}).code, 0);
  EXPECT_EQ(check_points(folder.path("kept")), (std::vector<std::string>{"5", "10"}));
  ASSERT_EQ(recorded("kept", {"--duration", "2", "--checkpoint", "0.5", "--resume"}).code, 0);
  EXPECT_EQ(check_points(folder.path("kept")), (std::vector<std::string>{"5", "10", "15", "20"}));
  ASSERT_EQ(recorded("kept", {"--duration", "3", "--resume"}).code, 0);
  EXPECT_EQ(check_points(folder.path("kept")).size(), 4u) << "without --checkpoint";

  const Outcome other = recorded("kept", {"--duration", "1", "--resume", "--seed", "2"});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("checkpoints:1: belongs to another run"), std::string::npos) << other.err;
  const Outcome none = recorded("plain", {"--duration", "1", "--resume"});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("no run to resume"), std::string::npos) << none.err;
}

}  // namespace sf
