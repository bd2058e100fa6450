// Lockstep as users run it: `serve --lockstep` and the clients in examples/clients/, each in a process.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "base/hash.h"
#include "control/own_controllers.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/apps/file_size_limit.h"
#include "tests/apps/remote_robot.h"
#include "tests/scenarios/lockstep_driver.h"
#include "world/free_space.h"

namespace sf {

namespace {

const std::string kLockstepClients = SF_SOURCE_DIR "/examples/clients/sensorfarm_lockstep";
constexpr int kLockstepTicks = 60;

/// The algorithm of both clients, in process.
class Avoid final : public sensorfarm::Controller {
 public:
  sensorfarm::Twist step(const sensorfarm::Input& input) override {
    const std::span<const double> ranges = input.newest("laser")->values;
    const double nearest = *std::min_element(ranges.begin(), ranges.end());
    const double turn = 0.125 * (ranges.back() - ranges.front());
    return {0.25 * std::min(nearest, 2.0), 0.0, nearest < 0.6 ? 1.0 : turn};
  }
};

std::string hash_of_avoid() {
  control::add_own_controller(
      {"avoid-test", "", 10.0, false,
       [](const sensorfarm::Robot&, sensorfarm::Settings&) { return std::make_unique<Avoid>(); }},
      "test");
  world::World world = world::load_world(our_world("cave.world"), {.sensors = sensors::world_file_words()});
  world::clone_robots(world, 3, 1, "");
  gpu::Device device;
  scenarios::Simulation simulation(world, device, {.actor = {.controller = {.name = "avoid-test"}}});
  for (int tick = 0; tick <= kLockstepTicks; ++tick) simulation.step();
  return base::hash_hex(simulation.farm().hash());
}

/// Three copies of the cave's robot, served in lockstep.
struct LockstepServer {
  explicit LockstepServer(const Words& more) : program(words(more)) {
    if (!program.prints("; press Ctrl-C to stop")) return;
    const std::string message = program.err();
    port = static_cast<unsigned>(std::atoi(message.c_str() + message.find("127.0.0.1:") + 10));
  }
  static Words words(const Words& more) {
    return with({"serve", our_world("cave.world"), "--lockstep", "--robots", "3", "--port", "0", "--json"}, more);
  }
  Json end(int code = 0) {
    const Outcome outcome = program.stop();
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return Json(outcome.out);
  }

  Program program;
  unsigned port = 0;
};

Words client_words(unsigned port, const std::string& robots, const Words& first = {}) {
  Words all = first;
  for (const std::string& word : Words{"--robots", robots, "--farm", "127.0.0.1:" + std::to_string(port), "--ticks",
                                       std::to_string(kLockstepTicks), "--timeout", "60"})
    all.push_back(word);
  return all;
}

Words python_words(unsigned port, const std::string& robots) {
  return client_words(port, robots, {kLockstepClients + ".py"});
}

std::string compiled_lockstep(const Folder& folder) {
  const std::string program = folder.path("compiled"), log = folder.path("log");
  const std::string command =
      "cc -std=c11 -O0 -ffp-contract=off -Wall -Wextra -Werror -o " + program + " " + kLockstepClients + ".c";
  EXPECT_EQ(std::system((command + " -lm >" + log + " 2>&1").c_str()), 0) << read_file(log);
  return program;
}

/// Each client drives the robots of a separate service; then both drive the robots of one service.
TEST(LockstepClients, DriveLikeTheSameControllerInProcess) {
  if (!have_python()) GTEST_SKIP() << "this machine has no python3";
  if (!succeeds("cc --version")) GTEST_SKIP() << "this machine has no C compiler called cc";
  const Folder folder;
  const std::string expected = hash_of_avoid(), c_client = compiled_lockstep(folder);
  std::vector<std::string> places;
  for (const bool python : {true, false}) {
    LockstepServer server({});
    ASSERT_NE(server.port, 0u) << server.program.err();
    const Words words = python ? python_words(server.port, "1-3") : client_words(server.port, "1-3");
    const Outcome client = Program(words, {}, "", "", python ? "python3" : c_client).wait();
    EXPECT_EQ(client.code, 0) << client.err;
    EXPECT_EQ(count_lines(client.out), 3u);
    places.push_back(client.out);
    const Json facts = server.end();
    EXPECT_EQ(facts.text("/hash"), expected) << (python ? "Python" : "C");
    EXPECT_EQ(facts.number("/ticks"), kLockstepTicks + 1);
  }
  EXPECT_EQ(places[0], places[1]) << "to the last digit";

  LockstepServer both({"--wait-for", "3"});
  ASSERT_NE(both.port, 0u) << both.program.err();
  Program one(python_words(both.port, "1-2"), {}, "", "", "python3");
  EXPECT_EQ(Program(client_words(both.port, "3"), {}, "", "", c_client).wait().code, 0);
  EXPECT_EQ(one.wait().code, 0);
  EXPECT_EQ(both.end().text("/hash"), expected);
}

/// Both clients print the flag, and no error if the bound does not hold for every beam.
TEST(LockstepClients, HaveFlagsAndErrors) {
  if (!have_python()) GTEST_SKIP() << "this machine has no python3";
  if (!succeeds("cc --version")) GTEST_SKIP() << "this machine has no C compiler called cc";
  const Folder folder;
  const std::string python = folder.write("look.py", R"(
import sys
sys.path.insert(0, sys.argv[1])
from sensorfarm_lockstep import Lockstep
fleet = Lockstep([1], ("127.0.0.1", int(sys.argv[2])), ["laser"])
reading = fleet.readings[1, "laser", 0]
print(reading.unsure, "none" if reading.error is None else "within 2 nm" if reading.error < 2e-9 else "large")
fleet.leave()
)");
  const std::string c = folder.write("look.c", R"(
int main(int argc, char** argv) {
  static sf_lockstep l;
  if (argc < 2 || !sf_lockstep_open(&l, 1, 1, "127.0.0.1", argv[1], 1u << SF_LASER, 60)) return 1;
  const sf_reading* const reading = sf_find_reading(&l.robots[0], SF_LASER, 0);
  printf("%d %s\n", reading->unsure, isinf(reading->error) ? "none" : reading->error < 2e-9 ? "within 2 nm" : "large");
  sf_lockstep_close(&l);
  return 0;
}
)");
  const std::string program = folder.path("look"), log = folder.path("log");
  ASSERT_EQ(std::system(("cc -std=c11 -w -DSENSORFARM_LOCKSTEP_NO_MAIN -include " + kLockstepClients + ".c -o " +
                         program + " " + c + " -lm >" + log + " 2>&1")
                            .c_str()),
            0)
      << read_file(log);
  const std::string clients = kLockstepClients.substr(0, kLockstepClients.rfind('/'));
  for (const bool skips : {false, true})
    for (const bool is_python : {true, false}) {
      LockstepServer server(skips ? Words{"--accuracy", "skip2"} : Words{});
      ASSERT_NE(server.port, 0u) << server.program.err();
      const std::string port = std::to_string(server.port);
      const Outcome client = is_python ? Program({"-B", python, clients, port}, {}, "", "", "python3").wait()
                                       : Program({port}, {}, "", "", program).wait();
      EXPECT_EQ(client.out, skips ? "1 none\n" : "0 within 2 nm\n") << client.err << (is_python ? "Python" : "C");
      server.end();
    }
}

TEST(LockstepClients, PythonDrivesRobotsWithKeys) {
  if (!have_python()) GTEST_SKIP() << "this machine has no python3";
  const Folder folder;
  std::string peers;
  Words keys;
  for (const char digit : {'1', '2'}) {  // robot 3 has none
    const std::string key(64, digit), robot(1, digit);
    peers += "[[peer]]\nrobot = " + robot + "\nkey = \"" + key + "\"\n";
    keys.push_back("--key"), keys.push_back(robot + "=" + folder.write("key" + robot, key + "\n"));
  }
  LockstepServer server({"--peers", folder.write("peers.toml", peers)});
  ASSERT_NE(server.port, 0u) << server.program.err();
  Words words = python_words(server.port, "1-3");
  const Outcome unsigned_client =
      Program({words[0], "--robots", "1", "--farm", words[4], "--timeout", "0.2"}, {}, "", "", "python3").wait();
  EXPECT_EQ(unsigned_client.code, 1);
  EXPECT_NE(unsigned_client.err.find("no farm in lockstep answers"), std::string::npos) << unsigned_client.err;
  words.insert(words.end(), keys.begin(), keys.end());
  const Outcome client = Program(words, {}, "", "", "python3").wait();
  EXPECT_EQ(client.code, 0) << client.err;
  const Json facts = server.end();
  EXPECT_EQ(facts.number("/ticks"), kLockstepTicks + 1);
  EXPECT_EQ(facts.number("/lockstep/commands"), 3 * kLockstepTicks);
  EXPECT_GE(facts.number("/received/not signed"), 1);
  EXPECT_FALSE(facts.has("/received/replayed"));
}

TEST(LockstepClients, ARecordingIsReportedWithItsSize) {
  const Folder folder;
  LockstepServer server({"--record", folder.path("r")});
  ASSERT_NE(server.port, 0u) << server.program.err();
  const Json facts = server.end();
  EXPECT_EQ(facts.text("/recording"), folder.path("r/run.mcap"));
  EXPECT_EQ(facts.number("/recording_bytes"),
            static_cast<double>(std::filesystem::file_size(folder.path("r/run.mcap"))));
  EXPECT_FALSE(facts.has("/recording_error"));
}

/// The recording may not grow, as on a full disk: the robots are served to the end, and the service reports it.
TEST(LockstepClients, AnIncompleteRecordingExitsWithOne) {
  const Folder folder;
  const FileSizeLimit limit(400'000);
  LockstepServer server({"--record", folder.path("r")});
  ASSERT_NE(server.port, 0u) << server.program.err();
  scenarios::Driver driver(static_cast<std::uint16_t>(server.port), {1, 2, 3});
  const auto is_complete = [&] {
    driver.receive(), driver.repeat();
    return driver.is_complete();
  };
  ASSERT_TRUE(until(is_complete));
  driver.step({}, 1000);
  ASSERT_TRUE(until(is_complete));
  driver.leave();
  const Json facts = server.end(1);
  EXPECT_NE(facts.text("/recording_error").find("cannot take more than"), std::string::npos);
  EXPECT_EQ(facts.number("/lockstep/lost_robots"), 0);
  EXPECT_EQ(facts.number("/ticks"), 1001);
}

/// One client subscribes and never steps while another waits.
TEST(LockstepClients, ALostRobotExitsWithOne) {
  LockstepServer server({"--wait-for", "2", "--lockstep-timeout", "0.05"});
  ASSERT_NE(server.port, 0u) << server.program.err();
  scenarios::Driver one(static_cast<std::uint16_t>(server.port), {1}),
      other(static_cast<std::uint16_t>(server.port), {2});
  ASSERT_TRUE(until([&] {
    for (scenarios::Driver* driver : {&one, &other}) driver->receive(), driver->repeat();
    return one.is_complete() && other.is_complete();
  }));
  one.step({});
  EXPECT_TRUE(until([&] {
    one.receive(), one.repeat();
    return one.is_complete();
  }));
  EXPECT_EQ(server.end(1).number("/lockstep/lost_robots"), 1);
}

TEST(LockstepClients, IncompatibleOptionsAreRejected) {
  for (const Words& more : std::vector<Words>{{"--rate", "5"},
                                              {"--filter"},
                                              {"--laser-port", "12000"},
                                              {"--wire", "thesis"},
                                              {"--wait-for", "4"},
                                              {"--forget", "3"}}) {
    const Outcome outcome = run_program(LockstepServer::words(more));
    EXPECT_NE(outcome.code, 0) << more.front();
    EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
  }
  EXPECT_NE(run_program({"serve", our_world("cave.world"), "--wait-for", "1"}).code, 0);
}

}  // namespace

}  // namespace sf
