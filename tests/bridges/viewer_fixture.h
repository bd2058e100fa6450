#pragma once
// A viewer of robots without sensors, and its clients.

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "bridges/viewer.h"
#include "tests/bridges/raw_client.h"

namespace sf::bridges {

struct ViewerFixture {
  explicit ViewerFixture(ViewerMode mode = ViewerMode::run, std::size_t robots = 2, WebLimits limits = {},
                         const char* host = "127.0.0.1")
      : world(world_of(robots)), sensor_set(world), info(run_info_of(world)) {
    const Scene scene{world, sensor_set, info, mode == ViewerMode::run};
    viewer = std::make_unique<Viewer>(scene, ViewerOptions{{host, 0}, mode, 1'000'000'000, 5'000'000'000, limits});
  }
  static world::World world_of(std::size_t robots) {
    world::World world;
    world.name = "few";
    for (std::size_t i = 0; i < robots; ++i) {
      world::Mover mover;
      mover.name = i == 0 ? "left" : i == 1 ? "right" : "robot" + std::to_string(i);
      world.movers.push_back(mover);
    }
    return world;
  }
  static record::RunInfo run_info_of(const world::World& world) {
    record::RunInfo info;
    info.world = world.name;
    info.record_readings = true;
    info.odometry_rate = 10.0;
    for (const world::Mover& mover : world.movers) info.movers.push_back({mover.name, "", 0, {}});
    record::name_frames(info);
    return info;
  }
  /// Paused ticks are not paced, so tests do not depend on a clock.
  void tick(std::uint64_t number, bool paused = true) {
    const std::vector<base::Report> reports = states();
    base::TickRecord tick;
    tick.tick = number;
    tick.time = static_cast<std::int64_t>(number) * 100'000'000;
    tick.reports = reports;
    viewer->publish(tick, {.paused = paused});
  }
  std::vector<base::Report> states() const {
    std::vector<base::Report> reports(world.movers.size());
    for (std::uint32_t i = 0; i < reports.size(); ++i) reports[i].mover = i;
    return reports;
  }
  /// Returns the channel number of a topic.
  int channel(std::string_view topic) const {
    const record::TickMessages messages(info);
    int row = 0;
    while (messages.topics()[row].name != topic) ++row;
    return row;
  }
  std::uint16_t port() const { return viewer->server().port(); }
  Requests requests() {
    Requests taken;
    viewer->take(taken);
    return taken;
  }

  world::World world;
  sensors::SensorSet sensor_set;
  record::RunInfo info;
  std::unique_ptr<Viewer> viewer;
};

/// A connected client that has subscribed to topics as subscriptions 101, 102, ...
struct Watcher : RawClient {
  explicit Watcher(const ViewerFixture& fixture, const std::vector<std::string>& topics = {},
                   const char* protocol = kWebSocketV1)
      : RawClient(fixture.port()) {
    upgrade(protocol);
    int id = 101;
    for (const std::string& topic : topics) subscribe(id++, fixture.channel(topic));
    greeting = settle();
  }
  void subscribe(int id, int channel) {
    text(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(id) + R"(,"channelId":)" +
         std::to_string(channel) + "}]}");
  }
  std::string greeting;
};

/// Returns "subscription@tick" of a message of a topic whose first field is a time stamp, with ticks every 0.1 s.
inline std::string subscription_tick(const std::string& binary) {
  std::uint32_t subscription = 0, nanoseconds = 0;
  std::int32_t seconds = 0;
  if (binary.size() < 24) return {};
  std::memcpy(&subscription, binary.data(), 4);
  std::memcpy(&seconds, binary.data() + 16, 4);
  std::memcpy(&nanoseconds, binary.data() + 20, 4);
  return std::to_string(subscription) + "@" +
         std::to_string(10 * seconds + static_cast<int>(nanoseconds / 100'000'000));
}

}  // namespace sf::bridges
