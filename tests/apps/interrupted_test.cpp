// Commands stopped by a signal before their work is complete: none of them reports success.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {
namespace {

/// Stops the command as soon as it handles the signal.
Outcome stopped(const Words& words, int by = SIGINT) {
  Program program(words);
  EXPECT_TRUE(program.handles(by)) << words[0] << ": " << program.err();
  return program.stop(by);
}

/// A recording of one minute with forty robots, long enough for every command that reads it.
class Interrupted : public testing::Test {
 protected:
  std::string record() const {
    run_successfully(
        {"run", our_world("cave.world"), "--robots", "40", "--duration", "60", "--record", folder.path("r")});
    return folder.path("r");
  }
  std::string scenario() const {
    return folder.write("s.toml", "world = \"" + our_world("cave.world") + "\"\nrobots = 20\nduration = 60\n");
  }
  /// A world that takes a while to load, and whose field takes a while to compute.
  std::string crowded() const {
    std::string text = "define box model( size [0.1 0.1 0.1] magnetic_moment 100 )\n";
    for (int i = 0; i < 20'000; ++i)
      text += "box( pose [" + std::to_string(i % 150) + " " + std::to_string(i / 150) + " 0 0] )\n";
    return folder.write("crowded.world", text);
  }
  std::string sweep() const {
    scenario();
    return folder.write("sweep.toml", "scenario = \"s.toml\"\nseeds = 40\n");
  }
  Folder folder;
};

TEST_F(Interrupted, EachCommandEndsWithTheSignalsCode) {
  const std::string recording = record(), cave = our_world("cave.world");
  const std::string port = std::to_string(free_ports(1)), map_port = std::to_string(free_ports(1));
  const std::string pictures = folder.path("p");
  const std::vector<Words> commands = {
      {"selftest"},
      {"verify", recording, "--all"},
      {"verify", recording, "--accuracy", "skip2", "--sample", "1"},
      {"tradeoff", cave, "--robots", "100"},
      {"run", cave, "--robots", "10", "--duration", "1e6"},
      {"run", cave, "--robots", "100", "--auto"},
      {"plot", recording, "-o", pictures},
      {"export", recording, "--vtk", "-o", folder.path("e")},
      {"export", recording, "-o", folder.path("csv")},
      {"draw", crowded(), "-o", folder.path("d.png")},
      {"field", crowded(), "--height", "0.1", "-o", folder.path("f.png")},
      {"test", "--in-process", scenario(), "--junit", folder.path("j.xml")},
      {"sweep", sweep(), "-o", folder.path("s"), "--jobs", "2"},
      {"experiment", "lane-edge-p", "--trials", "200", "-o", folder.path("x"), "--files", SF_SOURCE_DIR "/experiments"},
      {"dump", "--port", port, "--count", "3"},
      {"map", "--listen", map_port, "--once"},
  };
  for (const Words& words : commands) {
    const Outcome outcome = stopped(words);
    EXPECT_EQ(outcome.code, 130) << words[0] << " " << words[1] << ": " << outcome.signal << outcome.out << outcome.err;
  }
}

TEST_F(Interrupted, FilesAreCompleteOrAbsent) {
  const Outcome exported = stopped({"export", record(), "-o", folder.path("csv")});
  EXPECT_NE(exported.err.find("interrupted: written files are complete"), std::string::npos) << exported.err;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path("csv"))) {
    EXPECT_EQ(entry.path().extension(), ".csv");
    EXPECT_TRUE(read_file(entry.path()).ends_with("\n"));
  }
  EXPECT_NE(stopped({"draw", crowded(), "-o", folder.path("d.png")}).err.find("nothing was written"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.path("d.png")));
  const Outcome tested =
      stopped({"--interrupted-code", "7", "test", "--in-process", scenario(), "--junit", folder.path("j.xml")});
  EXPECT_EQ(tested.code, 7);
  EXPECT_NE(tested.err.find("interrupted: 0 of 1 scenario run"), std::string::npos) << tested.err;
  EXPECT_NE(read_file(folder.path("j.xml")).find("interrupted"), std::string::npos);
}

TEST_F(Interrupted, ByOtherSignalsAndWithAnotherCode) {
  const Words run{"run", our_world("cave.world"), "--robots", "3", "--duration", "1e6"};
  EXPECT_EQ(stopped(run, SIGTERM).code, 128 + SIGTERM);
  EXPECT_EQ(stopped(run, SIGHUP).code, 128 + SIGHUP);
  for (const char* code : {"0", "1", "255"}) {
    Words words = with({"--interrupted-code", code}, run);
    EXPECT_EQ(stopped(words).code, std::stoi(code));
    words.erase(words.begin() + 2, words.end());
    words.push_back("selftest");
    EXPECT_EQ(stopped(words).code, std::stoi(code)) << "also where a check was not completed";
  }
  for (const char* wrong : {"256", "-1", "x"}) {
    expect_refused({"--interrupted-code", wrong, "devices"}, "--interrupted-code");
  }
}

/// The report of the finished part states that it is incomplete.
TEST_F(Interrupted, ReportsStateThatTheyAreIncomplete) {
  const Outcome text = stopped({"selftest"});
  EXPECT_NE(text.out.find("; interrupted, "), std::string::npos) << text.out;
  const Json test(stopped({"selftest", "--json"}).out);
  EXPECT_FALSE(test.flag("/sound"));
  EXPECT_TRUE(test.flag("/interrupted"));
  const std::string recording = record();
  const Json verified(stopped({"verify", recording, "--all", "--json"}).out);
  EXPECT_FALSE(verified.flag("/sound"));
  EXPECT_TRUE(verified.flag("/interrupted"));
}

/// Services and listeners run until they are stopped, so stopping them is normal use.
TEST_F(Interrupted, StoppingServicesIsSuccess) {
  const std::string rooms = our_world("rooms.world");
  EXPECT_EQ(stopped({"serve", rooms, "--port", "0", "--laser-port", std::to_string(free_ports(64))}).code, 0);
  EXPECT_EQ(stopped({"run", rooms, "--view", "127.0.0.1:0"}).code, 0) << "no --duration: until it is stopped";
  EXPECT_EQ(stopped({"light", our_world("simville/simville.world"), "--send", "127.0.0.1", "--port",
                     std::to_string(free_ports(1))})
                .code,
            0);
}

/// A signal that arrives after all work is done changes nothing.
TEST_F(Interrupted, ASignalAfterCompletionChangesNothing) { run_successfully({"selftest", "ranges"}); }

}  // namespace
}  // namespace sf
