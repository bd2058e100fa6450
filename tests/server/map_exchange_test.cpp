// Exchanges of maps, joined by a link that loses, repeats and reorders packets, on the test's own clock.

#include "server/map_exchange.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <random>

namespace sf::server {
namespace {

constexpr std::int64_t kStep = 100'000'000;  ///< [ns]
constexpr maps::GridGeometry kExchanged{.left = -1.8, .top = 1.8};

/// A robot that maps: its map, and its exchange.
struct Mapper {
  std::uint32_t id = 0, session = 0;
  std::shared_ptr<control::SharedMap> map = std::make_shared<control::SharedMap>();
  MapExchange exchange;
  std::uint32_t sequence = 0;

  explicit Mapper(std::uint32_t id_, std::uint32_t session_ = 1, const maps::GridGeometry& geometry = kExchanged,
                  std::size_t most_bytes = 8u << 20)
      : id(id_), session(session_), exchange({.robot = id_, .session = session_, .most_bytes = most_bytes}) {
    map->geometry = geometry;
    publish();
  }
  void publish() { exchange.publish(std::make_shared<const control::SharedMap>(*map)); }
  /// Adds `points` points, different for each robot and session.
  void measure(std::size_t points) {
    control::MapChanges changes;
    for (std::size_t i = 0; i < points; ++i)
      changes.points.emplace_back(
          id, static_cast<double>(1000 * session + map->changes.size()) + 1e-4 * static_cast<double>(i));
    changes.cells.push_back({{static_cast<std::int64_t>(id), 5}, maps::Cell::free});
    map->changes.push_back(std::make_shared<const control::MapChanges>(changes));
    publish();
  }
  void claim(std::vector<std::int64_t> keys) {
    map->claim = std::move(keys);
    publish();
  }
};

/// A packet on its way, as bytes.
struct OnItsWay {
  std::int64_t arrival = 0;
  std::uint32_t to = 0;
  base::Bytes bytes;
};

/// A link between all robots of a team.
struct Link {
  double loss = 0.0, copies = 0.0;
  int most_delay = 0;  ///< steps; packets overtake each other
  std::mt19937 random{1};
  std::vector<std::unique_ptr<Mapper>> robots;
  std::vector<OnItsWay> packets;
  std::int64_t now = 0;

  Mapper& add(std::uint32_t id, std::uint32_t session = 1) {
    return *robots.emplace_back(std::make_unique<Mapper>(id, session));
  }
  double chance() { return std::uniform_real_distribution<>(0.0, 1.0)(random); }
  void send(Mapper& from, const netio::TeamMap& map) {
    base::Bytes bytes;
    netio::encode({.robot = static_cast<std::uint16_t>(from.id), .sequence = from.sequence++, .session = from.session},
                  map, bytes);
    for (const auto& to : robots)
      for (int copy = 0; to->id != from.id && copy < (chance() < copies ? 2 : 1); ++copy)
        if (chance() >= loss)
          packets.push_back({now + kStep * std::uniform_int_distribution<>(0, most_delay)(random), to->id, bytes});
  }
  void deliver() {
    const auto is_due = [&](const OnItsWay& packet) { return packet.arrival <= now; };
    for (const OnItsWay& packet : packets) {
      netio::Packet decoded;
      if (!is_due(packet)) continue;
      ASSERT_EQ(netio::decode(packet.bytes, decoded), netio::PacketStatus::accepted);
      for (const auto& to : robots)
        if (to->id == packet.to) to->exchange.receive(decoded.header, std::get<netio::TeamMap>(decoded.body), now);
    }
    std::erase_if(packets, is_due);
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i, now += kStep) {
      deliver();
      for (const auto& robot : robots) robot->exchange.send(now, [&](const netio::TeamMap& map) { send(*robot, map); });
    }
  }
};

std::shared_ptr<const control::SharedMap> map_at(Mapper& robot, std::uint32_t of, std::int64_t now) {
  for (const control::TeammateMap& teammate : robot.exchange.teammates(now))
    if (teammate.id == of) return teammate.map;
  return nullptr;
}

/// Returns whether the list of changes that `robot` has of `other` is that of `other`.
bool has_all(Mapper& robot, const Mapper& other, std::int64_t now) {
  const auto map = map_at(robot, other.id, now);
  return map && std::ranges::equal(map->changes, other.map->changes, [](const auto& a, const auto& b) {
           return a->points == b->points && a->cells.size() == b->cells.size() && a->nodes == b->nodes;
         });
}

bool all_have_all(Link& link) {
  return std::ranges::all_of(link.robots, [&](const auto& robot) {
    return std::ranges::all_of(link.robots,
                               [&](const auto& other) { return robot == other || has_all(*robot, *other, link.now); });
  });
}

/// Two or three robots that measure for some seconds. What they send is bounded.
TEST(MapExchange, AnyLinkDeliversAllChangesInOrder) {
  EXPECT_TRUE(rc::check([] {
    Link link{.loss = 0.01 * *rc::gen::inRange(0, 40), .copies = 0.2, .most_delay = *rc::gen::inRange(0, 4)};
    link.random.seed(*rc::gen::arbitrary<std::uint32_t>());
    for (std::uint32_t id = 1; id <= *rc::gen::element(2u, 3u); ++id) link.add(id);
    for (int i = 0; i < 5; ++i) {
      for (const auto& robot : link.robots) robot->measure(static_cast<std::size_t>(*rc::gen::inRange(0, 300)));
      link.run(10);
    }
    int steps = 50;
    for (; !all_have_all(link); ++steps) {
      RC_ASSERT(steps < 3000);
      link.run(1);
    }
    for (const auto& robot : link.robots)
      RC_ASSERT(static_cast<double>(robot->exchange.counts().sent) <=
                MapExchange::kBurst + 1e-9 * static_cast<double>(link.now) * MapExchange::kRate);
    link.run(100);  // acknowledgements have arrived: nothing but beats remains
    const std::uint64_t before = link.robots[0]->exchange.counts().pieces;
    if (link.loss == 0.0) link.run(50);
    RC_ASSERT(link.robots[0]->exchange.counts().pieces == before || link.loss > 0.0);
  }));
}

TEST(MapExchange, WithoutLossEachPieceIsSentOnce) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(2);
  link.run(2);
  for (int i = 0; i < 10; ++i) a.measure(150), link.run(10);
  EXPECT_TRUE(has_all(b, a, link.now));
  EXPECT_EQ(a.exchange.counts().pieces, 30u) << "three for each 2.4 KB";
  EXPECT_EQ(a.exchange.counts().repeated, 0u);
  EXPECT_EQ(b.exchange.counts().changes, 10u);
}

TEST(MapExchange, OfALossyLinkLittleMoreThanTheLossIsRepeated) {
  Link link{.loss = 0.1};
  Mapper &a = link.add(1), &b = link.add(2);
  link.run(2);
  a.measure(20'000);
  for (int i = 0; i < 110 && !has_all(b, a, link.now); ++i) link.run(1);
  EXPECT_TRUE(has_all(b, a, link.now));
  EXPECT_GT(a.exchange.counts().repeated, 0u);
  EXPECT_LT(a.exchange.counts().repeated, 70u) << "of 321 pieces";
}

TEST(MapExchange, AloneARobotSendsBeatsOnly) {
  Link link;
  Mapper& a = link.add(1);
  a.measure(1000);
  link.run(100);
  EXPECT_TRUE(a.exchange.is_complete(link.now));
  EXPECT_EQ(a.exchange.counts().sent, 20u);
  EXPECT_EQ(a.exchange.counts().pieces, 0u);
}

TEST(MapExchange, AnotherRobotThatJoinsLaterGetsEverything) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(2);
  for (int i = 0; i < 5; ++i) a.measure(500), link.run(20);
  ASSERT_TRUE(has_all(b, a, link.now));
  Mapper& c = link.add(3);
  link.run(60);
  EXPECT_TRUE(has_all(c, a, link.now));
  EXPECT_TRUE(has_all(b, a, link.now));
  EXPECT_EQ(b.exchange.counts().changes, 5u) << "repeated pieces change nothing";
}

TEST(MapExchange, ARobotThatJoinsDoesNotHoldUpTheOthers) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(3);
  for (int i = 0; i < 5; ++i) a.measure(4000), link.run(20);
  ASSERT_TRUE(has_all(b, a, link.now));
  Mapper& c = link.add(2);
  link.run(5);
  a.measure(50);
  link.run(5);
  EXPECT_TRUE(has_all(b, a, link.now));
  EXPECT_FALSE(has_all(c, a, link.now)) << "it still lacks most of 321 pieces";
  EXPECT_FALSE(a.exchange.is_complete(link.now));
  link.run(80);
  EXPECT_TRUE(a.exchange.is_complete(link.now));
  EXPECT_TRUE(has_all(c, a, link.now));
}

/// In both directions; and packets of the process before are late.
TEST(MapExchange, ARestartedRobotStartsOver) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(2);
  a.measure(500), b.measure(500);
  b.claim({1, 2});
  link.run(30);
  ASSERT_TRUE(all_have_all(link));
  link.robots.pop_back();
  Mapper& again = link.add(2, 2);
  again.measure(20);
  link.run(10);
  EXPECT_TRUE(all_have_all(link));
  EXPECT_EQ(map_at(a, 2, link.now)->changes.size(), 1u);
  EXPECT_TRUE(map_at(a, 2, link.now)->claim.empty());
  netio::TeamMap late{.left = -1.8, .top = 1.8, .cell = 0.03, .word_columns = 30, .word_rows = 30};
  late.states_claim = true;
  a.exchange.receive({.robot = 2, .sequence = 1000, .session = 1}, late, link.now);
  EXPECT_TRUE(has_all(a, again, link.now));
  link.run(20);
  a.exchange.receive({.robot = 2, .sequence = 1000, .session = 1}, late, link.now);
  EXPECT_FALSE(has_all(a, again, link.now)) << "taken for another start after two seconds";
  link.run(50);
  EXPECT_TRUE(has_all(a, again, link.now)) << "all is sent again, as it acknowledges nothing";
}

/// Claims are sent at once, overtaken ones are ignored, and silence releases them. Measurements remain.
TEST(MapExchange, TheLastClaimCounts) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(2);
  a.measure(10);
  link.run(3);
  a.claim({7, 8, 9, 500, 14'399});
  link.run(2);
  ASSERT_TRUE(map_at(b, 1, link.now));
  EXPECT_EQ(map_at(b, 1, link.now)->claim, a.map->claim);
  a.claim({});
  link.run(2);
  EXPECT_TRUE(map_at(b, 1, link.now)->claim.empty());
  netio::TeamMap old{.left = -1.8, .top = 1.8, .cell = 0.03, .word_columns = 30, .word_rows = 30};
  base::Bytes runs;
  netio::put(netio::ClaimRun{3, 1}, runs);
  old.states_claim = true, old.claim = runs;
  b.exchange.receive({.robot = 1, .sequence = 0, .session = 1}, old, link.now);
  EXPECT_TRUE(map_at(b, 1, link.now)->claim.empty());
  const std::int64_t silent = link.now;
  link.robots.erase(link.robots.begin());
  EXPECT_TRUE(map_at(b, 1, silent + 1'800'000'000));
  EXPECT_FALSE(map_at(b, 1, silent + 2'000'000'000));
  b.exchange.receive({.robot = 1, .sequence = 900, .session = 1}, old, silent + 9'000'000'000);
  EXPECT_EQ(map_at(b, 1, silent + 9'000'000'000)->changes.size(), 1u) << "it is back";
}

TEST(MapExchange, AClaimOfTooManyRunsIsCut) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(2);
  std::vector<std::int64_t> keys;
  for (std::int64_t key = 1; key < 2 * 300; key += 2) keys.push_back(key);
  a.claim(keys);
  link.run(2);
  keys.resize(MapExchange::kMaxRuns);
  EXPECT_EQ(map_at(b, 1, link.now)->claim, keys);
  EXPECT_EQ(a.exchange.counts().cut, 1u);
  keys.clear();
  for (std::int64_t key = 0; key < 14'400; ++key) keys.push_back(key);
  a.claim(keys);
  link.run(2);
  EXPECT_EQ(map_at(b, 1, link.now)->claim, keys) << "one run";
  EXPECT_EQ(a.exchange.counts().cut, 1u);
}

TEST(MapExchange, AMapOfAnotherAreaIsIgnored) {
  Link link;
  Mapper& a = link.add(1);
  maps::GridGeometry other = kExchanged;
  other.left += 0.01;
  Mapper& b = *link.robots.emplace_back(std::make_unique<Mapper>(2, 1, other));
  b.measure(100);
  link.run(30);
  EXPECT_TRUE(a.exchange.teammates(link.now).empty());
  EXPECT_EQ(a.exchange.counts().foreign, a.exchange.counts().received);
  EXPECT_GT(a.exchange.counts().foreign, 0u);
  EXPECT_EQ(a.exchange.counts().last_foreign, 2u);
  EXPECT_EQ(b.exchange.counts().pieces, 0u) << "it has no teammates";
}

/// A robot that accepts no more does not hold up the others.
TEST(MapExchange, MeasurementsOfARobotAreBounded) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(2);
  Mapper& small = *link.robots.emplace_back(std::make_unique<Mapper>(3, 1, kExchanged, 3000));
  for (int i = 0; i < 10; ++i) a.measure(50), link.run(10);
  EXPECT_EQ(small.exchange.counts().full, 1u);
  EXPECT_EQ(small.exchange.counts().changes, 3u);
  EXPECT_TRUE(has_all(b, a, link.now));
  const std::uint64_t pieces = a.exchange.counts().pieces;
  link.run(100);
  EXPECT_EQ(a.exchange.counts().pieces, pieces);
}

/// Robot 3 hears nothing, and is heard: it must not hold up robot 2 for longer than the patience, nor cost more than
/// two packets a second then.
TEST(MapExchange, ADeafRobotIsServedLast) {
  Link link;
  Mapper &a = link.add(1), &b = link.add(2);
  Mapper deaf(3);
  const auto run = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      link.run(1);
      deaf.exchange.send(link.now, [&](const netio::TeamMap& map) { link.send(deaf, map); });
    }
  };
  run(10);
  a.measure(5000);
  run(100);
  EXPECT_TRUE(has_all(b, a, link.now));
  const std::uint64_t pieces = a.exchange.counts().pieces;
  run(100);
  EXPECT_LE(a.exchange.counts().pieces, pieces + 20);
  a.measure(100);
  run(10);
  EXPECT_TRUE(has_all(b, a, link.now));
}

TEST(MapExchange, MalformedMeasurementsAreDroppedAndTheNextOnesCount) {
  Mapper a(1);
  const base::Bytes bad{1, 2, 0, 0}, good{1, 0, 0, 0};
  netio::TeamMap map{.left = -1.8, .top = 1.8, .cell = 0.03, .word_columns = 30, .word_rows = 30};
  map.ends = true;
  std::uint32_t sequence = 0;
  for (const base::Bytes& bytes : {bad, good}) {
    map.bytes = bytes;
    a.exchange.receive({.robot = 2, .sequence = sequence++, .session = 1}, map, 0);
    ++map.piece;
  }
  EXPECT_EQ(a.exchange.counts().malformed, 1u);
  EXPECT_EQ(map_at(a, 2, 0)->changes.size(), 1u);
}

/// With 40 robots, acknowledgements take turns.
TEST(MapExchange, ManyRobotsAreAllAcknowledged) {
  Link link;
  for (std::uint32_t id = 1; id <= 40; ++id) link.add(id).measure(10);
  link.run(100);
  EXPECT_TRUE(all_have_all(link));
  std::uint64_t repeated = 0;
  for (const auto& robot : link.robots) repeated += robot->exchange.counts().repeated;
  const std::uint64_t before = link.robots[0]->exchange.counts().pieces;
  link.run(50);
  EXPECT_EQ(link.robots[0]->exchange.counts().pieces, before) << repeated;
}

}  // namespace
}  // namespace sf::server
