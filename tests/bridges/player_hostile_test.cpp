// Slow, numerous and hostile clients of the Player server.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <random>
#include <thread>

#include "sensors/laser.h"
#include "tests/bridges/player_client.h"

namespace sf::bridges::player {

namespace {

/// A well-formed message to the server.
base::Bytes message_of(MessageType type, const Address& to, std::uint32_t subtype, const base::Bytes& payload) {
  base::Bytes bytes;
  put_header({.address = to, .type = type, .subtype = subtype, .size = static_cast<std::uint32_t>(payload.size())},
             bytes);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

base::Bytes text_and(const std::string& text, std::initializer_list<double> numbers) {
  base::Bytes bytes;
  XdrWriter xdr(bytes);
  xdr.put_text(text);
  xdr.put_all(numbers);
  return bytes;
}

/// Returns one message of each form that the server reads.
std::vector<base::Bytes> one_of_each() {
  std::vector<base::Bytes> all;
  const auto add = [&](MessageType type, const Address& to, std::uint32_t subtype, const base::Bytes& payload) {
    all.push_back(message_of(type, to, subtype, payload));
  };
  using enum MessageType;
  for (const std::uint32_t interf : {4u, 5u, 6u, 13u, 14u, 22u, 31u, 42u, 51u, 62u})
    add(request, {}, server_request::device, xdr_of(0u, 0u, interf, 0u, 1u, 0u, 0u));
  add(request, {}, server_request::device_list, {});
  add(request, {}, server_request::driver_info, xdr_of(0u, 0u, 6u, 0u, 0u, 0u));
  add(request, {}, server_request::data_mode, xdr_of(2u));
  add(request, {}, server_request::data, {});
  add(request, {}, server_request::replace_rule, xdr_of(0u, 0u, 0u, 0u, 0u));
  add(command, kPosition, 1, xdr_of(0.1, 0.0, 0.0, 1u));
  add(command, kPosition, 2, xdr_of(0.1, 0.0, 0.0, 0.1, 0.0, 0.0, 1u));
  add(command, kPosition, 4, xdr_of(0.1, 0.0));
  add(request, kPosition, 5, xdr_of(0.1, 0.0, 0.0));
  add(request, kLaserDevice, 2, base::Bytes(28));
  add(request, kLaserDevice, 4, xdr_of(1u));
  add(request, kSimulation, 2, text_and("ben", {1.0, 1.0, 0.0}));
  add(request, kSimulation, 3, text_and("ben", {1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  add(request, {Interface::map, 0}, 2, xdr_of(0u, 0u, 100u, 100u, 0u, 0u, 0u));
  return all;
}

bool is_served(const PlayerRun& run) {
  TestClient client(run.port());
  return client.banner().size() == kBannerBytes && client.request(kPosition, 1).header.type == MessageType::ack;
}

}  // namespace

TEST(PlayerHostile, WrongLengthsEndOnlyTheirOwnConnection) {
  PlayerRun run;
  TestClient good(run.port());
  good.banner();
  std::uint64_t malformed = 0;
  for (const base::Bytes& whole : one_of_each()) {
    // Data of one byte less, and of four more: requests without data and requests that only read a name ignore it.
    const std::size_t size = whole.size() - kHeaderBytes;
    const Header header = read_header(whole);
    const bool needs_none = size == 0 || header.address.interf == Interface::map || header.address == kSimulation;
    for (const std::size_t wrong : {size - 1, size + 4}) {
      if (needs_none) continue;
      base::Bytes payload(whole.begin() + kHeaderBytes, whole.end());
      payload.resize(wrong);
      TestClient bad(run.port());
      bad.banner();
      if (header.type == MessageType::command) bad.open(header.address);
      bad.send(message_of(header.type, header.address, header.subtype, payload));
      while (!bad.receive().ended) {
      }
      EXPECT_EQ(run.bridge.counts().malformed, ++malformed)
          << interface_name(header.address.interf) << " " << header.subtype;
    }
  }
  EXPECT_GT(malformed, 30u);
  EXPECT_EQ(good.request(kPosition, 1).header.type, MessageType::ack);
}

/// Requests with one byte less, and with extra bytes, checked by effects visible to other clients.
TEST(PlayerHostile, RequestsOfAWrongLengthChangeNothing) {
  PlayerRun run;
  TestClient good(run.port());
  good.banner(), good.open(kLaserDevice);
  run.tick();
  struct Request {
    Address to;
    std::uint32_t subtype;
    base::Bytes payload;
  };
  const Request requests[] = {{kLaserDevice, 4, xdr_of(0u)},  // off
                              {kPosition, 2, xdr_of(0u)},     // motors off
                              {kPosition, 3, xdr_of(0u)},
                              {kPosition, 4, xdr_of(0u)},
                              {kPosition, 5, xdr_of(5.0, 6.0, 0.0)},
                              {kSimulation, 2, text_and("ben", {2.0, -1.0, 0.5})},
                              {kSimulation, 4, text_and("ben", {2.0, -1.0, 0.0, 0.0, 0.0, 0.5, 0.0})}};
  std::uint64_t malformed = 0;
  for (const Request& request : requests)
    for (const std::size_t wrong : {request.payload.size() - 1, request.payload.size() + 4}) {
      base::Bytes payload = request.payload;
      payload.resize(wrong);
      TestClient bad(run.port());
      bad.banner();
      bad.send(message_of(MessageType::request, request.to, request.subtype, payload));
      EXPECT_TRUE(bad.receive().ended) << interface_name(request.to.interf) << " " << request.subtype << ": " << wrong;
      EXPECT_EQ(run.bridge.counts().malformed, ++malformed);
    }
  EXPECT_TRUE(run.asked().placements.empty());
  run.tick({run.reading(sensors::kLaser, {1.0, 2.0, 3.0})});
  good.send(MessageType::request, kPosition, 1);
  ASSERT_EQ(good.receive().header.address, kLaserDevice) << "it is on";
  EXPECT_EQ(good.receive().header.type, MessageType::ack);
  good.open(kPosition);
  good.send(MessageType::command, kPosition, 1, xdr_of(0.3, 0.0, 0.0, 1u));
  EXPECT_EQ(good.request(kPosition, 1).header.type, MessageType::ack);
  const std::vector<Command> commands = run.asked().commands;
  ASSERT_EQ(commands.size(), 1u) << "its motors are on";
  EXPECT_EQ(commands[0].twist.forward, 0.3);
  run.tick();
  const Message data = good.receive();
  EXPECT_EQ(XdrReader(data.payload).get_double(), 0.0) << "its odometry starts at its pose";
}

TEST(PlayerHostile, OversizedMessagesAreNotAwaited) {
  PlayerRun run;
  TestClient bad(run.port());
  bad.banner();
  base::Bytes header;
  put_header({.type = MessageType::request, .size = 0xFFFFFFFFu}, header);
  bad.send(header);
  EXPECT_TRUE(bad.receive().ended);
  TestClient web(run.port());
  web.banner();
  const std::string get = "GET / HTTP/1.1\r\nHost: localhost:6665\r\n\r\n";
  web.send({get.begin(), get.end()});
  EXPECT_TRUE(web.receive().ended);
  EXPECT_TRUE(is_served(run));
}

TEST(PlayerHostile, CorruptedMessagesAffectNoOtherClient) {
  PlayerRun run;
  std::mt19937 random(1);
  const std::vector<base::Bytes> messages = one_of_each();
  for (int round = 0; round < 300; ++round) {
    TestClient client(run.port());
    client.banner();
    base::Bytes bytes;
    for (const base::Bytes& message : messages) bytes.insert(bytes.end(), message.begin(), message.end());
    for (std::uint32_t changes = 1 + random() % 8; changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random() % 3 == 0 ? 0xFF : random());
    bytes.resize(1 + random() % bytes.size());
    client.send(bytes);
    if (round % 10 == 0) run.tick({run.reading(sensors::kLaser, {1.0, 2.0, 3.0})});
    run.asked();
  }
  EXPECT_TRUE(is_served(run));
  for (const Command& command : run.asked().commands) EXPECT_TRUE(std::isfinite(command.twist.forward));
}

TEST(PlayerHostile, TooManyClientsAreRefused) {
  PlayerRun run;
  std::vector<std::unique_ptr<TestClient>> clients;
  for (std::size_t i = 0; i < kMostClients; ++i) {
    clients.push_back(std::make_unique<TestClient>(run.port()));
    EXPECT_EQ(clients.back()->banner().size(), kBannerBytes);
  }
  EXPECT_TRUE(TestClient(run.port()).receive().ended);
  EXPECT_EQ(run.bridge.counts().refused, 1u);
  EXPECT_EQ(clients[0]->request(kPosition, 1).header.type, MessageType::ack);
}

/// A connection without an open device is closed for a new client, starting with the one that has been silent longest;
/// active clients remain. One second must pass, in which a connection may be about to open its devices.
TEST(PlayerHostile, IdleConnectionsDoNotBlockOthers) {
  PlayerRun run;
  TestClient served(run.port());
  served.banner(), served.open(kPosition);
  std::vector<std::unique_ptr<TestClient>> idle;
  for (std::size_t i = 1; i < kMostClients; ++i) {
    idle.push_back(std::make_unique<TestClient>(run.port()));
    EXPECT_EQ(idle.back()->banner().size(), kBannerBytes);
  }
  std::unique_ptr<TestClient> late;
  for (int attempt = 0; attempt < 600 && run.bridge.counts().evicted == 0; ++attempt) {
    late = std::make_unique<TestClient>(run.port());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  ASSERT_EQ(run.bridge.counts().evicted, 1u);
  EXPECT_EQ(late->banner().size(), kBannerBytes);
  EXPECT_EQ(late->request(kPosition, 1).header.type, MessageType::ack);
  EXPECT_TRUE(idle.front()->receive().ended);
  EXPECT_EQ(served.request(kPosition, 1).header.type, MessageType::ack) << "it has opened a device";
}

/// If one host has opened devices on all connections, another host replaces one of them. 127.0.0.2 is the other host.
TEST(PlayerHostile, OneHostDoesNotTakeAllConnections) {
  PlayerRun run;
  std::vector<std::unique_ptr<TestClient>> greedy;
  for (std::size_t i = 0; i < kMostClients; ++i) {
    greedy.push_back(std::make_unique<TestClient>(run.port()));
    greedy.back()->banner(), greedy.back()->open(kPosition);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_TRUE(TestClient(run.port()).receive().ended) << "of the same host";
  TestClient other(run.port(), 0, netio::kLoopback + 1);
  EXPECT_EQ(other.banner().size(), kBannerBytes);
  EXPECT_EQ(run.bridge.counts().evicted, 1u);
  EXPECT_EQ(run.bridge.counts().refused, 1u);
}

/// Silent programs of one host do not block its others for long: the one that has been silent longest is closed, and
/// until then one log line gives the reason.
TEST(PlayerHostile, SilentProgramsOfOneHostMakeRoom) {
  PlayerRun run;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> log(std::tmpfile(), std::fclose);
  PlayerBridge bridge(run.scene, {}, 0.0, fileno(log.get()));
  const netio::Endpoint server = bridge.endpoint();
  std::vector<std::unique_ptr<TestClient>> silent;
  for (std::size_t i = 0; i < kMostClients; ++i) {
    silent.push_back(std::make_unique<TestClient>(server));
    silent.back()->banner(), silent.back()->open(kPosition);
  }
  std::unique_ptr<TestClient> late;
  std::size_t refused = 0;
  for (; refused < 600 && bridge.counts().evicted == 0; ++refused) {
    late = std::make_unique<TestClient>(server);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_EQ(late->banner().size(), kBannerBytes);
  EXPECT_TRUE(silent.front()->receive().ended);
  std::rewind(log.get());
  std::array<char, 4096> text{};
  const std::string lines(text.data(), std::fread(text.data(), 1, text.size(), log.get()));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), refused > 1 ? 1 : 0) << lines;
  if (refused > 1) {
    EXPECT_NE(lines.find("1 program refused, the last from 127.0.0.1:"), std::string::npos) << lines;
  }
}

TEST(PlayerHostile, SlowClientsSkipAhead) {
  PlayerRun run(
      "name \"big\"\nposition( name \"ann\" size [0.4 0.3 0.2] laser( samples 50000 fov 180 range_max 8 ) )\n");
  TestClient slow(run.port(), 10'000), quick(run.port());
  slow.banner(), quick.banner();
  slow.open(kLaserDevice), quick.open(kPosition);
  const std::vector<double> ranges(50'000, 2.0);
  constexpr std::uint32_t kScans = 100;  // of 250 kB each, more than sockets buffer
  for (std::uint32_t i = 1; i <= kScans; ++i) {
    run.tick({run.reading(sensors::kLaser, ranges, i)});
    EXPECT_EQ(quick.receive().header.type, MessageType::data) << "others have every tick";
  }
  std::uint32_t scans = 0, last = 0;
  while (last != kScans) {
    const Message data = slow.receive();
    ASSERT_FALSE(data.ended);
    XdrReader sequence(std::span(data.payload).last(4));
    last = sequence.get();
    ++scans;
  }
  EXPECT_LT(scans, kScans) << "the newest arrived";
}

TEST(PlayerHostile, UnsentDataIsBounded) {
  std::array<int, 2> ends{};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends.data()), 0);
  const netio::Socket other(ends[1]);
  Connection connection(netio::Socket{ends[0]}, 0, netio::Endpoint{}, netio::kLoopback);
  const auto put = [&](std::uint32_t index, std::size_t size = 6u << 20) {
    Subscription& subscription = connection.subscriptions()[{Interface::laser, index}];
    connection.put_data({Interface::laser, index}, subscription, 1, 0.0, base::Bytes(size));
    return subscription.waiting.size() == kHeaderBytes + size;
  };
  EXPECT_TRUE(put(0) && put(1));
  EXPECT_FALSE(put(2)) << "the third would be more than 16 MiB";
  EXPECT_TRUE(put(1)) << "newer data in place of older";
  connection.unsubscribe({Interface::laser, 0});
  EXPECT_TRUE(put(2));
  const std::size_t rest = kMostWaiting - 2 * (kHeaderBytes + (6u << 20)) - kHeaderBytes;
  EXPECT_FALSE(put(0, rest + 1));
  EXPECT_TRUE(put(0, rest)) << "16 MiB in all";
}

/// A client that sends requests but never reads is disconnected once its answers reach the limit.
TEST(PlayerHostile, UnreadAnswersAreBounded) {
  PlayerRun run;
  TestClient greedy(run.port(), 10'000);
  greedy.banner();
  const base::Bytes ask = message_of(MessageType::request, {Interface::ranger, 0}, 1, {});
  base::Bytes many;
  for (int i = 0; i < 1000; ++i) many.insert(many.end(), ask.begin(), ask.end());
  bool ended = false;
  for (int i = 0; i < 5000 && !ended; ++i) ended = !greedy.try_send(many);
  EXPECT_TRUE(ended);
  EXPECT_TRUE(is_served(run));
}

}  // namespace sf::bridges::player
