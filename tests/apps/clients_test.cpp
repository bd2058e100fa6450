// The clients in examples/clients/: with the golden packets, and as processes connected to `serve`.

#include <gtest/gtest.h>

#include "netio/outbox.h"
#include "tests/apps/remote_robot.h"
#include "tests/netio/vectors.h"

namespace sf {

namespace {

const std::string kClients = SF_SOURCE_DIR "/examples/clients";
const std::string kPythonClient = kClients + "/sensorfarm_client.py";
const std::string kCClient = kClients + "/sensorfarm_client.c";
constexpr const char* kNoPython = "this machine has no python3";
constexpr const char* kNoCompiler = "this machine has no C compiler called cc";

bool have_compiler() { return succeeds("cc --version"); }

/// Compiles without warnings. @return path of the program
std::string compiled(const Folder& folder, const std::string& source) {
  const std::string program = folder.path("compiled"), log = folder.path("log");
  const std::string command = "cc -std=c11 -O0 -Wall -Wextra -Werror -I" SF_SOURCE_DIR " -o " + program + " " + source;
  EXPECT_EQ(std::system((command + " -lm >" + log + " 2>&1").c_str()), 0) << read_file(log);
  return program;
}

std::size_t count_vectors() {
  std::size_t count = 0;
  for (const std::string& file : test::vector_files()) count += test::read_vectors(file).size();
  return count;
}

/// Runs a checker, which reads all vectors and prints their number.
void expect_agreement(const std::string& judge, Words words) {
  for (const std::string& file : test::vector_files()) words.push_back(file);
  const Outcome outcome = Program(words, {}, "", "", judge).wait();
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.out, std::to_string(count_vectors()) + " packets\n");
}

const char* const kSensors = R"(
model( name "room" size [6 4 1] boundary 1 noblocks 0 color "gray" )
position( name "roomba1" pose [-2 0 0 0] size [0.3 0.3 0.1]
  laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] )
  sonar( scount 2 spose[0] [0.1 0 0] spose[1] [0 0.1 90] )
  gps( rate 20 ) )
)";

/// Returns the values that `sense` prints for one type. @param list of elements; empty: none
std::vector<double> read_sense(const std::string& world, const std::string& type, const std::string& list,
                               const Words& columns) {
  const Json json(
      run_program({"sense", world, "--robot", "roomba1", "--type", type, "--pose", "-1,0.5,30", "--json"}).out);
  std::vector<double> values;
  for (const std::string& column : columns)
    for (std::size_t i = 0; i < (list.empty() ? 1 : json.size("/" + list)); ++i)
      values.push_back(json.number((list.empty() ? "" : "/" + list + "/" + std::to_string(i)) + "/" + column));
  return values;
}

/// Returns the numbers in `columns` of the newest line about sensor 0 of a type.
std::vector<double> printed(const std::string& text, const std::string& type, const Words& columns) {
  std::vector<double> values;
  const std::size_t at = text.rfind(type + " 0 of robot 1 at ");
  if (at == std::string::npos || text.find('\n', at) == std::string::npos) return values;
  const std::string line = text.substr(at, text.find('\n', at) - at);
  for (const std::string& column : columns) {
    const std::size_t begin = line.find("; " + column + " = ");
    if (begin == std::string::npos) return {};
    std::istringstream numbers(line.substr(line.find('=', begin) + 1));
    for (double value = 0.0; numbers >> value;) values.push_back(value);
  }
  return values;
}

bool near(const std::vector<double>& found, const std::vector<double>& expected, double error) {
  if (found.size() != expected.size() || found.empty()) return false;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!(std::abs(found[i] - expected[i]) <= error)) return false;
  return true;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Runs a client as robot 1 of a service until it has printed the readings of `sense`; then it leaves.
void expect_readings(Service& service, unsigned ports, const std::string& program, const Words& first) {
  const auto scan = read_sense(service.world, "laser", "beams", {"range_m"});
  const auto echoes = read_sense(service.world, "sonar", "transducers", {"range_m"});
  const auto place = read_sense(service.world, "gps", "", {"x_m", "y_m"});
  Words words = first;
  for (const std::string& word :
       Words{"--robot", "1", "--farm", "127.0.0.1:" + std::to_string(service.port), "--pose", "-1,0.5,30", "--rate",
             "50", "--sensor", "laser=" + std::to_string(service.laser_port(1)), "--sensor",
             "sonar.0=" + std::to_string(ports + 8), "--sensor", "gps.0=" + std::to_string(ports + 24)})
    words.push_back(word);
  const Folder folder;
  const std::string out = folder.path("out");
  Program client(words, {}, out, "", program);
  std::string text;
  EXPECT_TRUE(until([&] {
    text = read_file(out);
    const bool agreed = near(printed(text, "laser", {"range_m"}), scan, 0.000501) &&
                        near(printed(text, "sonar", {"range_m"}), echoes, 0.000501) &&
                        near(printed(text, "gps", {"x_m", "y_m"}), place, 0.002501);
    return agreed || !client.running();
  }));
  EXPECT_TRUE(client.running()) << client.err();
  EXPECT_NE(text.find(" ms old\n"), std::string::npos) << text;

  // A stranger's scan at the same port is counted and dropped: by then, two more scans have been accepted.
  netio::Outbox stranger;
  stranger.queue({netio::kLoopback, static_cast<std::uint16_t>(service.laser_port(1))},
                 test::read_vectors(SF_SOURCE_DIR "/tests/netio/vectors/laser.txt").at(0).bytes);
  stranger.flush();
  const auto scans = [&] { return count_of(read_file(out), "laser 0 of robot 1 at "); };
  const std::size_t before = scans();
  EXPECT_TRUE(until([&] { return scans() >= before + 2 || !client.running(); }));
  const Outcome outcome = client.stop();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("accepted "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("wrong source 1"), std::string::npos) << outcome.err;
}

}  // namespace

TEST(Clients, PythonReadsAndWritesTheVectors) {
  if (!have_python()) GTEST_SKIP() << kNoPython;
  expect_agreement("python3", {SF_SOURCE_DIR "/tests/apps/clients/vectors.py", kClients});
}

TEST(Clients, CReadsAndWritesTheVectors) {
  if (!have_compiler()) GTEST_SKIP() << kNoCompiler;
  const Folder folder;
  expect_agreement(compiled(folder, SF_SOURCE_DIR "/tests/apps/clients/vectors.c"), {});
}

/// Roll and pitch reach the lidar, whose ranges are those of `sense`.
TEST(Clients, BothTiltTheirRobot) {
  if (!have_python()) GTEST_SKIP() << kNoPython;
  if (!have_compiler()) GTEST_SKIP() << kNoCompiler;
  const std::string pose = "-1,0.5,0.25,5,-10,30";
  const unsigned ports = free_ports(16);
  Service service(
      "model( name \"room\" size [6 4 1] boundary 1 noblocks 0 )\n"
      "position( name \"roomba1\" size [0.3 0.3 0.1] lidar( channels 4 columns 30 range [0 20] rate 50 ) )\n",
      {"--rate", "50", "--lidar-port", std::to_string(ports)});
  ASSERT_NE(service.port, 0u) << service.program.err();
  const std::vector<double> expected = sensed(service.world, "roomba1", pose);
  const std::string c_client = compiled(service.folder, kCClient);
  for (const auto& [program, words] : {std::pair{std::string("python3"), Words{kPythonClient}}, {c_client, Words{}}}) {
    const std::string out = service.folder.path("out");
    Program client(with(words, {"--robot", "1", "--farm", "127.0.0.1:" + std::to_string(service.port), "--pose", pose,
                                "--rate", "50", "--sensor", "lidar=" + std::to_string(ports + 8)}),
                   {}, out, "", program);
    EXPECT_TRUE(until([&] {
      return near(printed(read_file(out), "lidar", {"range_m"}), expected, 0.000501) || !client.running();
    })) << read_file(out);
    EXPECT_TRUE(client.running()) << client.err();
    client.stop();
  }
}

/// Both run as the same robot, one after the other: the second is accepted because the first has sent LEAVE.
TEST(Clients, BothPrintTheReadingsOfSense) {
  if (!have_python()) GTEST_SKIP() << kNoPython;
  if (!have_compiler()) GTEST_SKIP() << kNoCompiler;
  const unsigned ports = free_ports(32);
  Service service(kSensors,
                  {"--rate", "50", "--sonar-port", std::to_string(ports), "--gps-port", std::to_string(ports + 16)});
  ASSERT_NE(service.port, 0u) << service.program.err();
  expect_readings(service, ports, "python3", {kPythonClient});
  expect_readings(service, ports, compiled(service.folder, kCClient), {});
  const Json facts(service.program.stop().out);
  EXPECT_GE(facts.number("/received/accepted"), 6) << "of each a request, a state and its last";
  EXPECT_FALSE(facts.has("/received/wrong source"));
  EXPECT_FALSE(facts.has("/received/stale"));
}

TEST(Clients, BothSignAndVerifySignatures) {
  if (!have_python()) GTEST_SKIP() << kNoPython;
  if (!have_compiler()) GTEST_SKIP() << kNoCompiler;
  const unsigned ports = free_ports(32);
  const Folder folder;
  const std::string key(64, 'a'), file = folder.write("key", key + "\n");
  const std::string peers = folder.write("peers.toml", "[[peer]]\nrobot = 1\nkey = \"" + key + "\"\n");
  Service service(kSensors, {"--rate", "50", "--sonar-port", std::to_string(ports), "--gps-port",
                             std::to_string(ports + 16), "--peers", peers});
  ASSERT_NE(service.port, 0u) << service.program.err();
  expect_readings(service, ports, "python3", {kPythonClient, "--key", file});
  expect_readings(service, ports, compiled(service.folder, kCClient), {"--key", file});
  const Json facts(service.program.stop().out);
  EXPECT_GE(facts.number("/received/accepted"), 6);
  for (const char* reason : {"not signed", "wrong signature", "replayed"})
    EXPECT_FALSE(facts.has(std::string("/received/") + reason)) << reason;
}

/// A control centre with a key receives the states of a robot, whatever the radio range; with another key none.
TEST(Clients, TheCentreSignsAndVerifiesSignatures) {
  if (!have_python()) GTEST_SKIP() << kNoPython;
  const Folder folder;
  const std::string key = folder.write("key", std::string(64, 'a') + "\n"),
                    other = folder.write("other", std::string(64, 'b') + "\n");
  const std::string peers =
      folder.write("peers.toml", "[[peer]]\ncentre = true\nkey = \"" + std::string(64, 'a') + "\"\n");
  Service service(kRoom, {"--rate", "50", "--radio", "0", "--peers", peers});
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot robot(1, service.port, service.laser_port(1));
  ASSERT_TRUE(prove(robot));
  const auto printed_by_centre = [&](const std::string& with_key, const std::string& expected) {
    const std::string out = with_key + ".out";
    Program centre({kClients + "/sensorfarm_centre.py", "--farm", "127.0.0.1:" + std::to_string(service.port), "--key",
                    with_key, "--every", "0.1"},
                   {}, out, "", "python3");
    EXPECT_TRUE(until([&] {
      robot.send_state({1.0, 0.5, 0.0, 0.0});
      return read_file(out).find(expected) != std::string::npos || !centre.running();
    }));
    EXPECT_EQ(centre.stop().code, 0);
    return read_file(out);
  };
  const std::string text = printed_by_centre(key, "robot 1 x 1.000 y 0.500 yaw 0.000 speed 0.000\n");
  EXPECT_NE(text.find("robot 1 x 1.000"), std::string::npos) << text;
  EXPECT_EQ(text.find("signature"), std::string::npos) << text;
  const std::string refused = printed_by_centre(other, "wrong signature");
  EXPECT_NE(refused.find("refused: wrong signature"), std::string::npos) << refused;
  EXPECT_EQ(refused.find("robot 1"), std::string::npos) << refused;
  EXPECT_GE(Json(service.program.stop().out).number("/received/wrong signature"), 1);
}

/// RFC 4231, lengths around a block, the example of docs/packets.md, and all cases of the test below.
TEST(Clients, CSignsAsSpecified) {
  if (!have_compiler()) GTEST_SKIP() << kNoCompiler;
  const Folder folder;
  const Outcome outcome =
      Program({}, {}, "", "", compiled(folder, SF_SOURCE_DIR "/tests/apps/clients/signatures.c")).wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "sound\n");
}

/// Counters at the edges of the window, as in `CounterWindow`, a flipped bit and a different key.
TEST(Clients, PythonRejectsTheSamePacketsAsTheFarm) {
  if (!have_python()) GTEST_SKIP() << kNoPython;
  const Outcome outcome =
      Program({SF_SOURCE_DIR "/tests/apps/clients/signatures.py", kClients}, {}, "", "", "python3").wait();
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.out, "sound\n");
}

TEST(Clients, WrongArgumentsAreRejected) {
  if (!have_compiler()) GTEST_SKIP() << kNoCompiler;
  const Folder folder;
  const std::string client = compiled(folder, kCClient);
  for (const Words& words : std::vector<Words>{{},
                                               {"--robot", "65536"},
                                               {"--robot", "100000"},
                                               {"--robot", "-1"},
                                               {"--robot", "7x"},
                                               {"--robot", "1", "--rate", "0"},
                                               {"--robot", "1", "--key", "/dev/null"},
                                               {"--robot", "1", "--key", "no such file"},
                                               {"--robot", "1", "--pose", "1,2"},
                                               {"--robot", "1", "--pose", "nan,0,0"},
                                               {"--robot", "1", "--pose", "10000001,0,0"},
                                               {"--robot", "1", "--sensor", "laser.0=11000x"},
                                               {"--robot", "1", "--sensor", "laser."},
                                               {"--robot", "1", "--farm", "127.0.0.1"},
                                               {"--robot", "1", "--sensor", "eye"},
                                               {"--robot", "1", "--sensor", "laser=65536"},
                                               {"--robot"}}) {
    const Outcome outcome = Program(words, {}, "", "", client).wait();
    EXPECT_EQ(outcome.code, 2) << testing::PrintToString(words);
    EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
  }
}

}  // namespace sf
