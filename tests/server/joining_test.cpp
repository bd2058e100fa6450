// Objects and lights that no world file names join a farm, and leave without a trace.

#include <gtest/gtest.h>

#include <functional>

#include "netio/v2v_socket.h"
#include "sensors/laser.h"
#include "server/service.h"
#include "tests/netio/log_pipe.h"
#include "tests/refusal.h"
#include "tests/units.h"
#include "tests/world/read_world.h"
#include "world/append_object.h"

namespace sf::server {
namespace {

constexpr std::uint16_t kFirstId = 40;
constexpr netio::SigningKey kGuestKey{4, 5, 6};

/// A robot at the left looks along y = 0 at the far wall, 4.9 m ahead of its laser.
constexpr const char* kRoomText = R"(
shape( name "crate" size [0.8 0.6 0.2] )
model( name "room" size [6 4 1] boundary 1 noblocks 0 )
define bot position( size [0.3 0.3 0.1] laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] ) )
bot( name "roomba1" pose [-2 0 0 0] )
model( name "tag9" pose [2 1.5 0 0] size [0.4 0.4 0.2] )
model( name "box" pose [2 -1.5 0 90] size [0.4 0.2 0.2] model( name "lid" size [0.1 0.1 0.3] ) )
light( name "light1" pose [2.5 1.5 0 0] size [0.1 0.1 0.5] phases 1 phase[0] ["green" 1] )
)";

struct Newest : base::Sink {
  std::vector<double> ranges;
  std::vector<base::LightStatus> lights;
  std::vector<base::Report> states;
  std::size_t shapes = 0;  ///< changes of all ticks
  void write(const base::TickRecord& record) override {
    for (const base::ReadingBlock& reading : record.readings)
      ranges.assign(reading.values.begin(), reading.values.end());
    lights.assign(record.lights.begin(), record.lights.end());
    states.assign(record.reports.begin(), record.reports.end());
    shapes += record.shapes.size();
  }
};

/// A service, with two copies of `name` that may join, and its robot.
struct Hall {
  explicit Hall(const std::string& name, const std::vector<netio::Peer>& peers = {},
                estimation::StalePolicy policy = estimation::StalePolicy::hide)
      : world(world::read_world(kRoomText, {.sensors = sensors::world_file_words()})) {
    ServiceOptions options{
        .receiver = {.bind = {netio::kLoopback, 0}, .log_descriptor = log.descriptor(), .peers = peers}};
    options.receiver.filter.policy = policy;
    if (!name.empty()) {
      const std::uint32_t ids[] = {kFirstId, kFirstId + 1};
      const std::uint32_t row = append_joining(world, joining_template(world, name), ids);
      options.receiver.joining = {row, row + 1};
    }
    sensor_set.emplace(world);
    layout.bases[sensors::kLaser] = 1;  // to port 9, which discards
    service.emplace(world, *sensor_set, device(), layout, options);
    service->record_to(sink);
    robot.emplace(
        netio::V2vSocketOptions{.farm = {netio::kLoopback, service->port()}, .robot = 1, .lights = {kFirstId}});
    guest.emplace(netio::V2vSocketOptions{.farm = {netio::kLoopback, service->port()}, .robot = kFirstId});
  }
  static gpu::Device& device() {
    static gpu::Device device;
    return device;
  }
  /// @param say called before each tick
  const std::vector<double>& see(int ticks, const std::function<void()>& say = {}) {
    for (int i = 0; i < ticks; ++i, now += kTick, ++sequence) {
      netio::encode({.robot = 1, .sequence = sequence}, netio::V2v{.X_WR = {-2.0, 0.0, 0.0, 0.0}}, bytes);
      robot->send(bytes);
      netio::encode({.robot = 1, .sequence = sequence}, netio::Subscribe{netio::kNeighboursBit | 1u << sensors::kLaser},
                    bytes);
      robot->send(bytes);
      if (say) say();
      service->tick(now);
      for (auto* socket : {&*robot, &*guest})
        socket->receive([&](std::span<const std::uint8_t> one) {
          netio::Packet packet;
          if (socket->accept(one, now, packet) != netio::PacketStatus::accepted) return;
          if (const auto* v2i = std::get_if<netio::V2i>(&packet.body)) relayed = netio::approach_at(*v2i, 0);
        });
    }
    return sink.ranges;
  }
  void tag(double x, const std::optional<netio::SigningKey>& key = std::nullopt) {
    netio::encode({.robot = kFirstId, .sequence = sequence},
                  netio::Tag{.position = {x, 0.0, 0.0}, .orientation = {0, 0, 0, 1}}, bytes);
    if (!key) return guest->send(bytes);
    if (!signer) signer.emplace(*key);
    signer->sign(bytes);
    outbox.queue({netio::kLoopback, service->port()}, bytes);
    outbox.flush();
  }
  void object(const netio::Object& state) {
    netio::encode({.robot = kFirstId, .sequence = sequence}, state, bytes);
    guest->send(bytes);
  }
  void light(double x, world::LightState state) {
    base::Bytes rows;
    netio::put(netio::SignalApproach{.state = static_cast<std::uint8_t>(state), .X_WL = {x, 0.0, 0.0, 0.0}}, rows);
    netio::encode({.robot = kFirstId, .sequence = sequence}, netio::V2i{rows, {}}, bytes);
    guest->send(bytes);
  }
  std::uint64_t received(netio::PacketStatus status) const { return service->stats().inbox[status]; }

  world::World world;
  std::optional<sensors::SensorSet> sensor_set;
  StreamLayout layout;
  netio::LogPipe log;
  Newest sink;
  std::optional<Service> service;
  std::optional<netio::V2vSocket> robot, guest;
  std::optional<netio::PacketSigner> signer;
  netio::Outbox outbox;
  std::optional<netio::SignalApproach> relayed;  ///< newest one that the robot received
  std::uint32_t sequence = 0;
  std::int64_t now = 0;
  base::Bytes bytes;
};

constexpr int kGone = 21;  // [ticks] of silence, and one

/// Each template: a tag, its type of objects, and a static model with a part.
TEST(Joining, ObjectsJoinByTheirFirstStateAndLeaveWithoutATrace) {
  for (const auto policy : {estimation::StalePolicy::hide, estimation::StalePolicy::freeze})
    for (const auto& [name, depth] : {std::pair<std::string, double>{"tag9", 0.2}, {"box", 0.2}}) {
      Hall empty(""), hall(name, {}, policy);
      const std::vector<double> alone = empty.see(5);
      ASSERT_EQ(hall.see(5), alone) << name << ": nothing has joined";
      EXPECT_NEAR(hall.see(3, [&] { hall.tag(1.0); })[45], 2.9 - depth, 1e-9) << name;
      EXPECT_NEAR(hall.see(3, [&] { hall.tag(0.5); })[45], 2.4 - depth, 1e-9) << "it moves";
      EXPECT_TRUE(base::is_absent(hall.sink.states.back().X_WM)) << "the other copy";
      EXPECT_EQ(hall.see(kGone), alone) << "silent for 2 s";
      EXPECT_NEAR(hall.see(3, [&] { hall.tag(1.0); })[45], 2.9 - depth, 1e-9) << "joins again";
      EXPECT_EQ(hall.see(3, [&] { hall.tag(1.0), hall.object({.present = false}); }), alone)
          << "removed while it is tracked";
      hall.see(kGone);
      EXPECT_NEAR(hall.see(3, [&] { hall.tag(1.0); })[45], 2.9 - depth, 1e-9) << "the next one is not removed";
    }
}

/// The robot sees the new outline, and the next object with the id does not have it. The other copy keeps its own.
TEST(Joining, ShapesChangeUntilTheirObjectLeaves) {
  Hall hall("tag9");
  hall.service->change_shapes_in(hall.world);
  const auto depth = [&](const netio::Object& object) {
    return 2.9 - hall.see(3, [&] { hall.tag(1.0), hall.object(object); })[45];
  };
  EXPECT_NEAR(depth({}), 0.2, 1e-9);
  EXPECT_NEAR(depth({.shape = "crate"}), 0.4, 1e-9);
  EXPECT_NEAR(depth({.color = 0xFF00FF00u}), 0.4, 1e-9);
  EXPECT_NEAR(depth({.size = std::array{0.5, 0.5, 0.2}}), 0.25, 1e-9);
  EXPECT_NEAR(depth({.shape = "original"}), 0.2, 1e-9);
  EXPECT_NEAR(depth({.shape = "crate"}), 0.4, 1e-9);
  hall.see(kGone);
  EXPECT_NEAR(depth({}), 0.2, 1e-9) << "the next one has its own shape";
  EXPECT_EQ(hall.world.movers[hall.world.movers.size() - 1].body.size(), 4u);
  EXPECT_EQ(hall.sink.shapes, 6u) << "repeated OBJECTs change nothing";
}

TEST(Joining, ShapesThatDoNotExistAreLogged) {
  for (const bool allowed : {false, true}) {
    Hall hall("tag9");
    if (allowed) hall.service->change_shapes_in(hall.world);
    const std::vector<double> before = hall.see(3, [&] { hall.tag(1.0); });
    EXPECT_EQ(hall.see(3, [&] { hall.tag(1.0), hall.object({.shape = "crat"}); }), before);
    expect_in(allowed ? "test.world: has no shape 'crat'; did you mean 'crate'? Expected one of: "
                        "original, crate"
                      : "OBJECT for tag 40: shapes do not change in this service",
              hall.log.read_all());
  }
}

/// Changes between two rebuilds are combined: the newest shape, with the colour and size after it.
TEST(Joining, ShapesChangeAtMostOncePerPeriod) {
  Hall hall("tag9");
  hall.service->change_shapes_in(hall.world);
  hall.see(3, [&] { hall.tag(1.0); });
  const auto range = [&](const netio::Object& object) {
    hall.object(object);
    ++hall.sequence;
    hall.service->sample(hall.now += 1'000'000);
  };
  range({.size = std::array{0.6, 0.6, 0.2}});
  range({.shape = "crate"});
  range({.size = std::array{1.0, 0.6, 0.2}});
  EXPECT_NEAR(hall.sink.ranges[45], 2.7, 1e-9) << "only at ticks";
  EXPECT_NEAR(hall.see(2, [&] { hall.tag(1.0); })[45], 2.4, 1e-9);
}

TEST(Joining, ALightIsWhereItsPacketsSayAndIsDarkOnceSilent) {
  Hall empty(""), hall("light1");
  const std::vector<double> alone = empty.see(5);
  ASSERT_EQ(hall.see(5), alone);
  EXPECT_EQ(hall.sink.lights.size(), 3u);
  const auto state = [&] { return static_cast<world::LightState>(hall.sink.lights[1].state); };
  EXPECT_EQ(state(), world::LightState::dark) << "not by the plan of its template";
  EXPECT_NEAR(hall.see(4, [&] { hall.light(1.0, world::LightState::red); })[45], 2.9 - 0.02, 1e-9) << "its post";
  EXPECT_EQ(state(), world::LightState::red);
  EXPECT_EQ(hall.sink.lights[0].state, static_cast<std::uint8_t>(world::LightState::green)) << "the world's own";
  EXPECT_EQ(hall.see(kGone), alone);
  EXPECT_EQ(state(), world::LightState::dark);
}

TEST(Joining, OnlyTheOwnerOfAKeyJoins) {
  Hall empty(""), hall("tag9", {{netio::PeerKind::tag, kFirstId, std::nullopt, kGuestKey}});
  const std::vector<double> alone = empty.see(5);
  EXPECT_EQ(hall.see(5, [&] { hall.tag(1.0); }), alone);
  EXPECT_EQ(hall.received(netio::PacketStatus::not_signed), 5u);
  EXPECT_NEAR(hall.see(3, [&] { hall.tag(1.0, kGuestKey); })[45], 2.7, 1e-9);
}

/// Robots in radio range receive its V2I, which states where it is, and none before and after.
TEST(Joining, RobotsReceiveTheLight) {
  Hall hall("light1");
  hall.see(5);
  EXPECT_FALSE(hall.relayed);
  hall.see(5, [&] { hall.light(1.0, world::LightState::red); });
  ASSERT_TRUE(hall.relayed);
  EXPECT_EQ(hall.relayed->X_WL.x, 1.0);
  EXPECT_EQ(hall.relayed->state, static_cast<std::uint8_t>(world::LightState::red));
  hall.see(kGone);
  hall.relayed.reset();
  hall.see(5);
  EXPECT_FALSE(hall.relayed);
}

}  // namespace
}  // namespace sf::server
