// Trouble with keys and clocks: both sides log it, rate-limited, and nothing else changes.

#include <gtest/gtest.h>

#include "base/elapsed.h"
#include "netio/outbox.h"
#include "netio/signature.h"
#include "netio/v2i.h"
#include "server/state_receiver.h"
#include "tests/server/fixture.h"

namespace sf::server {
namespace {

constexpr netio::SigningKey kKey{1}, kOtherKey{2};
constexpr int kSeconds = 10;  // ticks

Settings with_key() {
  Settings settings;
  settings.peers = {{netio::PeerKind::robot, 1, std::nullopt, kKey}};
  return settings;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// Returns the log lines of a farm and its robot in 3 s.
std::string lines_with(Fixture& f, const std::optional<netio::SigningKey>& key) {
  f.client.reset();  // which has its port
  f.client = f.make_client(0, key);
  f.run(3 * kSeconds);
  EXPECT_EQ(f.client->stats().answered, false);
  return f.log.read_all();
}

TEST(SignatureTrouble, BothSidesLogKeysAndAddressesThatDiffer) {
  const netio::Peer elsewhere{netio::PeerKind::robot, 1, netio::kLoopback + 1, std::nullopt};
  const struct {
    const char* name;
    std::vector<netio::Peer> peers;
    std::optional<netio::SigningKey> key;
    const char *farm, *robot;  ///< lines of the farm and of the robot, one each
  } cases[] = {{"a wrong key", with_key().peers, kOtherKey,
                "with a wrong signature: the sender's key differs from the one in --peers here",
                "has another key for robot 1 than --peers here"},
               {"a missing key", with_key().peers, std::nullopt, "without a signature: --peers has a key for it here",
                "refuses packets without a signature of robot 1: start this one with --peers, too"},
               {"a farm without the key",
                {},
                kKey,
                "whose signature is not checked: the sender uses a key",
                "does not sign its packets: start `serve` with --peers and the key of robot 1, too"},
               {"another address",
                {elsewhere},
                std::nullopt,
                "is at 127.0.0.2 in the table of peers",
                "accepts robot 1 from another address only: --peers has one for it there"}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    Settings settings;
    settings.peers = c.peers;
    Fixture f(settings);
    const std::string log = lines_with(f, c.key);
    EXPECT_EQ(count(log, c.farm), 1u) << log;
    EXPECT_EQ(count(log, c.robot), 1u) << log;
    EXPECT_EQ(count(log, "is `sensorfarm serve` running there"), 0u) << log;
  }
}

/// START and lights have no robot to name.
TEST(SignatureTrouble, OtherSendersAtAnotherAddressAreLoggedOnce) {
  const world::World world = room();
  LogPipe log;
  StateReceiver receiver(world, {.bind = {netio::kLoopback, 0},
                                 .log_descriptor = log.descriptor(),
                                 .peers = {{netio::PeerKind::start, 0, netio::kLoopback + 1, std::nullopt},
                                           {netio::PeerKind::light, 7, netio::kLoopback + 1, std::nullopt}},
                                 .lights = {7}});
  netio::Outbox sender({.bind = {netio::kLoopback, 0}});
  base::Bytes start, approaches, signals;
  netio::encode({.robot = netio::kBroadcastId}, netio::Start{}, start);
  put(netio::SignalApproach{.group = 1, .state = 3, .next = 2, .left = 6.5}, approaches);
  netio::encode({.robot = 7}, netio::V2i{approaches, {}}, signals);
  for (int i = 0; i < 3; ++i)
    for (const base::Bytes* packet : {&start, &signals})
      sender.queue({netio::kLoopback, receiver.inbox().port()}, *packet);
  sender.flush();
  receiver.receive_pending(0);
  const std::string lines = log.read_all();
  EXPECT_EQ(count(lines, "the sender of START is at 127.0.0.2 in the table of peers"), 1u) << lines;
  EXPECT_EQ(count(lines, "intersection 7 is at 127.0.0.2 in the table of peers"), 1u) << lines;
}

/// A robot whose clock was an hour ahead has left; now its clock is right.
TEST(SignatureTrouble, BothSidesLogAClockThatWasSetBack) {
  Fixture f(with_key());
  netio::Outbox before({.bind = {netio::kLoopback, 0}});
  netio::PacketSigner signer(kKey, netio::unix_microseconds() + 3'600'000'000u);
  base::Bytes packet;
  const netio::SessionToken proof{5, f.service->receiver().inbox().token(before.endpoint())};
  const auto send = [&] {
    before.queue({netio::kLoopback, f.service->port()}, packet, proof, &signer);
    before.flush();
    f.service->receive_pending(0);
  };
  netio::encode({.robot = 1}, netio::Subscribe{}, packet);
  send();
  netio::encode({.robot = 1}, netio::Leave{}, packet);
  send();
  ASSERT_EQ(f.service->stats().inbox[netio::PacketStatus::accepted], 2u);
  const std::string log = lines_with(f, kKey);
  EXPECT_EQ(count(log, "with a counter 3600.0 s behind an earlier one: the sender's clock was set back"), 1u) << log;
  EXPECT_EQ(count(log, "has received packets of robot 1 with later times: this machine's clock was set back"), 1u)
      << log;
  EXPECT_EQ(count(log, "is `sensorfarm serve` running there"), 0u) << log;
}

/// 65 s of refused packets, ten and more a second: one line immediately, then one every ten seconds with their number.
TEST(SignatureTrouble, LinesAreRateLimited) {
  Fixture f(with_key());
  f.client.reset();
  f.client = f.make_client(0, kOtherKey);
  f.run(65 * kSeconds);
  const std::string log = f.log.read_all();
  EXPECT_EQ(count(log, "with a wrong signature"), 7u) << log;
  EXPECT_EQ(count(log, "has another key"), 7u) << log;
  EXPECT_EQ(count(log, ": 1 packet dropped"), 1u) << log;
  EXPECT_GE(f.service->stats().inbox[netio::PacketStatus::wrong_signature], 120u);
}

/// Duplicates of signed packets, which networks create, are not logged.
TEST(SignatureTrouble, DuplicatesAreNotLogged) {
  Fixture f(with_key());
  netio::Outbox sender({.bind = {netio::kLoopback, 0}});
  base::Bytes packet;
  netio::encode({.robot = 1}, netio::Subscribe{}, packet);
  netio::write_session_token(packet, {5, f.service->receiver().inbox().token(sender.endpoint())});
  netio::sign(packet, kKey, netio::unix_microseconds());
  for (int copy = 0; copy < 3; ++copy) sender.queue({netio::kLoopback, f.service->port()}, packet);
  sender.flush();
  f.service->receive_pending(0);
  EXPECT_EQ(f.service->stats().inbox[netio::PacketStatus::replayed], 2u);
  EXPECT_EQ(f.service->stats().answers.queued, 0u);
  EXPECT_EQ(f.log.read_all(), "");
}

}  // namespace
}  // namespace sf::server
