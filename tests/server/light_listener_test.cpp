#include "server/light_listener.h"

#include <gtest/gtest.h>

#include "netio/outbox.h"
#include "tests/server/fixture.h"
#include "tests/units.h"
#include "v2x/frame.h"

namespace sf::server {
namespace {

using world::LightState;

constexpr std::int64_t kUtc = 1'767'225'600'000;  ///< [ms]

/// Two lights, each forming an intersection: 8 s of green before yellow, and permanent red.
world::World lights_of_messages() {
  world::World world;
  world.lights.resize(2);
  world.lights[0].phases = {{LightState::green, 8.0}, {LightState::yellow, 2.0}};
  world.lights[1].phases = {{LightState::red, 1.0}};
  return world;
}

base::Bytes spat(const world::World& world, std::uint32_t intersection, double time = 0.0) {
  v2x::Frame frame;
  frame.message = spat_of(intersections_of(world, nullptr).at(intersection), world::forecasts_at(world, time), kUtc);
  base::Bytes bytes;
  v2x::encode(frame, bytes);
  return bytes;
}

struct Listening {
  world::World world = lights_of_messages();
  LightListener listener{world, nullptr, {.spat = netio::Endpoint{netio::kLoopback, 0}}};

  /// Returns the states after `apply`, starting from flashing yellow for both.
  std::vector<world::Signal> at(std::int64_t now) {
    std::vector<world::Signal> signals(2, {LightState::flashing_yellow, 1.0});
    listener.apply(now, signals);
    return signals;
  }
};

TEST(LightListener, OnlyReceivedLightsAreReplaced) {
  Listening l;
  l.listener.accept(spat(l.world, 0), {}, 0, kUtc);
  const auto signals = l.at(kSecond);
  EXPECT_EQ(signals[0].state, LightState::green);
  EXPECT_NEAR(signals[0].left, 7.0, 1e-9) << "8 s, of which one has passed";
  EXPECT_EQ(signals[1].state, LightState::flashing_yellow) << "by its plan";
}

TEST(LightListener, ASilentLightIsDarkUntilItsNextMessage) {
  Listening l;
  l.listener.accept(spat(l.world, 1), {}, 0, kUtc);
  EXPECT_EQ(l.at(LightListener::kSilence - 1)[1].state, LightState::red);
  EXPECT_EQ(l.at(LightListener::kSilence)[1].state, LightState::dark);
  l.listener.accept(spat(l.world, 1), {}, 3 * kSecond, kUtc);
  EXPECT_EQ(l.at(3 * kSecond)[1].state, LightState::red);
}

TEST(LightListener, RemainingTimeEndsAtZero) {
  Listening l;
  l.listener.accept(spat(l.world, 0, 7.5), {}, 0, kUtc);
  EXPECT_NEAR(l.at(0)[0].left, 0.5, 1e-9);
  EXPECT_EQ(l.at(kSecond)[0].left, 0.0);
}

TEST(LightListener, AWrongSenderClockDoesNotMatter) {
  // Times are relative to the message's own time.
  Listening l;
  l.listener.accept(spat(l.world, 0), {}, 0, kUtc + 1'234'567);
  EXPECT_NEAR(l.at(0)[0].left, 8.0, 1e-9);
}

TEST(LightListener, OtherDatagramsAreCounted) {
  Listening l;
  base::Bytes bytes = spat(l.world, 0);
  l.listener.accept(std::span(bytes).first(bytes.size() - 1), {}, 0, kUtc);
  l.listener.accept({}, {}, 0, kUtc);
  world::World other = lights_of_messages();
  other.lights.resize(3, other.lights[1]);
  l.listener.accept(spat(other, 2), {}, 0, kUtc);
  v2x::Frame map;
  map.message = v2x::MapData{};
  v2x::encode(map, bytes);
  l.listener.accept(bytes, {}, 0, kUtc);
  EXPECT_EQ(l.listener.counts().invalid, 2u);
  EXPECT_EQ(l.listener.counts().others, 2u);
  EXPECT_EQ(l.listener.counts().messages, 0u);
  EXPECT_EQ(l.at(0)[0].state, LightState::flashing_yellow);
}

TEST(LightListener, ReceivesDatagrams) {
  Listening l;
  netio::Outbox outbox;
  outbox.queue({netio::kLoopback, l.listener.port()}, spat(l.world, 0));
  outbox.queue({netio::kLoopback, l.listener.port()}, spat(l.world, 1));
  outbox.flush();
  l.listener.receive(0, kUtc);  // loopback delivers immediately
  EXPECT_EQ(l.listener.counts().messages, 2u);
  EXPECT_EQ(l.at(0)[1].state, LightState::red);
}

TEST(RobotClient, CountsReceivedLights) {
  Fixture f;
  f.world.lights = lights_of_messages().lights;
  RobotClientOptions options{.log_descriptor = f.log.descriptor()};
  options.link.farm = {netio::kLoopback, f.service->port()};
  options.controller.name = "wander";
  options.spat = netio::Endpoint{netio::kLoopback, 0};
  options.utc = [] { return kUtc; };
  RobotClient robot(f.world, f.sensor_set, 1, f.layout, options);
  netio::Outbox outbox;
  outbox.queue({netio::kLoopback, robot.lights().port()}, spat(f.world, 0));
  outbox.flush();
  robot.step(0);
  EXPECT_EQ(robot.stats().lights.messages, 1u);
}

}  // namespace
}  // namespace sf::server
