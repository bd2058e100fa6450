// Lights that a farm plans or receives, and relays to its robots.

#include "server/light_service.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "control/own_controllers.h"
#include "netio/v2v_socket.h"
#include "tests/refusal.h"
#include "tests/server/fixture.h"
#include "v2x/frame.h"
#include "world/roads/roads.h"

namespace sf::server {
namespace {

using netio::PacketStatus;
using world::LightState;

constexpr std::uint16_t kFirst = 1, kSecondLight = 2;  // intersections, of one light each
constexpr netio::SigningKey kLightKey{1, 2, 3};

/// A room with two lights: one green for 8 s of 10, one permanently red.
struct LitRoom : Fixture {
  explicit LitRoom(const Settings& chosen = {}, StaleLights stale = StaleLights::dark, bool spat = false)
      : Fixture(chosen) {
    for (const auto& phases : {std::vector<world::LightPhase>{{LightState::green, 8.0}, {LightState::yellow, 2.0}},
                               std::vector<world::LightPhase>{{LightState::red, 1.0}}}) {
      world::Light& light = world.lights.emplace_back();
      light.name = "light" + std::to_string(world.lights.size());
      light.phases = phases;
      light.X_WL = {1.0, 0.5, 0.25, 0.5};
    }
    ServiceOptions options{.receiver = {.bind = {netio::kLoopback, 0},
                                        .radio = settings.radio,
                                        .log_descriptor = log.descriptor(),
                                        .peers = settings.peers},
                           .stale_lights = stale};
    if (spat) options.spat = netio::Endpoint{netio::kLoopback, 0};
    service = std::make_unique<Service>(world, sensor_set, device(), layout, options);
    client.reset();  // its ports are needed
    client = make_client(0);
  }
  netio::V2vSocket radio(std::uint16_t id, std::optional<netio::SigningKey> key = std::nullopt) const {
    return netio::V2vSocket(
        {.farm = {netio::kLoopback, service->port()}, .robot = id, .others = {1, 2}, .key = key, .lights = {1, 2}});
  }
  std::uint64_t received(PacketStatus status) const { return service->stats().inbox[status]; }
  LightState shown(std::size_t light) const { return service->lights().signals()[light].state; }
};

/// A V2I sender of one light's state.
struct Sender {
  netio::V2vSocket socket;
  std::uint16_t id;
  std::uint32_t sent = 0;
  std::size_t received = 0;  ///< received states of robots

  void send(LightState state, double left = 3.0) {
    base::Bytes rows, bytes;
    netio::put(netio::SignalApproach{.state = static_cast<std::uint8_t>(state), .left = left}, rows);
    netio::encode({.robot = id, .sequence = sent++}, netio::V2i{rows, {}}, bytes);
    socket.send(bytes);
  }
  void receive(std::int64_t now) {
    socket.receive([&](std::span<const std::uint8_t> bytes) {
      netio::Packet packet;
      if (socket.accept(bytes, now, packet) != PacketStatus::accepted) return;
      received += std::holds_alternative<netio::V2v>(packet.body) ? 1 : 0;
    });
  }
  /// Runs until the farm accepts its packets.
  void prove(LitRoom& room) {
    send(LightState::dark);
    room.service->receive_pending(room.now);
    receive(room.now);
  }
};

/// The newest state of an intersection's light received by a robot.
struct Ear {
  netio::V2vSocket socket;
  std::uint32_t sent = 0;
  std::map<std::uint16_t, netio::SignalApproach> lights;
  std::size_t packets = 0;

  void listen(LitRoom& room, const base::Pose& X_WR = {}) {
    base::Bytes bytes;
    const netio::Header header{.robot = 2, .sequence = sent++};
    netio::encode(header, netio::Subscribe{netio::kNeighboursBit}, bytes);
    socket.send(bytes);
    netio::encode(header, netio::V2v{.X_WR = X_WR}, bytes);
    socket.send(bytes);
    room.service->tick(room.now);
    socket.receive([&](std::span<const std::uint8_t> one) {
      netio::Packet packet;
      if (socket.accept(one, room.now, packet) != PacketStatus::accepted) return;
      const auto* v2i = std::get_if<netio::V2i>(&packet.body);
      if (v2i == nullptr) return;
      lights[packet.header.robot] = netio::approach_at(*v2i, 0);
      ++packets;
    });
    room.now += kTick;
  }
};

TEST(LightService, RobotsReceiveThePlan) {
  LitRoom room;
  Ear robot{room.radio(2)};
  for (int i = 0; i < 5; ++i) robot.listen(room);
  EXPECT_EQ(robot.lights.at(kFirst).state, static_cast<std::uint8_t>(LightState::green));
  EXPECT_NEAR(robot.lights.at(kFirst).left, 7.6, 1e-3);
  EXPECT_EQ(robot.lights.at(kFirst).next, static_cast<std::uint8_t>(LightState::yellow));
  EXPECT_NEAR(robot.lights.at(kFirst).X_WL.y, 0.5, 1e-12);
  EXPECT_EQ(robot.lights.at(kSecondLight).state, static_cast<std::uint8_t>(LightState::red));
  EXPECT_EQ(robot.lights.at(kSecondLight).left, HUGE_VAL) << "for ever";
  EXPECT_EQ(room.service->stats().lights.sent, robot.packets);
}

TEST(LightService, RobotsBeyondTheRadioReceiveNothing) {
  LitRoom room({.radio = 2.0});
  Ear robot{room.radio(2)};
  for (int i = 0; i < 5; ++i) robot.listen(room, {3.5, 0.5, 0, 0});
  EXPECT_EQ(robot.packets, 0u);
  for (int i = 0; i < 3; ++i) robot.listen(room, {3.0, 0.5, 0, 0});
  EXPECT_GT(robot.packets, 0u) << "2 m, inclusive";
}

TEST(LightService, AReceivedLightReplacesThePlanAndIsRelayed) {
  LitRoom room;
  Sender light{room.radio(kFirst), kFirst};
  Ear robot{room.radio(2)};
  light.prove(room);
  EXPECT_EQ(room.received(PacketStatus::unproven), 1u);
  light.send(LightState::flashing_red, HUGE_VAL);
  for (int i = 0; i < 3; ++i) robot.listen(room);
  EXPECT_EQ(room.shown(0), LightState::flashing_red);
  EXPECT_EQ(room.shown(1), LightState::red) << "by its plan";
  EXPECT_EQ(robot.lights.at(kFirst).state, static_cast<std::uint8_t>(LightState::flashing_red));
  EXPECT_EQ(robot.lights.at(kFirst).next, netio::kNoSignalState);
  EXPECT_EQ(room.service->stats().lights.heard.packets, 1u);
}

/// As sent to robots: planned and received states, at each tick.
TEST(LightService, ARecordingHasTheStates) {
  struct Lights : base::Sink {
    std::vector<base::LightStatus> newest;
    void write(const base::TickRecord& record) override { newest.assign(record.lights.begin(), record.lights.end()); }
  } sink;
  LitRoom room;
  room.service->record_to(sink);
  Sender light{room.radio(kSecondLight), kSecondLight};
  light.prove(room);
  light.send(LightState::flashing_yellow, 4.0);
  room.service->tick(kSecond);
  EXPECT_EQ(sink.newest, (std::vector<base::LightStatus>{{3, 7.0}, {5, 4.0}}));
}

TEST(LightService, ASilentLightIsDarkOrFollowsItsPlan) {
  for (const StaleLights stale : {StaleLights::dark, StaleLights::plan}) {
    LitRoom room({}, stale);
    Sender light{room.radio(kFirst), kFirst};
    light.prove(room);
    light.send(LightState::yellow);
    room.service->tick(0);
    room.service->tick(LightListener::kSilence - 1);
    EXPECT_EQ(room.shown(0), LightState::yellow);
    room.service->tick(LightListener::kSilence);
    EXPECT_EQ(room.shown(0), stale == StaleLights::dark ? LightState::dark : LightState::green);
    EXPECT_EQ(room.service->stats().lights.heard.silences, 1u);
    room.now = LightListener::kSilence + kTick;
    light.send(LightState::yellow);
    room.service->tick(room.now);
    EXPECT_EQ(room.shown(0), LightState::yellow) << "received again, and used immediately";
  }
}

TEST(LightService, WrongSendersAreCountedByReason) {
  LitRoom room({.peers = {{netio::PeerKind::light, kFirst, std::nullopt, kLightKey},
                          {netio::PeerKind::light, kSecondLight, netio::kLoopback + 1, std::nullopt}}});
  Sender unsigned_one{room.radio(kFirst), kFirst}, elsewhere{room.radio(kSecondLight), kSecondLight};
  Sender unknown{room.radio(3), 3};
  for (Sender* each : {&unsigned_one, &elsewhere, &unknown}) each->prove(room);
  EXPECT_EQ(room.received(PacketStatus::not_signed), 1u);
  EXPECT_EQ(room.received(PacketStatus::wrong_source), 1u);
  EXPECT_EQ(room.received(PacketStatus::unknown_light), 1u);
  Sender keyed{room.radio(kFirst, kLightKey), kFirst};
  keyed.prove(room);
  EXPECT_EQ(room.received(PacketStatus::unproven), 1u);
  keyed.send(LightState::yellow);
  room.service->tick(0);
  EXPECT_EQ(room.received(PacketStatus::accepted), 1u);
  EXPECT_EQ(room.shown(0), LightState::yellow);
  // Another process with the same key is not bound while this one is active.
  Sender second{room.radio(kFirst, kLightKey), kFirst};
  second.prove(room);
  second.send(LightState::red);
  room.service->tick(kTick);
  EXPECT_EQ(room.shown(0), LightState::yellow);
}

TEST(LightService, ALightReceivesTheRobotsNearIt) {
  for (const auto& key : {std::optional<netio::SigningKey>(), std::optional(kLightKey)}) {  // that signs its packets
    LitRoom room({.peers = {{netio::PeerKind::light, kFirst, std::nullopt, key}}});
    Sender light{room.radio(kFirst, key), kFirst};
    Ear robot{room.radio(2)};
    light.prove(room);
    for (int i = 0; i < 4; ++i) {
      light.send(LightState::green);
      robot.listen(room);
      light.receive(room.now);
    }
    EXPECT_GE(light.received, 3u);
    room.now += netio::kSenderTimeout;  // silent: it receives nothing any more
    robot.listen(room);
    const std::size_t before = light.received;
    light.receive(room.now);
    EXPECT_EQ(light.received, before);
  }
}

base::Bytes spat_of_room(const world::World& world, std::uint16_t id) {
  v2x::Frame frame;
  frame.message = spat_of(intersections_of(world, nullptr).at(id - 1u), world::forecasts_at(world, 9.0), 0);
  base::Bytes bytes;
  v2x::encode(frame, bytes);
  return bytes;
}

TEST(LightService, SpatIsAcceptedUnlessItsSenderHasAKey) {
  for (const bool keyed : {false, true}) {
    LitRoom room(
        {.peers = {{netio::PeerKind::light, kFirst, std::nullopt, keyed ? std::optional(kLightKey) : std::nullopt}}},
        StaleLights::dark, true);
    netio::Outbox outbox;
    outbox.queue({netio::kLoopback, room.service->lights().listener().port()}, spat_of_room(room.world, kFirst));
    outbox.flush();
    room.service->tick(0);
    EXPECT_EQ(room.shown(0), keyed ? LightState::green : LightState::yellow);
    EXPECT_EQ(room.service->stats().lights.heard.refused, keyed ? 1u : 0u);
  }
}

/// The complete path: plan, packet, the robot's own listener.
TEST(LightService, ARobotsProcessReceivesTheFarmsLights) {
  LitRoom room;
  room.run(10);
  EXPECT_GE(room.client->stats().lights.packets, 4u);
  EXPECT_EQ(room.client->stats().lights.silences, 0u);
}

/// 44 lights with one stop line each are 88 rows, and a packet holds 39: three packets contain each light and line
/// once.
TEST(V2iMessages, ManyLightsTakeSeveralPackets) {
  world::World world =
      world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world", {.sensors = sensors::world_file_words()});
  for (int i = 0; i < 40; ++i) world.lights.push_back(world.lights[0]);
  const auto roads = world::roads_of(world);
  V2iMessages messages(world, &*roads);
  ASSERT_EQ(messages.intersections().size(), 2u);
  std::size_t packets = 0;
  std::multiset<int> groups, stops;
  messages.for_each_packet(0, world::forecasts_at(world, 0.0), 0, [&](const base::Bytes& bytes) {
    netio::Packet packet;
    ASSERT_EQ(netio::decode(bytes, packet), PacketStatus::accepted);
    EXPECT_EQ(packet.header.sequence, packets++);
    const auto& v2i = std::get<netio::V2i>(packet.body);
    std::set<int> here;
    for (std::size_t k = 0; k < netio::count(v2i.approaches); ++k) here.insert(netio::approach_at(v2i, k).group);
    groups.insert(here.begin(), here.end());
    for (std::size_t k = 0; k < netio::count(v2i.stops); ++k) {
      const netio::SignalStop stop = netio::stop_at(v2i, k);
      EXPECT_TRUE(here.contains(stop.group)) << "with its approach";
      EXPECT_NEAR(stop.width, 0.5, 0.01);
      stops.insert(stop.group);
    }
  });
  EXPECT_GE(packets, 3u);
  for (int group = 1; group <= 44; ++group) {
    EXPECT_GE(groups.count(group), 1u) << group;
    EXPECT_EQ(stops.count(group), 1u) << group;
  }
}

/// OBJECT of a tag: its walls disappear at the next tick, and return later.
TEST(Service, AnObjectDisappearsAndReturns) {
  Fixture f;
  world::Mover& door = scenes::add_mover(f.world, {-1.0, 0.0, 0.0, 0.0}, scenes::rectangle({0.0, 0.0}, 0.05, 1.0));
  door.is_tag = true;
  door.id = 5;
  f.make_service();
  netio::V2vSocket robot({.farm = {netio::kLoopback, f.service->port()}, .robot = 1, .others = {2}});
  netio::Outbox switcher;
  std::uint32_t sequence = 0;
  base::Bytes bytes;
  const auto put = [&](bool present) {
    netio::encode({.robot = 5, .sequence = sequence}, netio::Object{present}, bytes);
    switcher.queue({netio::kLoopback, f.service->port()}, bytes);
    switcher.flush();
  };
  struct Middle : base::Sink {
    double range = 0.0;
    void write(const base::TickRecord& record) override {
      for (const base::ReadingBlock& reading : record.readings) range = reading.values[45];
    }
  } sink;
  f.service->record_to(sink);
  const auto middle = [&] {
    for (int i = 0; i < 3; ++i, f.now += kTick, ++sequence) {
      netio::encode({.robot = 1, .sequence = sequence}, netio::V2v{.X_WR = {-2.0, 0.0, 0.0, 0.0}}, bytes);
      robot.send(bytes);
      f.service->tick(f.now);
      robot.receive([&](std::span<const std::uint8_t> one) {
        netio::Packet packet;
        robot.accept(one, f.now, packet);
      });
    }
    return sink.range;
  };
  EXPECT_NEAR(middle(), 0.875, 1e-9) << "the closed door";
  put(false);
  EXPECT_NEAR(middle(), 4.9, 1e-9) << "the wall behind it";
  put(true);
  EXPECT_NEAR(middle(), 0.875, 1e-9);
  EXPECT_EQ(f.service->stats().inbox[PacketStatus::unknown_tag], 0u);
}

/// A model's controller moves it, until a packet does.
TEST(Service, AControllerMovesAModelUntilPacketsDo) {
  struct Slides : sensorfarm::ModelController {
    void tick(sensorfarm::Model& model) override {
      ++calls();
      if (model.time() < 0.05) model.set_velocity({0.5, 0.0, 0.0});
      if (model.time() > 0.35 && model.time() < 0.45) model.set_color("#ff0000");
      if (model.time() > 0.85 && model.time() < 0.95) model.set_present(false);
      if (model.time() > 0.95) model.set_present(true), model.set_pose({0.5, 0.0, 0.0, 0.0});
      if (model.time() > 0.95) model.object("tag6").set_pose({0.0, 3.0, 0.0, 0.0});
    }
    static int& calls() {
      static int count = 0;
      return count;
    }
  };
  control::add_own_model_controller({"slides", "", [](const auto&, auto&) { return std::make_unique<Slides>(); }},
                                    "test");
  Fixture f;
  world::Mover& door = scenes::add_mover(f.world, {-1.0, 0.0, 0.0, 0.0}, scenes::rectangle({0.0, 0.0}, 0.05, 1.0));
  door.is_tag = true;
  door.id = 5;
  door.controller = "slides";
  world::Mover& box = scenes::add_mover(f.world, {-1.0, 3.0, 0.0, 0.0}, scenes::rectangle({0.0, 0.0}, 0.1, 0.1));
  box.name = "tag6";
  box.is_tag = true;
  box.id = 6;
  f.make_service();
  struct States : base::Sink {
    std::vector<base::Pose> poses, boxes;
    std::vector<std::uint32_t> colors;  ///< of changes
    void write(const base::TickRecord& record) override {
      poses.push_back(record.reports[record.reports.size() - 2].X_WM);
      boxes.push_back(record.reports.back().X_WM);
      for (const base::ShapeState& shape : record.shapes) colors.push_back(shape.color);
    }
  } sink;
  f.service->change_shapes_in(f.world);
  f.service->record_to(sink);
  for (int tick = 0; tick < 15; ++tick, f.now += kTick) f.service->tick(f.now);
  EXPECT_EQ(sink.poses[0].x, -1.0);
  EXPECT_NEAR(sink.poses[5].x, -0.75, 1e-9);
  EXPECT_TRUE(base::is_absent(sink.poses[10]));
  EXPECT_NEAR(sink.poses[12].x, 0.5, 1e-9);
  EXPECT_EQ(sink.boxes[10].x, -1.0);
  EXPECT_EQ(sink.boxes[12].x, 0.0) << "reached by its name";
  EXPECT_EQ(Slides::calls(), 15);
  EXPECT_EQ(sink.colors, std::vector<std::uint32_t>{0xFFFF0000u});
  netio::Outbox camera;
  base::Bytes bytes;
  netio::encode({.robot = 5, .sequence = 1}, netio::Tag{.position = {2.0, 0.0, 0.0}}, bytes);
  camera.queue({netio::kLoopback, f.service->port()}, bytes);
  camera.flush();
  for (int tick = 0; tick < 3; ++tick, f.now += kTick) f.service->tick(f.now);
  EXPECT_NEAR(sink.poses.back().x, 2.0, 1e-6);
  EXPECT_EQ(Slides::calls(), 15) << "packets move it";
  expect_in("is moved by packets from now on", f.log.read_all());
}

}  // namespace
}  // namespace sf::server
