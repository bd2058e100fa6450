// Robots that drive by cameras: robot -> rendered picture -> detection -> TAG over UDP -> filter in the robot -> V2V ->
// filter in the farm -> readings -> controller -> the robot moves -> next picture. Everything except the kernel's
// sockets uses a simulated clock, so runs are reproducible.

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "base/error.h"
#include "sensors/sensor_type.h"
#include "server/robot_client.h"
#include "server/service.h"
#include "tests/device.h"
#include "vision/positioning.h"
#include "vision/rendered_robots.h"
#include "vision/rendering/renderer.h"

namespace sf::vision {

namespace {

constexpr std::int64_t kTick = 100'000'000;     // [ns] of the robot, the farm and the camera
constexpr std::int64_t kExposure = 40'000'000;  // [ns] after a tick; an image taken then is received at the next tick

/// One camera above the whole lane of worlds/testpath: 11 mm of the floor per pixel, tags of 21 pixels.
Testbed testbed() {
  return parse_testbed(
      "loop.toml",
      "dictionary = \"aruco_4x4_50\"\ntag_side = 0.25\ntag_height = 0.2\n"
      "[[camera]]\nname = \"top\"\nsize = [400, 300]\nfocal = [300, 300]\nposition = [1.75, 1.1, 3.7]\n"
      "distortion = [-0.1, 0.02, 0, 0, 0]\nexposure = 0.004\n");
}

/// The cameras: convert true states to TAG packets.
class Cameras {
 public:
  Cameras()
      : robots_(testbed_),
        renderer_(testbed_.cameras[0].camera, Imaging{}, 1),
        positioning_(testbed_, 1, true),
        truth_(netio::open_udp({netio::kLoopback, 0})),
        batch_(16),
        frames_(1) {}
  netio::Endpoint truth() const { return netio::bound_endpoint(truth_); }

  /// Takes an image, or repeats the last one while the camera is frozen.
  /// @return number of tags seen
  std::size_t look(std::int64_t now, const netio::Endpoint& to) {
    batch_.drain(truth_, 1000, [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) {
      netio::Packet packet;
      ASSERT_EQ(netio::decode(bytes, packet), netio::PacketStatus::accepted);
      const auto& state = std::get<netio::V2v>(packet.body);
      robots_.update(packet.header.robot, state.X_WR,
                     base::rotate(state.X_WR.yaw, {state.velocity.forward, state.velocity.left}), state.velocity.turn,
                     1e-9 * static_cast<double>(packet.header.time));
    });
    frames_[0].time = 1e-9 * static_cast<double>(now);
    if (!frozen)
      renderer_.render(robots_.scene_at(frames_[0].time + 0.002), frames_[0].time, images_++, frames_[0].image);
    const auto tags = positioning_.update(frames_);
    for (const TrackedTag& tag : tags) send(tag, to);
    return tags.size();
  }
  DetectionCounts counts() const { return positioning_.counts(); }

  bool frozen = false;

 private:
  void send(const TrackedTag& tag, const netio::Endpoint& to) {
    netio::Tag state;
    state.position = {tag.X_WT.x, tag.X_WT.y, tag.X_WT.z};
    state.orientation = {0.0, 0.0, std::sin(0.5 * tag.X_WT.yaw), std::cos(0.5 * tag.X_WT.yaw)};
    state.linear = {tag.velocity.x, tag.velocity.y, 0.0};
    state.angular = {0.0, 0.0, tag.turn};
    base::Bytes packet;
    netio::encode({.robot = static_cast<std::uint16_t>(tag.id),
                   .sequence = sequence_++,
                   .time = std::llround(1e9 * tag.time),
                   .session = 1},
                  state, packet);
    outbox_.queue(to, packet);
    outbox_.flush();
  }

  Testbed testbed_ = testbed();
  RenderedRobots robots_;
  Renderer renderer_;
  Positioning positioning_;
  netio::Socket truth_;
  netio::ReceiveBatch batch_;
  std::vector<Frame> frames_;
  std::uint32_t images_ = 0, sequence_ = 0;
  netio::Outbox outbox_;
};

/// The farm, one robot and the cameras.
struct Loop {
  explicit Loop(const std::string& controller, const std::vector<control::Setting>& settings)
      : world(world::load_world(SF_SOURCE_DIR "/worlds/testpath/testpath.world",
                                {.sensors = sensors::world_file_words()})),
        sensor_set(world),
        layout(make_layout()),
        service(world, sensor_set, device(), layout,
                {.receiver = {.bind = {netio::kLoopback, 0},
                              .log_descriptor = -1,
                              .filter = {.mode = server::FilterMode::on,
                                         .stale_after = 3 * kTick,
                                         .policy = estimation::StalePolicy::freeze}}}) {
    server::RobotClientOptions options{.log_descriptor = -1};
    options.link.farm = {netio::kLoopback, service.port()};
    options.controller = {controller, 10.0, control::Settings(controller, settings)};
    options.cameras =
        server::CameraOptions{.bind = {netio::kLoopback, 0}, .clock = {.source = estimation::ClockSource::trusted}};
    options.stop_after = 0.3;
    options.tag = 7;
    options.truth = cameras.truth();
    client.emplace(world, sensor_set, 0, layout, options);
  }
  /// Reading ports cannot be "any free port", so parallel tests start at different ports.
  server::StreamLayout make_layout() const {
    server::StreamLayout made;
    for (unsigned attempt = 0; attempt < 1000; ++attempt) {
      std::uint32_t port = 11'000 + (static_cast<unsigned>(getpid()) + 17 * attempt) * 64 % 20'000;
      for (const sensors::SensorType* type : sensors::sensor_types()) made.bases[type->id] = port++;
      made.stride = 32;
      try {
        std::vector<netio::Socket> free;
        for (const auto& [type, base] : made.bases)
          free.push_back(netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(base + 32)}));
        return made;
      } catch (const base::InputError&) {
      }
    }
    ADD_FAILURE() << "no free ports";
    return made;
  }
  void run(int ticks) {
    for (int i = 0; i < ticks && !client->done(); ++i, now += kTick) {
      client->receive(now);
      client->step(now);
      service.tick(now);
      client->move(now + kExposure);
      cameras.look(now + kExposure, {netio::kLoopback, client->own()->port()});
    }
  }
  glm::dvec2 place() const { return {client->stats().pose.x, client->stats().pose.y}; }

  world::World world;
  sensors::SensorSet sensor_set;
  server::StreamLayout layout;
  server::Service service;
  Cameras cameras;
  std::optional<server::RobotClient> client;
  std::int64_t now = 0;
};

}  // namespace

/// The whole lane, with its bend, at 0.25 m/s.
TEST(ClosedLoop, ARobotKeepsItsLaneUsingOnlyCameras) {
  Loop loop("lane-keeping", {{"speed", 0.25}});
  loop.run(300);
  const server::RobotClientStats stats = loop.client->stats();
  EXPECT_TRUE(stats.done);
  EXPECT_EQ(stats.stops, 0u);
  EXPECT_LT(glm::distance(loop.place(), glm::dvec2(3.65, 2.03)), 0.1) << loop.place().x << " " << loop.place().y;
  ASSERT_TRUE(stats.own);
  EXPECT_GT(stats.own->errors.steps, 150u);
  EXPECT_LT(stats.own->errors.rms(), 0.003) << "1.2 mm";
  EXPECT_LT(stats.own->errors.max, 0.02) << "12 mm, at the start";
  EXPECT_LT(stats.error.abs_mean, 0.02) << "offset in the lane, by readings: 12 mm";
  EXPECT_LE(stats.link.stale, 3u) << "readings before its first state";
}

/// By its estimated pose only: the true positions reach the points.
TEST(ClosedLoop, ARobotReachesPointsUsingOnlyCameras) {
  Loop loop("patrol", {{"points", std::vector<double>{0.2, 0.0, 0.8, 0.3}}, {"speed", 0.3}, {"pause", 1000.0}});
  loop.run(60);
  EXPECT_LT(glm::distance(loop.place(), glm::dvec2(0.8, 0.3)), 0.06) << loop.place().x << " " << loop.place().y;
  EXPECT_EQ(loop.client->stats().stops, 0u);
}

/// A camera repeats its last image with new timestamps: the robot would take itself for stopped and keep turning.
TEST(ClosedLoop, ARobotStopsWhileTheCameraIsFrozen) {
  Loop loop("lane-keeping", {{"speed", 0.25}});
  loop.run(20);
  EXPECT_GT(loop.place().x, 0.4);
  loop.cameras.frozen = true;
  loop.run(6);
  const glm::dvec2 stopped = loop.place();
  const std::uint64_t fresh = loop.client->stats().link.stale;
  loop.run(10);
  EXPECT_EQ(loop.place(), stopped) << "0.3 s of prediction are over, and it has braked";
  EXPECT_EQ(loop.client->stats().stops, 1u);
  EXPECT_GT(loop.client->stats().link.stale, fresh + 3) << "readings continue, marked as computed from a stale state";
  EXPECT_EQ(loop.cameras.counts().frozen, 16u);
  loop.cameras.frozen = false;
  loop.run(20);
  EXPECT_GT(loop.place().x, stopped.x + 0.3) << "it continues";
  EXPECT_NEAR(loop.place().y, 0.0, 0.05);
  EXPECT_EQ(loop.client->stats().stops, 1u);
}

/// Boundary: the robot is never seen by a camera.
TEST(ClosedLoop, ARobotWithoutACameraStops) {
  Loop loop("lane-keeping", {});
  loop.cameras.frozen = true;  // before the first image, which is then empty
  loop.run(10);
  EXPECT_EQ(loop.client->stats().distance_m, 0.0);
  EXPECT_EQ(loop.client->stats().steps, 0u);
  EXPECT_GT(loop.client->stats().link.whole.at("laneedge"), 0u) << "the farm answers its requests";
}

}  // namespace sf::vision
