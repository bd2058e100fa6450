#include "netio/relay.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>

#include "netio/nearby.h"
#include "netio/radio.h"
#include "tests/netio/examples.h"

namespace sf::netio {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// A farm with three robots; each test speaks for them.
struct RelayTest : testing::Test {
  Inbox inbox{{.bind = {kLoopback, 0}, .robots = {3, 7, 9}}};
  Relay relay{std::vector<std::uint32_t>{9, 3, 7}};
  Outbox outbox{inbox.socket()};
  std::vector<std::unique_ptr<Radio>> radios;
  std::uint32_t sequence = 0;

  RelayTest() {
    for (const std::uint32_t id : {3u, 7u, 9u}) {
      RadioOptions options{.farm = {kLoopback, inbox.port()}, .robot = id};
      for (const std::uint32_t other : {3u, 7u, 9u})
        if (other != id) options.others.push_back(other);
      radios.push_back(std::make_unique<Radio>(options));
    }
  }
  Radio& radio(std::uint32_t id) { return *radios[id == 3 ? 0 : id == 7 ? 1 : 2]; }

  void say(std::uint32_t id, double x) {
    base::Bytes bytes;
    encode({.robot = static_cast<std::uint16_t>(id), .sequence = sequence++}, V2v{.X_WR = {x, 0, 0, 0}}, bytes);
    radio(id).send(bytes);
    take();
  }
  void ask(std::uint32_t id, std::uint32_t kinds) {
    base::Bytes bytes;
    encode({.robot = static_cast<std::uint16_t>(id), .sequence = sequence++}, Subscribe{kinds}, bytes);
    radio(id).send(bytes);
    take();
  }
  void start(std::uint16_t id) {
    base::Bytes bytes;
    encode({.robot = id}, Start{}, bytes);
    radio(3).send(bytes);
    take();
  }
  void take() {
    std::size_t taken = 0;
    for (int looks = 0; taken == 0 && looks < 10'000'000; ++looks)
      taken = inbox.receive(0, [&](const Packet& packet) { relay.take(packet); });
  }
  void tick(std::int64_t now = 0) {
    relay.pass_on(inbox, now, outbox);
    outbox.flush();
  }
  /// What a robot hears: loopback gives at once what was sent.
  std::vector<Packet> heard(std::uint32_t id, std::int64_t now = 0) {
    std::vector<Packet> packets;
    Radio& one = radio(id);
    one.receive([&](std::span<const std::uint8_t> bytes) {
      Packet packet;
      if (one.accept(bytes, now, packet) == Reason::accepted) packets.push_back(packet);
    });
    return packets;
  }
};

TEST_F(RelayTest, OthersStatesGoToThoseThatAsked) {
  ask(3, kOthers);
  say(3, 1.0);
  say(7, 2.0);
  tick();
  const auto packets = heard(3);
  ASSERT_EQ(packets.size(), 1u);  // not its own
  EXPECT_EQ(packets[0].header.robot, 7);
  EXPECT_EQ(std::get<V2v>(packets[0].body).X_WR.x, 2.0);
  EXPECT_TRUE(heard(7).empty());  // did not ask
  EXPECT_TRUE(heard(9).empty());  // never spoke
  EXPECT_EQ(relay.counts().states, 1u);
}

TEST_F(RelayTest, TheNewestOfEachOncePerTick) {
  ask(3, kOthers);
  for (const double x : {1.0, 2.0, 3.0}) say(7, x);
  say(9, 4.0);
  tick();
  auto packets = heard(3);
  ASSERT_EQ(packets.size(), 2u);
  EXPECT_EQ(std::get<V2v>(packets[0].body).X_WR.x, 3.0);
  tick();  // nothing new: nothing sent
  EXPECT_TRUE(heard(3).empty());
  say(7, 5.0);
  tick();
  EXPECT_EQ(heard(3).size(), 1u);
}

TEST_F(RelayTest, WhatNobodyAskedForIsForgotten) {
  say(7, 2.0);
  tick();
  ask(3, kOthers);
  tick();
  EXPECT_TRUE(heard(3).empty());
}

TEST_F(RelayTest, SilentRobotsAreSentNothing) {
  ask(3, kOthers);
  say(7, 2.0);
  start(kEveryone);
  tick(2 * kSecond);
  EXPECT_EQ(relay.counts().states + relay.counts().starts, 0u);
}

TEST_F(RelayTest, StartGoesToAllThatAreHeard) {
  say(3, 0.0);
  say(7, 0.0);
  start(kEveryone);
  start(kEveryone);  // before the tick: one will do
  tick();
  for (const std::uint32_t id : {3u, 7u}) {
    const auto packets = heard(id);
    ASSERT_EQ(packets.size(), 1u) << id;
    EXPECT_TRUE(std::holds_alternative<Start>(packets[0].body));
  }
  EXPECT_TRUE(heard(9).empty());
  tick();
  EXPECT_TRUE(heard(3).empty());  // once
}

TEST_F(RelayTest, StartMayMeanOneRobot) {
  say(3, 0.0);
  say(7, 0.0);
  start(7);
  tick();
  EXPECT_EQ(relay.counts().starts, 1u);
  EXPECT_TRUE(heard(3).empty());
  EXPECT_EQ(heard(7).size(), 1u);
}

TEST_F(RelayTest, PassesOnTheBytesAsTheyCame) {
  base::Bytes bytes;
  const V2v state{.X_WR = {1.5, -2.25, 0.0, 0.5}, .velocity = {0.25, 0.0, -0.125}, .follows = 3, .docking = true};
  encode({.robot = 7, .sequence = 77, .time = 1'500'000'000}, state, bytes);
  Packet packet;
  ask(3, kOthers);
  ASSERT_EQ(inbox.accept(bytes, {kLoopback, 1}, 0, packet), Reason::accepted);
  relay.take(packet);
  tick();
  base::Bytes came;
  radio(3).receive([&](std::span<const std::uint8_t> got) { came.assign(got.begin(), got.end()); });
  EXPECT_EQ(came, bytes);
}

TEST_F(RelayTest, TagsAndRequestsAreNotPassedOn) {
  ask(3, kOthers);
  Packet packet;
  decode(tag_example(), packet);
  relay.take(packet);
  decode(subscribe_example(), packet);
  relay.take(packet);
  tick();
  EXPECT_EQ(relay.counts().states + relay.counts().starts, 0u);
}

/// A fleet whose robots say where they are, all from one socket; nothing has to arrive.
struct Crowd {
  std::vector<std::uint32_t> ids;
  Inbox inbox;
  Relay relay;
  Outbox outbox;
  std::uint32_t sequence = 0;

  static std::vector<std::uint32_t> first(std::uint32_t count) {
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  Crowd(std::uint32_t count, const RelayOptions& options)
      : ids(first(count)), inbox({.bind = {kLoopback, 0}, .robots = ids}), relay(ids, options) {}

  void take(const base::Bytes& bytes) {
    Packet packet;
    ASSERT_EQ(inbox.accept(bytes, {kLoopback, 9}, 0, packet), Reason::accepted);
    relay.take(packet);
  }
  void say(std::uint32_t id, double x, double y) {
    base::Bytes bytes;
    encode({.robot = static_cast<std::uint16_t>(id), .sequence = sequence++}, V2v{.X_WR = {x, y, 0, 0}}, bytes);
    take(bytes);
  }
  void ask(std::uint32_t id) {
    base::Bytes bytes;
    encode({.robot = static_cast<std::uint16_t>(id), .sequence = sequence++}, Subscribe{kOthers}, bytes);
    take(bytes);
  }
  RelayCounts pass() {
    const RelayCounts before = relay.counts();
    relay.pass_on(inbox, 0, outbox);
    const RelayCounts& now = relay.counts();
    return {now.states - before.states, now.datagrams - before.datagrams, 0, now.waited - before.waited};
  }
};

TEST(RelayBounds, OnlyStatesWithinTheRadiosRange) {
  Crowd crowd(4, {.range = 10.0});
  for (std::uint32_t id = 0; id < 4; ++id) crowd.ask(id);
  crowd.say(0, 0, 0);
  crowd.say(1, 6, 8);           // just within reach of 0
  crowd.say(2, -6, -8.000001);  // just beyond
  crowd.say(3, 1000, 0);
  EXPECT_EQ(crowd.pass().states, 2u) << "0 and 1 hear each other";
}

/// Without a place there is no near: any will do.
TEST(RelayBounds, WhoNeverSaidWhereItIsHearsAll) {
  Crowd crowd(3, {.range = 10.0});
  crowd.ask(0);
  crowd.say(1, 6, 8);
  crowd.say(2, 1000, 0);
  EXPECT_EQ(crowd.pass().states, 2u);
}

TEST(RelayBounds, ManyStatesADatagram) {
  Crowd crowd(40, {});
  crowd.ask(0);
  for (std::uint32_t id = 0; id < 40; ++id) crowd.say(id, 0.1 * id, 0);
  const RelayCounts counts = crowd.pass();
  EXPECT_EQ(counts.states, 39u);
  EXPECT_EQ(counts.datagrams, (39 + kMostNeighbours - 1) / kMostNeighbours);
}

/// One socket that claims five hundred ids, and a fleet of a thousand: what is sent is bounded, and all get alike.
TEST(RelayBounds, TheBudgetHoldsHoweverManyAsk) {
  for (const std::uint32_t count : {500u, 1000u}) {
    Crowd crowd(count, {});
    for (std::uint32_t id = 0; id < count; ++id) crowd.ask(id);
    for (std::uint32_t id = 0; id < count; ++id) crowd.say(id, 0.3 * (id % 32), 0.3 * (id / 32));
    const RelayCounts counts = crowd.pass();
    const std::size_t share = RelayOptions{}.budget / count;
    EXPECT_EQ(counts.states, count * share);
    EXPECT_LE(counts.datagrams, count * (share / kMostNeighbours + 1));
    EXPECT_EQ(counts.waited, 0u);
  }
}

TEST(RelayBounds, MoreThanTheBudgetServesTakeTurns) {
  Crowd crowd(30, {.budget = 10 * Relay::kLeastShare});
  for (std::uint32_t id = 0; id < 30; ++id) crowd.ask(id);
  for (int pass = 0; pass < 3; ++pass) {
    for (std::uint32_t id = 0; id < 30; ++id) crowd.say(id, id, 0);
    const RelayCounts counts = crowd.pass();
    EXPECT_EQ(counts.states, 40u);
    EXPECT_EQ(counts.waited, 20u) << pass;
  }
}

/// Beside all distances, sorted.
TEST(Nearby, FindsTheNearest) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-20.0, 20.0);
  std::vector<Nearby::Place> places;
  for (std::uint32_t row = 0; row < 300; ++row) places.push_back({{anywhere(random), anywhere(random)}, row});
  Nearby nearby(places.size());
  nearby.build(places);
  for (std::uint32_t own = 0; own < 300; own += 7)
    for (const std::size_t most : {1u, 5u, 400u}) {
      const base::Vec2 p = places[own].p;
      std::vector<Nearby::Place> all = places;
      std::erase_if(all, [&](const auto& q) { return q.row == own || base::length(q.p - p) > 8.0; });
      std::sort(all.begin(), all.end(),
                [&](const auto& a, const auto& b) { return base::length(a.p - p) < base::length(b.p - p); });
      all.resize(std::min(all.size(), most));
      std::vector<std::uint32_t> expected;
      for (const auto& q : all) expected.push_back(q.row);
      std::sort(expected.begin(), expected.end());
      const auto found = nearby.find(p, own, 8.0, most);
      EXPECT_EQ(std::vector<std::uint32_t>(found.begin(), found.end()), expected) << own << " of " << most;
    }
}

/// At one place nobody is nearer than others: each hears some, never itself, and not all the same ones.
TEST(Nearby, ACrowdAtOnePlace) {
  std::vector<Nearby::Place> places;
  for (std::uint32_t row = 0; row < 5000; ++row) places.push_back({{1.0, 2.0}, row});
  Nearby nearby(places.size());
  nearby.build(places);
  std::set<std::uint32_t> heard;
  for (std::uint32_t own = 0; own < 5000; own += 100) {
    const auto found = nearby.find(places[own].p, own, 5.0, 8);
    EXPECT_EQ(found.size(), 8u);
    EXPECT_EQ(std::count(found.begin(), found.end(), own), 0);
    heard.insert(found.begin(), found.end());
  }
  EXPECT_GT(heard.size(), 100u);
}

struct RadioTest : testing::Test {
  Outbox farm{OutboxOptions{.bind = {kLoopback, 0}}};
  Radio radio{{.farm = farm.endpoint(), .robot = 7, .others = {3, 9}}};
  Packet packet;
  Endpoint to() const { return {kLoopback, bound_endpoint(radio.socket()).port}; }
};

base::Bytes v2v_of(std::uint16_t robot, std::uint32_t sequence) {
  base::Bytes bytes;
  encode({.robot = robot, .sequence = sequence}, V2v{}, bytes);
  return bytes;
}

TEST_F(RadioTest, OnlyTheFarmsWordCounts) {
  Outbox stranger;
  stranger.queue(to(), v2v_of(3, 0));
  stranger.flush();
  farm.queue(to(), v2v_of(3, 0));
  farm.flush();
  int came = 0;
  radio.receive([&](std::span<const std::uint8_t> bytes) {
    ++came;
    EXPECT_EQ(radio.accept(bytes, 0, packet), Reason::accepted);
  });
  EXPECT_EQ(came, 1);
  EXPECT_EQ(radio.counts()[Reason::wrong_source], 1u);
}

TEST_F(RadioTest, JudgesWhatComes) {
  EXPECT_EQ(radio.accept(v2v_of(3, 5), 0, packet), Reason::accepted);
  EXPECT_EQ(radio.accept(v2v_of(3, 5), 0, packet), Reason::stale);
  EXPECT_EQ(radio.accept(v2v_of(7, 0), 0, packet), Reason::unknown_robot);  // itself
  EXPECT_EQ(radio.accept(v2v_of(8, 0), 0, packet), Reason::unknown_robot);
  EXPECT_EQ(radio.accept(start_example(), 0, packet), Reason::accepted);
  EXPECT_EQ(radio.accept(patched<std::uint16_t>(start_example(), 6, 7), 0, packet), Reason::accepted);
  EXPECT_EQ(radio.accept(patched<std::uint16_t>(start_example(), 6, 3), 0, packet), Reason::unknown_robot);
  EXPECT_EQ(radio.accept(reading_example(), 0, packet), Reason::wrong_direction);
  EXPECT_EQ(radio.accept(neighbours_example(), 0, packet), Reason::wrong_direction) << "receive() takes it apart";
  EXPECT_EQ(radio.accept(subscribe_example(), 0, packet), Reason::wrong_direction);
  EXPECT_EQ(radio.accept(base::Bytes(5), 0, packet), Reason::too_short);
  EXPECT_TRUE(radio.heard(3, 2 * kSecond - 1));
  EXPECT_FALSE(radio.heard(3, 2 * kSecond));
  EXPECT_FALSE(radio.heard(9, 0));
  EXPECT_EQ(radio.counts().total(), 11u);
}

}  // namespace
}  // namespace sf::netio
