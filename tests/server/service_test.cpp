#include "server/service.h"

#include "tests/server/fixture.h"

namespace sf::server {
namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Service, ARobotDrivesByItsReadings) {
  Fixture f;
  f.run(40);
  const RobotClientStats robot = f.client->stats();
  const ServiceStats service = f.service->stats();
  EXPECT_TRUE(robot.answered);
  EXPECT_GT(robot.distance_m, 0.05);
  EXPECT_EQ(robot.stops, 0u);
  EXPECT_EQ(service.ticks, 40u);
  EXPECT_GE(robot.link.whole.at("laser"), 38u) << "the first state is unproven";
  EXPECT_EQ(robot.link.whole.at("laser"), service.publisher.packets.sent);
  EXPECT_EQ(service.inbox.total(), robot.link.sent.sent);
  EXPECT_EQ(robot.link.sent.sent, 40u + 9u) << "a request every half second, and one immediately after the challenge";
  EXPECT_EQ(service.farm.readings, service.publisher.packets.sent) << "the other robot is not active: not computed";
  EXPECT_EQ(f.log.read_all(), "");
}

/// Boundary: every datagram is lost.
TEST(Service, ARobotWithoutALinkDoesNotMove) {
  Fixture f({.loss = 1.0});
  f.run(40);
  const RobotClientStats robot = f.client->stats();
  EXPECT_FALSE(robot.answered);
  EXPECT_EQ(robot.steps, 6u) << "the time before the first reading counts as silence from 0.5 s on";
  EXPECT_EQ(f.service->stats().inbox.total(), 0u);
  EXPECT_EQ(count_of(f.log.read_all(), "The robot stops until readings arrive"), 1u);
}

/// When a service stops, the robot does not drive on by its last scan. It stops after two and a half periods of its
/// sensor, and continues with the next scan.
TEST(Service, ARobotStopsWhileNoReadingArrives) {
  Fixture f({.sensor_rate = 4.0});
  f.run(10);
  f.run(20, false);
  const std::uint64_t steps = f.client->stats().steps;
  EXPECT_EQ(f.client->stats().stops, 1u);
  EXPECT_NE(f.log.read_all().find("for 0.625 s: robot1 stops until one arrives"), std::string::npos);
  f.run(10);
  EXPECT_GT(f.client->stats().steps, steps + 5);
  EXPECT_NE(f.log.read_all().find("readings arrive: robot1 continues"), std::string::npos);
  EXPECT_EQ(f.client->stats().stops, 1u) << "continuing does not count as a stop";
}

TEST(Service, AStartSignalReachesTheRobot) {
  Fixture f({.wait_for_start = true});
  f.run(10);
  EXPECT_FALSE(f.client->stats().started);
  EXPECT_EQ(f.client->stats().steps, 0u);
  netio::Outbox user;
  base::Bytes packet;
  netio::encode({.robot = 1}, netio::Start{}, packet);
  user.queue({netio::kLoopback, f.service->port()}, packet);
  user.flush();
  f.run(5);
  EXPECT_TRUE(f.client->stats().started);
  EXPECT_GT(f.client->stats().steps, 0u);
  EXPECT_EQ(f.service->stats().relayed.starts, 1u);
}

/// The robots are about 4 m apart.
TEST(Service, StatesAreRelayedWithinTheRadioRange) {
  for (const double radio : {3.0, 6.0}) {
    Fixture f({.radio = radio});
    const auto other = f.make_client(1);
    for (int i = 0; i < 5; ++i) {
      other->step(f.now);
      f.run(1);
      other->receive(f.now);
    }
    EXPECT_EQ(f.service->stats().relayed.states > 0, radio > 4.0) << radio;
    EXPECT_EQ(other->link().is_active(1, f.now), radio > 4.0) << radio;
  }
}

/// Boundary: sensors of 100 Hz at ticks of 10 Hz, without samples between them.
TEST(Service, MissedReadingsAreLoggedOnce) {
  Fixture f({.sensor_rate = 100.0});
  f.run(20);
  EXPECT_GT(f.service->stats().farm.missed, 20u);
  EXPECT_EQ(count_of(f.log.read_all(), "too slow for the sensors' rates"), 1u);
}

TEST(Service, SensorsDueBetweenTicksAreReadThere) {
  Fixture f({.sensor_rate = 50.0});
  f.run(10);
  const std::int64_t due = f.service->next_due();
  ASSERT_LT(due, f.now) << "the next tick";
  const std::uint64_t before = f.service->stats().farm.readings;
  f.service->sample(due);
  EXPECT_EQ(f.service->stats().farm.readings, before + 1);
  EXPECT_EQ(f.service->stats().ticks, 10u);
}

TEST(Service, StatesHaveAnAgeWithAndWithoutFilter) {
  for (const bool filtered : {false, true}) {
    Fixture f({.filter = {.mode = filtered ? FilterMode::on : FilterMode::automatic}});
    const auto no_state = [&](std::uint32_t row) {
      const netio::StateQuality q = f.service->receiver().quality(row, f.now);
      return q.stated && q.stale && q.age == base::kNoStateYet;
    };
    EXPECT_TRUE(no_state(0)) << "no reading yet";
    f.run(10);
    const auto quality = [&] { return f.service->receiver().quality(0, f.now - kTick); };
    EXPECT_TRUE(quality().stated);
    EXPECT_EQ(quality().age, 0);
    EXPECT_FALSE(quality().stale);
    EXPECT_EQ(quality().covariance[0] > 0.0f, filtered);
    EXPECT_TRUE(no_state(1)) << "the other robot is silent";
    for (int i = 0; i < 15; ++i, f.now += kTick) f.service->tick(f.now);
    EXPECT_TRUE(quality().stale);
    EXPECT_EQ(quality().age, 15 * kTick);
  }
}

netio::Peer peer_of(std::uint32_t robot, std::uint8_t key) {
  return {netio::PeerKind::robot, robot, std::nullopt, netio::SigningKey{key}};
}

/// Readings, challenges, states of each other and the start signal, in both directions.
TEST(Service, RobotsWithAndWithoutAKeyDriveTogether) {
  Fixture f({.wait_for_start = true, .peers = {peer_of(1, 7)}});
  const auto other = f.make_client(1);
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      other->step(f.now);
      f.run(1);
      other->receive(f.now);
    }
  };
  run(10);
  netio::Outbox user;
  base::Bytes packet;
  netio::encode({.robot = netio::kBroadcastId}, netio::Start{}, packet);
  user.queue({netio::kLoopback, f.service->port()}, packet);
  user.flush();
  run(30);
  for (const RobotClient* robot : {&*f.client, &*other}) {
    const RobotClientStats stats = robot->stats();
    EXPECT_TRUE(stats.started);
    EXPECT_GT(stats.distance_m, 0.05);
    EXPECT_GE(stats.link.whole.at("laser"), 38u) << stats.id;
    EXPECT_EQ(stats.link.readings.packets.dropped(), 0u) << packet_counts_text(stats.link.readings.packets);
    EXPECT_TRUE(robot->link().is_active(3 - stats.id, f.now)) << "each receives the other's states";
  }
  const netio::PacketCounts inbox = f.service->stats().inbox;
  EXPECT_EQ(inbox.dropped(), inbox[netio::PacketStatus::unproven]) << packet_counts_text(inbox);
}

/// A wandering robot steps when its scan arrives, and at 5 Hz without scans, so that the farm does not drop it.
TEST(Service, ARobotThatStepsOnScansIsDueWithEachScan) {
  constexpr std::int64_t kMilli = 1'000'000;
  Fixture f;
  EXPECT_TRUE(f.client->is_due(0)) << "the first step";
  f.run(5);
  f.client->step(f.now);
  EXPECT_FALSE(f.client->is_due(f.now + 199 * kMilli)) << "no scan";
  EXPECT_TRUE(f.client->is_due(f.now + 200 * kMilli)) << "half its rate";
  f.service->tick(f.now);
  f.client->receive(f.now + kMilli);
  EXPECT_TRUE(f.client->is_due(f.now + kMilli)) << "a scan has arrived";
  f.client->step(f.now + kMilli);
  EXPECT_FALSE(f.client->is_due(f.now + kMilli)) << "one step per scan";
}

/// Boundary: no key, another key, and a key unknown to the farm.
TEST(Service, ARobotIsServedOnlyWithItsKey) {
  using netio::PacketStatus;
  for (const std::optional<std::uint8_t> key : {std::optional<std::uint8_t>{}, std::optional<std::uint8_t>{8}}) {
    Fixture f({.peers = {peer_of(1, 7)}});
    f.client.reset();
    f.client = f.make_client(0, key ? std::optional(netio::SigningKey{*key}) : std::nullopt);
    f.run(10);
    EXPECT_FALSE(f.client->stats().answered);
    const netio::PacketCounts inbox = f.service->stats().inbox;
    EXPECT_GE(inbox[key ? PacketStatus::wrong_signature : PacketStatus::not_signed], 10u) << packet_counts_text(inbox);
    EXPECT_EQ(inbox.dropped(), inbox.total());
    EXPECT_EQ(f.service->stats().answers.queued, 2u) << "REFUSAL twice a second, and no challenge";
  }
  Fixture f;
  f.client.reset();
  f.client = f.make_client(0, netio::SigningKey{7});
  f.run(10);
  EXPECT_FALSE(f.client->stats().answered) << "the farm does not sign";
  EXPECT_GE(f.client->stats().link.packets[PacketStatus::not_signed], 10u);
}

TEST(Service, ARobotAtAnotherAddressIsRefusedAndLoggedOnce) {
  Fixture f({.peers = {{netio::PeerKind::robot, 1, netio::kLoopback + 1, std::nullopt}}});
  f.run(10);
  EXPECT_FALSE(f.client->stats().answered);
  EXPECT_EQ(f.service->stats().inbox.dropped(), f.service->stats().inbox[netio::PacketStatus::wrong_source]);
  EXPECT_EQ(count_of(f.log.read_all(), "robot1 (id 1) is at 127.0.0.2 in the table of peers"), 1u);
}

/// Sends states of robot 2, in any order of sequence.
struct Speaker {
  explicit Speaker(Fixture& fixture) : f(fixture), outbox(netio::open_udp({netio::kLoopback, 0})) {}
  void send(std::uint32_t sequence) {
    base::Bytes packet;
    netio::encode({.robot = 2, .sequence = sequence, .time = f.now}, netio::V2v{}, packet);
    const std::uint32_t token = f.service->receiver().inbox().token(outbox.endpoint());
    outbox.queue({netio::kLoopback, f.service->port()}, packet, {1, token});
    outbox.flush();
  }
  Fixture& f;
  netio::Outbox outbox;
};

TEST(Service, OvertakenStatesAreAcceptedUnlessTheirArrivalCounts) {
  using estimation::ClockSource;
  for (const ClockSource source : {ClockSource::estimated, ClockSource::trusted, ClockSource::arrival}) {
    Fixture f({.filter = {.mode = FilterMode::on, .clock = {.source = source}}});
    Speaker robot(f);
    for (const std::uint32_t sequence : {5u, 4u}) robot.send(sequence);
    f.service->receive_pending(0);
    const netio::PacketCounts inbox = f.service->stats().inbox;
    EXPECT_EQ(inbox.total(), 2u);
    EXPECT_EQ(inbox[netio::PacketStatus::stale], source == ClockSource::arrival ? 1u : 0u);
  }
}

/// Readings are held for 40 samples; each has the age of the state at its own sample.
TEST(Service, ReadingsWithALongLatencyHaveAnAge) {
  Fixture f({.latency = 4.0});
  const netio::Socket port = netio::open_udp({netio::kLoopback, f.reading_port(2)});
  Speaker robot(f);
  for (std::uint32_t tick = 0; tick < 45; ++tick, f.now += kTick) {
    if (tick % 2 == 0) robot.send(tick);
    f.service->tick(f.now);
  }
  std::vector<std::int64_t> ages;
  netio::ReceiveBatch batch(64);
  batch.drain(port, 64, [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) {
    netio::Packet packet;
    EXPECT_EQ(netio::decode(bytes, packet), netio::PacketStatus::accepted);
    EXPECT_TRUE(packet.header.state.stated);
    ages.push_back(packet.header.state.age);
  });
  EXPECT_EQ(ages, (std::vector<std::int64_t>{1000, kTick, 1000, kTick, 1000})) << "0 is sent as 1 us";
}

TEST(Service, ARobotDrivesByReadingsOfItsFilteredState) {
  Fixture f({.filter = {.mode = FilterMode::on}});
  f.run(40);
  EXPECT_GT(f.client->stats().distance_m, 0.05);
  const ServiceStats stats = f.service->stats();
  EXPECT_TRUE(stats.filtered);
  EXPECT_EQ(stats.states.states[static_cast<std::size_t>(estimation::Verdict::started)], 1u);
  EXPECT_GE(stats.states.states[static_cast<std::size_t>(estimation::Verdict::used)], 37u);
  ASSERT_EQ(stats.clocks.size(), 1u);
  EXPECT_EQ(stats.clocks[0].clock.offset, 0) << "both have the test's clock";
}

TEST(Service, AStaleRobotIsRemovedFromTheWorldIfConfigured) {
  for (const auto policy : {estimation::StalePolicy::freeze, estimation::StalePolicy::hide}) {
    Fixture f({.filter = {.mode = FilterMode::on, .policy = policy}});
    f.run(10);
    EXPECT_FALSE(f.service->receiver().update_absent(1, f.now));
    for (int i = 0; i < 15; ++i, f.now += kTick) f.service->tick(f.now);
    EXPECT_EQ(f.service->receiver().update_absent(1, f.now), policy == estimation::StalePolicy::hide);
    f.run(1);
    EXPECT_FALSE(f.service->receiver().update_absent(1, f.now)) << "it is measured again";
  }
}

/// After 10 s, to a tick; its last state arrived at 0.9 s.
TEST(Service, ASilentRobotIsDroppedAfterItsTimeout) {
  Fixture f({.filter = {.policy = estimation::StalePolicy::freeze}});
  f.run(10);
  const auto absent_after = [&](int ticks) {
    for (int i = 0; i < ticks; ++i, f.now += kTick) f.service->tick(f.now);
    return f.service->receiver().update_absent(1, f.now);
  };
  EXPECT_FALSE(absent_after(97));
  EXPECT_TRUE(absent_after(2));
  EXPECT_FALSE(f.service->receiver().update_absent(2, f.now)) << "it never spoke";
  f.client->step(f.now);
  f.service->receive_pending(f.now);
  EXPECT_FALSE(f.service->receiver().update_absent(1, f.now)) << "it speaks again";
}

/// Stores its newest tick; can simulate a full disk.
struct TestSink : base::Sink {
  bool full = false;
  std::vector<std::int64_t> times;
  std::vector<base::Report> reports;
  std::vector<base::StateQuality> qualities;
  std::size_t readings = 0;
  void write(const base::TickRecord& record) override {
    if (full) throw base::InputError("run.mcap", 0, "no space left");
    times.push_back(record.time);
    reports.assign(record.reports.begin(), record.reports.end());
    qualities.assign(record.qualities.begin(), record.qualities.end());
    for (const base::ReadingBlock& reading : record.readings) {
      ++readings;
      EXPECT_TRUE(reading.state.stated);
      EXPECT_EQ(reading.state.age, qualities[reading.mover].age);
    }
  }
};

TEST(Service, ASinkReceivesStatesTheirQualityAndReadings) {
  Fixture f({.filter = {.mode = FilterMode::on, .policy = estimation::StalePolicy::hide}});
  TestSink sink;
  f.service->record_to(sink);
  f.run(10);
  ASSERT_EQ(sink.times.size(), 10u);
  EXPECT_EQ(sink.times.back(), f.now - kTick);
  EXPECT_GE(sink.readings, 8u);
  ASSERT_EQ(sink.reports.size(), 2u);
  ASSERT_EQ(sink.qualities.size(), 2u);
  EXPECT_TRUE(sink.qualities[0].stated);
  EXPECT_GT(sink.qualities[0].covariance[0], 0.0f);
  EXPECT_EQ(sink.qualities[1].age, base::kNoStateYet) << "the other robot is silent";
  EXPECT_TRUE(base::is_absent(sink.reports[1].X_WM)) << "it is out of the world";
  for (int i = 0; i < 15; ++i, f.now += kTick) f.service->tick(f.now);
  EXPECT_TRUE(sink.qualities[0].stale);
  EXPECT_TRUE(base::is_absent(sink.reports[0].X_WM)) << "out of the world";
}

/// Readings have the age of their state; fresh ones arrive within a second of the end of the pause.
TEST(Service, APauseOfFiveSecondsIsReportedAndEndsImmediately) {
  for (const bool filtered : {false, true}) {
    for (const bool farm_pauses : {false, true}) {
      Fixture f({.filter = {.mode = filtered ? FilterMode::on : FilterMode::automatic}});
      TestSink sink;
      f.service->record_to(sink);
      f.run(10);
      const std::int64_t last = f.now - kTick;
      for (int i = 0; i < 50; ++i, f.now += kTick) {
        if (farm_pauses) continue;
        f.service->tick(f.now);
        EXPECT_EQ(sink.qualities[0].age, f.now - last);
        EXPECT_EQ(sink.qualities[0].stale, f.now - last > kSecond) << i;
      }
      if (farm_pauses) {
        f.service->tick(f.now);
        EXPECT_TRUE(sink.qualities[0].stale) << "no packet was sent meanwhile either";
        EXPECT_EQ(sink.qualities[0].age, 50 * kTick + kTick);
        f.now += kTick;
      }
      const std::size_t before = sink.readings;
      f.run(10);
      EXPECT_FALSE(sink.qualities[0].stale) << filtered;
      EXPECT_LE(sink.qualities[0].age, kTick);
      EXPECT_GE(sink.readings, before + 5);
    }
  }
}

TEST(Service, AFullDiskEndsOnlyTheRecording) {
  Fixture f;
  TestSink sink;
  f.service->record_to(sink);
  f.run(5);
  sink.full = true;
  f.run(5);
  sink.full = false;
  f.run(5);
  EXPECT_EQ(sink.times.size(), 5u);
  EXPECT_EQ(count_of(f.log.read_all(), "recording ends here: run.mcap"), 1u);
  EXPECT_GE(f.client->stats().link.whole.at("laser"), 13u);
}

TEST(Service, RunEndsByItsDurationAndByAStop) {
  Fixture f;
  std::atomic<bool> stop = false;
  f.service->run(stop, 0.25);
  EXPECT_GE(f.service->stats().wall_s, 0.25);
  EXPECT_GE(f.service->stats().ticks, 1u);
  stop = true;
  const std::uint64_t ticks = f.service->stats().ticks;
  f.service->run(stop, 0.0);
  EXPECT_EQ(f.service->stats().ticks, ticks);
  f.client->run(stop, 0.0);
  EXPECT_EQ(f.client->stats().steps, 0u);
}

TEST(Service, APortInUseIsRejected) {
  Fixture f;
  ServiceOptions options;
  options.receiver.bind = {netio::kLoopback, f.service->port()};
  EXPECT_THROW(Service(f.world, f.sensor_set, Fixture::device(), f.layout, options), netio::PortInUse);
}

}  // namespace
}  // namespace sf::server
