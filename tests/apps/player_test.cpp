// `run --player` and `serve --player` as seen by users of Player.

#include <gtest/gtest.h>

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

TEST(PlayerProgram, WrongAddressesAreRejected) {
  const auto refusal = [](const std::string& address) {
    return run_program({"run", our_world("rooms.world"), "--duration", "1", "--player", address}).err;
  };
  expect_in("--player: '66650' is not an address; expected a port or HOST:PORT", refusal("66650"));
  expect_in("--player: 'nowhere' is not an address", refusal("nowhere"));
  expect_in("does not have that address", refusal("192.0.2.1:6665"));
}

}  // namespace sf
