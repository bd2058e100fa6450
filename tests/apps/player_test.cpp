// `run --player` and `serve --player` as seen by users of Player, and `robot --player`, which is one of them.

#include <gtest/gtest.h>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/bridges/player_client.h"
#include "tests/refusal.h"

namespace sf {

namespace {

using bridges::player::kPosition;
using bridges::player::kSimulation;
using bridges::player::Message;
using bridges::player::MessageType;
using bridges::player::TestClient;
using bridges::player::xdr_of;
using bridges::player::XdrReader;

/// The program with two robots and a Player server on any free port.
struct PlayerProgram {
  explicit PlayerProgram(Words words) {
    words.insert(words.begin() + 1, folder.write("two.world", bridges::player::kTwoRobots));
    program.emplace(words);
    const std::string expected = "Player server on 127.0.0.1:";
    EXPECT_TRUE(program->prints(expected));
    const std::string err = program->err();
    server.port = static_cast<std::uint16_t>(std::atoi(err.c_str() + err.find(expected) + expected.size()));
  }
  Outcome end() { return program->stop(); }
  Folder folder;
  std::optional<Program> program;
  netio::Endpoint server;
};

/// [m] Returns the y of the robot "ann" by the simulation interface.
double y_of_ann(TestClient& client) {
  base::Bytes ann;
  bridges::player::XdrWriter writer(ann);
  writer.put_text("ann");
  writer.put_all({0.0, 0.0, 0.0});
  const Message answer = client.request(kSimulation, 1, ann);
  XdrReader xdr(answer.payload);
  xdr.get_text(10), xdr.get_double();
  return xdr.get_double();
}

}  // namespace

TEST(PlayerProgram, ARobotIsDrivenAcrossTheRoomAndReset) {
  PlayerProgram run({"run", "--player", "0", "--speed", "0"});
  TestClient client(run.server);
  client.banner();
  client.pull();
  client.open({bridges::player::Interface::laser, 0});
  client.open(kPosition);
  client.send(MessageType::command, kPosition, 1, xdr_of(0.0, 0.0, 0.0, 1u));  // the user drives it from here on
  EXPECT_EQ(client.request(kPosition, 6).header.type, MessageType::ack);
  client.send(MessageType::command, kPosition, 2, xdr_of(1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 1u));
  double x = 0.0, y = 0.0;
  std::size_t scans = 0;
  for (int round = 0; round < 100'000 && std::hypot(x - 1.0, y - 0.5) > 0.05; ++round) {
    client.send(MessageType::request, {}, bridges::player::server_request::data);
    for (Message message = client.receive(); message.header.type != MessageType::sync; message = client.receive()) {
      ASSERT_FALSE(message.ended);
      scans += message.header.address.interf == bridges::player::Interface::laser;
      if (message.header.type != MessageType::data || message.header.address != kPosition) continue;
      XdrReader xdr(message.payload);
      x = xdr.get_double(), y = xdr.get_double();
    }
  }
  EXPECT_LE(std::hypot(x - 1.0, y - 0.5), 0.05);
  EXPECT_GT(scans, 0u);
  base::Bytes pose;
  bridges::player::XdrWriter writer(pose);
  writer.put_text("ben");
  writer.put_all({2.0, -1.0, 0.5});
  EXPECT_EQ(client.request(kSimulation, 2, pose).header.type, MessageType::ack);
  const Outcome outcome = run.end();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST(PlayerProgram, AServiceIsRead) {
  PlayerProgram serve({"serve", "--player", "0", "--port", "0", "--stale", "freeze"});
  TestClient client(serve.server);
  client.banner();
  client.open(kPosition);
  for (int i = 0; i < 3; ++i) {
    const Message message = client.receive();
    ASSERT_FALSE(message.ended);
    EXPECT_EQ(message.header.type, MessageType::data);
    XdrReader xdr(message.payload);
    for (int k = 0; k < 6; ++k) xdr.get_double();
    EXPECT_EQ(xdr.get(), 0u) << "a service has no contacts";
  }
  EXPECT_EQ(serve.end().code, 0);
}

/// Motor commands reach the robot's own process; robots without one are refused and reported.
TEST(PlayerProgram, AServiceForwardsCommandsToTheOwningProcess) {
  const std::string port = std::to_string(free_ports(1));
  PlayerProgram serve({"serve", "--player", "0", "--port", port, "--stale", "freeze"});
  TestClient client(serve.server);
  client.banner();
  client.open(kPosition);
  EXPECT_EQ(client.request(kPosition, 2, {0, 0, 0, 1}).header.type, MessageType::nack) << "no process drives ann";
  client.send(MessageType::command, kPosition, 1, xdr_of(0.3, 0.0, 0.0, 1u));
  EXPECT_TRUE(serve.program->prints("are dropped: no process sends its state; start `robot --name ann"))
      << serve.program->err();
  // Without sensors, whose ports other tests may use.
  const std::string world = serve.folder.write(
      "floor.world",
      "position( name \"ann\" size [0.4 0.3 0.2] velocity_bounds [-0.5 0.5 0 0 0 0 -90 90] pose [-1 0 0 90] )\n");
  Program robot({"robot", world, "--name", "ann", "--port", port, "--controller", "remote", "--json"});
  EXPECT_TRUE(until([&] {
    return client.request(kPosition, 2, {0, 0, 0, 1}).header.type == MessageType::ack;
  })) << robot.err();
  client.send(MessageType::command, kPosition, 1, xdr_of(0.3, 0.0, 0.0, 1u));
  TestClient second(serve.server);  // the newest command counts, whoever sends it
  second.banner();
  EXPECT_TRUE(until([&] { return y_of_ann(second) > 0.1; })) << robot.err();
  second.open(kPosition);
  second.send(MessageType::command, kPosition, 1, xdr_of(0.0, 0.0, 0.0, 1u));
  const Outcome outcome = robot.stop();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(Json(outcome.out).number("/drives/followed"), 0);
  EXPECT_EQ(serve.end().code, 0);
}

/// A robot's process drives the robot of another program, until that program ends.
TEST(PlayerProgram, ARobotProcessDrivesItsRobotAsAClient) {
  PlayerProgram run({"run", "--player", "0"});
  const Folder folder;
  const std::string world =
      folder.write("floor.world", "position( name \"ann\" size [0.4 0.3 0.2] track 0.3 pose [-1 0 0 90] )\n");
  Program robot({"robot", world, "--name", "ann", "--port", std::to_string(free_ports(1)), "--controller", "patrol",
                 "--set", "points=-1,0,-1,0.3", "--set", "speed=0.4", "--player", netio::endpoint_text(run.server),
                 "--json"});
  TestClient client(run.server);
  client.banner();
  double y = 0.0;
  EXPECT_TRUE(until([&] {
    y = y_of_ann(client);
    return y > 0.15;
  })) << robot.err();
  EXPECT_EQ(run.end().code, 0);
  EXPECT_TRUE(robot.prints("the connection to the Player server at 127.0.0.1:")) << robot.err();
  const Outcome outcome = robot.stop();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_EQ(facts.text("/real_robot/type"), "player");
  EXPECT_EQ(facts.number("/real_robot/wrong"), 0);
  EXPECT_GT(facts.number("/real_robot/readings/sonar"), 0);
  EXPECT_NEAR(facts.number("/real_robot/reported/length_m"), 0.4, 1e-9);
  EXPECT_NEAR(facts.number("/pose/1"), y, 0.2);
  EXPECT_NEAR(facts.number("/pose/0"), -1.0, 0.02);
}

TEST(PlayerProgram, ARobotProcessNeedsAServer) {
  const Words words{"robot", our_world("rooms.world"), "--name", "roomba2", "--duration", "0.1", "--player"};
  expect_refused(with(words, {"127.0.0.1:" + std::to_string(free_ports(1))}), "cannot connect to TCP 127.0.0.1:");
  expect_refused(with(words, {"6665"}), "expected HOST:PORT");
  expect_refused(with(words, {"127.0.0.1:0"}), "expected HOST:PORT");
  expect_refused(with(words, {"127.0.0.1:6665", "--serial", "/dev/ttyUSB0"}), "--serial");
  expect_refused(with(words, {"127.0.0.1:6665", "--robot-type", "create"}), "--serial");
}

TEST(PlayerProgram, WrongAddressesAreRejected) {
  const auto refusal = [](const std::string& address) {
    return run_program({"run", our_world("rooms.world"), "--duration", "1", "--player", address}).err;
  };
  expect_in("--player: '66650' is not an address; expected a port or HOST:PORT", refusal("66650"));
  expect_in("--player: 'nowhere' is not an address", refusal("nowhere"));
  expect_in("does not have that address", refusal("192.0.2.1:6665"));
}

}  // namespace sf
