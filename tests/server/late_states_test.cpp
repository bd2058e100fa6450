// The receiver of `serve` by default: late states are filtered, and stale or unknown robots leave the world.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "base/time.h"
#include "server/state_receiver.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::server {
namespace {

using estimation::StalePolicy;

/// A robot on a circle of 1 m at 0.4 m/s, which sends its state ten times a second.
struct LateSender {
  std::int64_t least = 0, jitter = 0;               ///< [ns] delay, evenly distributed
  std::function<std::int64_t(std::int64_t)> stamp;  ///< of a time
  base::Pose pose(std::int64_t time) const {
    const double angle = 0.4e-9 * static_cast<double>(time);
    return {std::sin(angle), 1.0 - std::cos(angle), 0.0, std::remainder(angle, 2.0 * M_PI)};
  }
};

struct LateReceiver {
  explicit LateReceiver(const StateFilterOptions& filter = {}, double forget = 10.0)
      : world(make_world()),
        receiver(world, {.bind = {netio::kLoopback, 0}, .forget = forget, .log_descriptor = -1, .filter = filter}),
        outbox(netio::open_udp({netio::kLoopback, 0})) {}
  static world::World make_world() {
    world::World world = scenes::boxed_world(20.0, 20.0, {-10.0, -10.0});
    for (int k = 0; k < 2; ++k) scenes::add_mover(world, {5.0 + k, 5.0, 0, 0}, scenes::rectangle({0.0, 0.0}, 0.3, 0.3));
    return world;
  }
  void send(const base::Pose& pose, std::int64_t stamp, std::uint32_t sequence) {
    netio::V2v state;
    state.X_WR = pose;
    state.velocity = {0.4, 0.0, 0.4};
    send({.robot = 1, .sequence = sequence, .time = stamp}, state);
  }
  template <class Body>
  void send(const netio::Header& header, const Body& body) {
    netio::encode(header, body, packet);
    outbox.queue({netio::kLoopback, receiver.inbox().port()}, packet, {1, receiver.inbox().token(outbox.endpoint())});
    outbox.flush();
  }
  /// Runs for some seconds, with predictions at 50 Hz. @return the predicted poses
  std::vector<base::Pose> drive(const LateSender& sender, std::int64_t until) {
    std::mt19937 random(7);
    std::multimap<std::int64_t, std::int64_t> on_the_way;  // times of sending by time of arrival
    std::vector<base::Pose> poses;
    for (; now < until; now += 20 * kMs) {
      if (now % (100 * kMs) == 0)
        on_the_way.emplace(now + sender.least + sender.jitter * static_cast<std::int64_t>(random() % 1000) / 1000, now);
      for (; !on_the_way.empty() && on_the_way.begin()->first <= now; on_the_way.erase(on_the_way.begin())) {
        const auto [arrival, sent] = *on_the_way.begin();
        send(sender.pose(sent), sender.stamp ? sender.stamp(sent) : sent,
             static_cast<std::uint32_t>(sent / (100 * kMs)));
        receiver.receive_pending(arrival);
      }
      receiver.predict(now);
      receiver.update_absent(1, now);
      poses.push_back(receiver.states(now)[0].X_WM);
    }
    return poses;
  }
  double rms(const LateSender& sender, std::int64_t until) {
    const std::vector<base::Pose> poses = drive(sender, until);
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t k = poses.size() / 4; k < poses.size(); ++k, ++count) {
      const base::Pose truth = sender.pose(static_cast<std::int64_t>(k) * 20 * kMs);
      sum += std::pow(poses[k].x - truth.x, 2) + std::pow(poses[k].y - truth.y, 2);
    }
    return std::sqrt(sum / static_cast<double>(count));
  }

  world::World world;
  StateReceiver receiver;
  netio::Outbox outbox;
  base::Bytes packet;
  std::int64_t now = 0;
};

StateFilterOptions in_mode(FilterMode mode, StalePolicy policy = StalePolicy::hide) {
  StateFilterOptions options;
  options.mode = mode;
  options.policy = policy;
  return options;
}

/// Between states a robot keeps its tilt, also where its pose is filtered; a state of the short form makes it level.
TEST(LateStates, TiltIsKeptBetweenStates) {
  for (const FilterMode mode : {FilterMode::off, FilterMode::on}) {
    LateReceiver f({.mode = mode});
    const auto tilt_after = [&](std::uint32_t sequence, const base::Tilt& tilt) {
      const std::int64_t sent = sequence * 100 * kMs;
      f.send({.robot = 1, .sequence = sequence, .time = sent}, netio::V2v{.X_WR = {1, 2, 0.5, 0}, .tilt = tilt});
      f.receiver.receive_pending(sent);
      f.receiver.predict(sent + 50 * kMs);
      return f.receiver.states(sent + 50 * kMs)[0].tilt;
    };
    EXPECT_EQ(tilt_after(1, {0.1, -0.2}).roll, 0.1);
    EXPECT_EQ(tilt_after(2, {0.2, -0.2}).roll, 0.2);
    EXPECT_EQ(tilt_after(3, {0.2, -0.25}).pitch, -0.25);
    EXPECT_EQ(tilt_after(4, {}).pitch, 0.0);
  }
}

/// 0.1 to 0.4 s of delay. The clock of the second robot has another epoch, so its least delay is unknown.
TEST(LateStates, AreFilteredByDefault) {
  for (const std::int64_t offset : {std::int64_t{0}, 3600 * base::kSecond}) {
    const LateSender sender{100 * kMs, 300 * kMs, [=](std::int64_t time) { return time + offset; }};
    LateReceiver raw(in_mode(FilterMode::off)), automatic;
    const double unfiltered = raw.rms(sender, 20 * base::kSecond), filtered = automatic.rms(sender, 20 * base::kSecond);
    EXPECT_GT(unfiltered, 0.08);
    EXPECT_LT(filtered, offset == 0 ? 0.015 : 0.045) << "0.1 s at 0.4 m/s";
    EXPECT_TRUE(automatic.receiver.filter().is_filtered(0));
  }
}

/// Bitwise the states without a filter: the delay of the first three is constant, and timestamps of the others are not
/// times of a clock.
TEST(LateStates, OtherSendersAreNotFiltered) {
  const std::vector<LateSender> senders{
      {5 * kMs, 2 * kMs, {}},                                                        // a wired network
      {300 * kMs, 2 * kMs, {}},                                                      // far away
      {5 * kMs, 40 * kMs, [](std::int64_t t) { return t + 3600 * base::kSecond; }},  // a wireless network
      {5 * kMs, 2 * kMs, [](std::int64_t) { return std::int64_t{0}; }},              // no timestamps
      {100 * kMs, 300 * kMs, [](std::int64_t) { return std::int64_t{0}; }},          // the same, late
      {100 * kMs, 300 * kMs, [](std::int64_t t) { return t / 1'000'000; }},          // milliseconds
      {5 * kMs, 2 * kMs, [](std::int64_t t) { return t / 2; }},                      // time of a slow simulation
      {5 * kMs, 2 * kMs, [](std::int64_t t) { return 2 * t; }},                      // and of a fast one
      {5 * kMs, 2 * kMs,
       [](std::int64_t t) { return t < 5 * base::kSecond ? t : t + base::kSecond; }}  // a clock that is set
  };
  for (const LateSender& sender : senders) {
    LateReceiver raw(in_mode(FilterMode::off)), automatic;
    const auto expected = raw.drive(sender, 15 * base::kSecond), got = automatic.drive(sender, 15 * base::kSecond);
    const std::size_t which = static_cast<std::size_t>(&sender - senders.data());
    EXPECT_FALSE(automatic.receiver.filter().is_filtered(0)) << which;
    EXPECT_FALSE(automatic.receiver.filter().used()) << which;
    for (std::size_t k = 0; k < got.size(); ++k) {
      ASSERT_EQ(got[k].x, expected[k].x) << which << ' ' << k;
      ASSERT_EQ(got[k].yaw, expected[k].yaw) << which << ' ' << k;
    }
    EXPECT_EQ(automatic.receiver.inbox().counts()[netio::PacketStatus::stale],
              raw.receiver.inbox().counts()[netio::PacketStatus::stale]);
  }
}

/// Ten seconds after its last late state.
TEST(LateStates, ASenderThatIsPunctualAgainIsNotFiltered) {
  LateReceiver bench;
  LateSender sender{100 * kMs, 300 * kMs, {}};
  bench.drive(sender, 10 * base::kSecond);
  EXPECT_TRUE(bench.receiver.filter().is_filtered(0));
  sender.jitter = 0;
  bench.drive(sender, 20 * base::kSecond);
  EXPECT_TRUE(bench.receiver.filter().is_filtered(0));
  bench.drive(sender, 23 * base::kSecond);
  EXPECT_FALSE(bench.receiver.filter().is_filtered(0));
  EXPECT_LT(bench.receiver.quality(0, bench.now).age, 200 * kMs) << "counted from its arrival";
}

/// A second after its last state, whatever the filter.
TEST(LateStates, AStaleRobotLeavesTheWorld) {
  for (const FilterMode mode : {FilterMode::off, FilterMode::automatic, FilterMode::on})
    for (const StalePolicy policy : {StalePolicy::freeze, StalePolicy::hide, StalePolicy::drop}) {
      LateReceiver bench(in_mode(mode, policy));
      bench.send({}, 0, 1);
      bench.receiver.receive_pending(0);
      const auto absent = [&](std::int64_t now) {
        bench.receiver.predict(now);
        return bench.receiver.update_absent(1, now);
      };
      EXPECT_FALSE(absent(base::kSecond));
      EXPECT_EQ(absent(base::kSecond + kMs), policy != StalePolicy::freeze);
      EXPECT_EQ(absent(6 * base::kSecond), policy != StalePolicy::freeze);
      EXPECT_TRUE(absent(12 * base::kSecond)) << "forgotten after 10 s by any policy";
      bench.send({}, 12 * base::kSecond, 2);
      bench.receiver.receive_pending(12 * base::kSecond);
      EXPECT_FALSE(absent(12 * base::kSecond)) << "its next state returns it";
    }
}

/// Boundary: a state every 1.6 s, which is longer than `stale_after`.
TEST(LateStates, ASlowSenderStaysBetweenItsStates) {
  LateReceiver bench;
  for (std::int64_t now = 0; now < 16 * base::kSecond; now += 100 * kMs) {
    if (now % (1600 * kMs) == 0) bench.send({}, now, static_cast<std::uint32_t>(now / (1600 * kMs)));
    bench.receiver.receive_pending(now);
    bench.receiver.predict(now);
    const bool absent = bench.receiver.update_absent(1, now);
    EXPECT_FALSE(absent && now > 2 * base::kSecond) << now;
  }
  EXPECT_FALSE(bench.receiver.update_absent(1, 17600 * kMs));
  EXPECT_TRUE(bench.receiver.update_absent(1, 17700 * kMs)) << "3.3 s after its last";
}

/// Boundary: never; only a request for readings, which are computed where the world file places it; a tag.
TEST(LateStates, ARobotWithoutAnyStateIsOutOfTheWorldUnlessItRequestsReadings) {
  for (const StalePolicy policy : {StalePolicy::freeze, StalePolicy::hide}) {
    LateReceiver bench(in_mode(FilterMode::automatic, policy));
    const bool hides = policy == StalePolicy::hide;
    EXPECT_EQ(bench.receiver.update_absent(2, 0), hides);
    bench.send({.robot = 2, .sequence = 1}, netio::Subscribe{});
    bench.receiver.receive_pending(0);
    EXPECT_FALSE(bench.receiver.update_absent(2, 0));
    EXPECT_EQ(bench.receiver.quality(1, 0).age, base::kNoStateYet);
    EXPECT_EQ(bench.receiver.update_absent(2, 2 * base::kSecond), hides) << "it is silent again";
  }
}

}  // namespace
}  // namespace sf::server
