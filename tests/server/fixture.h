#pragma once
// A service and a robot in one process, on the test's own clock.

#include <gtest/gtest.h>

#include <unistd.h>

#include <memory>
#include <string>

#include "base/error.h"
#include "sensors/accuracy.h"
#include "sensors/aggregate.h"
#include "sensors/bumper.h"
#include "sensors/camera.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "server/robot_client.h"
#include "server/service.h"
#include "tests/netio/log_pipe.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::server {

using netio::LogPipe;

/// A room of 6 m by 4 m with robots of 0.3 m by 0.3 m, each with a laser, at the world's 10 Hz.
inline world::World room(double rate = 10.0, double latency = 0.0, std::uint32_t samples = 91) {
  world::World world = scenes::boxed_world(6.0, 4.0, {-3.0, -2.0});
  for (const base::Pose& X_WM : {base::Pose{-2.0, 0.0, 0.0, 0.0}, base::Pose{2.0, 1.0, 0.0, 0.0}})
    scenes::add_mover(world, X_WM, scenes::rectangle({0.0, 0.0}, 0.3, 0.3))
        .sensors.push_back(sensors::laser_sensor(
            {{.name = "laser", .X_MS = {0.1, 0.0, 0.04, 0.0}, .samples = samples}, rate, 0.0, latency}));
  return world;
}

struct Settings {
  double sensor_rate = 10.0;  ///< [Hz]
  double loss = 0.0;          ///< [-] of the injected link
  bool wait_for_start = false;
  double radio = netio::kV2vRange;  ///< [m]
  StateFilterOptions filter;
  double latency = 0.0;  ///< [s] of sensors
  std::vector<netio::Peer> peers;
  std::uint32_t samples = 91;      ///< of each laser
  std::string accuracy = "exact";  ///< of the sensors
  std::string controller = "wander";
  bool stop_without_farm = false;
  std::optional<world::World> world = {};  ///< in place of the room
  double processor_budget = 0.0;           ///< [s] per tick
  double network_budget = 0.0;             ///< [byte/s]
};

inline world::World in_mode(world::World world, const std::string& accuracy) {
  sensors::set_accuracy(world, accuracy);
  return world;
}

struct Fixture {
  explicit Fixture(const Settings& chosen = {})
      : settings(chosen),
        world(in_mode(chosen.world ? *chosen.world : room(chosen.sensor_rate, chosen.latency, chosen.samples),
                      chosen.accuracy)),
        sensor_set(world) {
    // Reading ports have no option for "any free port". Concurrent tests start their search at different places and
    // reserve ports for four robots there, because another robot's ports are only bound later.
    layout.stride = 8;
    for (unsigned attempt = 0; client == nullptr && attempt < 1000; ++attempt) {
      layout.bases[sensors::kLaser] = 11'000 + (static_cast<unsigned>(getpid()) + 17 * attempt) * 32 % 20'000;
      layout.bases[sensors::kBumper] = layout.bases.at(sensors::kLaser) + 4;  // between those of lasers
      layout.bases[sensors::kAggregate] = layout.bases.at(sensors::kLaser) + 5;
      layout.bases[sensors::kCamera] = layout.bases.at(sensors::kLaser) + 6;
      try {
        const netio::Socket free = netio::open_udp({netio::kLoopback, reading_port(1)}),
                            other = netio::open_udp({netio::kLoopback, reading_port(2)});
      } catch (const base::InputError&) {
        continue;
      }
      make_service();
      client = make_client(0);
    }
  }
  std::uint16_t reading_port(std::uint32_t robot) const {
    return static_cast<std::uint16_t>(layout.bases.at(sensors::kLaser) + 8 * robot);
  }
  void make_service() {
    service = std::make_unique<Service>(world, sensor_set, device(), layout,
                                        ServiceOptions{.receiver = {.bind = {netio::kLoopback, 0},
                                                                    .radio = settings.radio,
                                                                    .log_descriptor = log.descriptor(),
                                                                    .filter = settings.filter,
                                                                    .peers = settings.peers},
                                                       .processor_budget = settings.processor_budget,
                                                       .network_budget = settings.network_budget});
  }
  /// Returns the client of a robot, with its key in the table of peers or with another.
  std::unique_ptr<RobotClient> make_client(std::uint32_t mover) {
    const netio::Peer* peer = netio::find(settings.peers, netio::PeerKind::robot, world.movers[mover].id);
    return make_client(mover, peer != nullptr ? peer->key : std::nullopt);
  }
  std::unique_ptr<RobotClient> make_client(std::uint32_t mover, const std::optional<netio::SigningKey>& key) {
    RobotClientOptions options{.stop_without_farm = settings.stop_without_farm,
                               .wait_for_start = settings.wait_for_start,
                               .log_descriptor = log.descriptor()};
    options.link = {.farm = {netio::kLoopback, service->port()}, .model = {.loss = settings.loss}, .key = key};
    options.controller.name = settings.controller;
    return std::make_unique<RobotClient>(world, sensor_set, mover, layout, options);
  }
  /// Runs both for some ticks, or only the robot.
  void run(int ticks, bool served = true) {
    for (int i = 0; i < ticks; ++i, now += kTick) {
      client->receive(now);
      client->step(now);
      if (served) service->tick(now);
    }
    client->receive(now);
  }
  static gpu::Device& device() {
    static gpu::Device device;
    return device;
  }

  Settings settings;
  world::World world;
  sensors::SensorSet sensor_set;
  StreamLayout layout;
  LogPipe log;
  std::unique_ptr<Service> service;
  std::unique_ptr<RobotClient> client;
  std::int64_t now = 0;
};

}  // namespace sf::server
