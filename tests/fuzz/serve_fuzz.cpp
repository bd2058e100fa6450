// libFuzzer target: the service under valid but hostile traffic, over loopback and with a simulated clock.
//
// An input is a sequence of actions: one byte of sender and action, then its fields (`Harness::act`). Senders are real
// sockets; three of four answer their CHALLENGE, so that most packets are accepted, and the fourth never does. After
// each tick all sent packets are received and checked: valid packets, for existing robots, in bounded number, and as
// many as the service counts.

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "netio/v2v_socket.h"
#include "sensors/laser.h"
#include "server/sensor_streams.h"
#include "server/service.h"
#include "tests/fuzz/require.h"
#include "tests/robots/scenes.h"
#include "tests/sensors/edit_laser.h"

namespace {

using namespace sf;

constexpr std::uint32_t kRobots = 3;
constexpr std::uint32_t kTag = 12;
constexpr std::int64_t kMilli = 1'000'000;  ///< [ns]
constexpr std::int64_t kSteps[] = {
    0, 1, kMilli, 20 * kMilli, 100 * kMilli, 700 * kMilli, 2'100 * kMilli, 12'000 * kMilli};

/// Three robots with a laser each, one of them delayed and one noisy, and a tag.
world::World make_world() {
  world::World world = scenes::boxed_world(8.0, 6.0, {-4.0, -3.0});
  for (std::uint32_t i = 0; i < kRobots; ++i) {
    world::Mover& robot = scenes::add_create(world, {2.0 * i - 2.0, 0.0, 0.0, 0.0});
    robot.sensors.push_back(
        sensors::laser_sensor({{.name = "laser", .X_MS = {0.0, 0.0, 0.05, 0.0}, .samples = 7}, 10.0 * (i + 1)}));
  }
  scenes::edit_laser(world.movers[1])->latency = 0.15;
  scenes::edit_laser(world.movers[2])->noise.range_sigma = 0.01;
  world::Mover& tag = scenes::add_square(world, {0.0, 2.0, 0.0, 0.0});
  tag.is_tag = true;
  tag.id = kTag;
  world.shapes.push_back({.name = "crate", .size = {0.4, 0.4, 0.4}, .outline = tag.body});
  return world;
}

/// Parts shared by all inputs. Traffic leaves no state in them.
struct Scene {
  world::World world = make_world();
  sensors::SensorSet sensor_set{world};
  std::vector<server::SensorStream> streams;
  gpu::Device device;
  netio::Socket sink = netio::open_udp({netio::kLoopback, 0}, {.receive = 4u << 20});  ///< of all readings
  server::StreamLayout layout;
  netio::Socket sockets[4] = {open(), open(), open(), open()};

  Scene() {
    layout.stride = 0;
    layout.bases[sensors::kLaser] = netio::bound_endpoint(sink).port;
    streams = server::sensor_streams(sensor_set, layout);
  }
  static netio::Socket open() { return netio::open_udp({netio::kLoopback, 0}, {.receive = 4u << 20}); }
  static Scene& get() {
    static Scene scene;
    return scene;
  }
};

/// A socket that sends what the input specifies, and has the service's token after a challenge.
struct Sender {
  const netio::Socket* socket = nullptr;
  std::optional<netio::Outbox> outbox;
  bool answers = true;  ///< answers its challenges
  netio::SessionToken session_token{1, 0};
  std::uint32_t sequence = 0;
  std::uint64_t sent = 0, received = 0;  ///< [byte]
};

class Harness {
 public:
  explicit Harness(Scene& scene)
      : scene_(scene),
        service_(scene.world, scene.sensor_set, scene.device, scene.layout,
                 {.receiver = {.bind = {netio::kLoopback, 0}, .radio = 5.0, .forget = 4.0, .log_descriptor = -1}}),
        farm_{netio::kLoopback, service_.port()} {
    for (std::size_t i = 0; i < 4; ++i) {
      senders_[i].socket = &scene.sockets[i];
      senders_[i].outbox.emplace(netio::duplicate(scene.sockets[i]));
      senders_[i].answers = i != 3;
      senders_[i].session_token.session = static_cast<std::uint32_t>(i + 1);
    }
    service_.change_shapes_in(scene.world);
    drain(false);  // datagrams for the previous service
  }
  ~Harness() { world::restore_originals(scene_.world); }
  /// Robots of the previous input have been silent for so long that they have left the world.
  void run(std::span<const std::uint8_t> input) {
    input_ = base::ByteReader(input);
    tick(12'000 * kMilli);
    while (input_.good() && input_.left() > 0) act();
    tick(100 * kMilli);
    tick(300 * kMilli);
    const server::ServiceStats stats = service_.stats();
    require(stats.publisher.not_numbers == 0);
    require(stats.publisher.packets.sent <= stats.farm.readings);
    require(stats.farm.readings >= stats.farm.reused);
  }

 private:
  void act() {
    const auto action = input_.get<std::uint8_t>();
    Sender& sender = senders_[action & 3];
    switch (action >> 2 & 7) {
      case 0:
        return tick(kSteps[action >> 5]);
      case 1:
        return sample(kSteps[action >> 5]);
      case 2:
        return send_raw(sender);
      case 3:
        netio::encode(header(), netio::Subscribe{input_.get<std::uint32_t>()}, packet_);
        break;
      case 4:
        return send_word(sender, action >> 5);
      case 5:
        netio::encode(tag_header(), tag(), packet_);
        break;
      default:
        netio::encode(header(), state(), packet_);
    }
    send(sender);
  }

  /// Robot, sequence and time in one byte each; most sequences increase.
  netio::Header header() {
    const auto robot = input_.get<std::uint8_t>();
    netio::Header header;
    header.robot = static_cast<std::uint16_t>(robot < 240 ? 1 + robot % kRobots : robot % 16);
    const auto delta = input_.get<std::int8_t>();
    sequence_ += static_cast<std::uint32_t>(delta > 96 ? 1 << 30 : delta);
    header.sequence = ++sequence_;
    const auto time = input_.get<std::uint8_t>();
    header.time = time < 200 ? now_ : time < 228 ? 0 : netio::kMaxTime;
    return header;
  }
  netio::Header tag_header() {
    netio::Header made = header();
    if (made.robot <= kRobots) made.robot = kTag;
    return made;
  }
  /// Uses one of two scales, chosen by each number's lowest bit: the room's, or the packet's limits.
  double number(double room, double most) {
    const auto word = input_.get<std::int16_t>();
    const double part = std::max(-1.0, word / 32'767.0);
    return part * ((word & 1) == 0 ? room : most);
  }
  netio::V2v state() {
    netio::V2v state;
    state.X_WR = {number(4.0, netio::kMaxPosition), number(3.0, netio::kMaxPosition), number(0.0, netio::kMaxPosition),
                  number(M_PI, netio::kMaxYaw)};
    state.velocity = {number(1.0, netio::kMaxSpeed), number(0.0, netio::kMaxSpeed), number(1.0, netio::kMaxSpeed)};
    const auto rest = input_.get<std::uint8_t>();
    state.docking = (rest & 1) != 0;
    if ((rest & 2) != 0) state.follows = rest >> 2;
    if ((rest & 4) != 0) state.checkpoint = 0xFFFFFFFEu;
    if ((rest & 8) != 0) state.tilt = {number(0.5, netio::kMaxRoll), number(0.5, netio::kMaxPitch)};
    return state;
  }
  netio::Tag tag() {
    netio::Tag tag;
    for (double& p : tag.position) p = number(3.0, netio::kMaxPosition);
    const double half = 0.5 * number(M_PI, M_PI), tilt = number(M_PI, M_PI);
    tag.orientation = {std::sin(half) * std::sin(tilt), 0.0, std::sin(half) * std::cos(tilt), std::cos(half)};
    for (double& v : tag.linear) v = number(1.0, netio::kMaxSpeed);
    for (double& w : tag.angular) w = number(1.0, netio::kMaxSpeed);
    return tag;
  }
  void send_word(Sender& sender, int which) {
    netio::Header made = header();
    if (which == 0) return netio::encode(made, netio::Leave{}, packet_), send(sender);
    if (which == 1) made.robot = netio::kBroadcastId;
    if (which < 4) return netio::encode(made, netio::Start{}, packet_), send(sender);
    if (which < 6) return netio::encode(made, netio::Challenge{made.sequence}, packet_), send(sender);
    sender.session_token.session += which == 6 ? 1 : 0;  // the sender restarts
    sender.session_token.token ^= which == 7 ? 1 : 0;    // its token is wrong until it is challenged
  }
  /// Sends a valid header of any type, then any bytes.
  void send_raw(Sender& sender) {
    netio::Header made = header();
    const auto type = input_.get<std::uint8_t>();
    const auto length = input_.get<std::uint8_t>();
    const auto given = input_.get_bytes(std::min<std::size_t>(length, input_.left()));
    netio::encode_reading(made, 1, given, packet_);
    packet_[5] = type;
    send(sender);
  }
  void send(Sender& sender) {
    netio::write_session_token(packet_, sender.session_token);
    sender.outbox->queue(farm_, packet_);
    sender.outbox->flush();
    sender.sent += packet_.size();
    ++sent_;
    if (sent_ % 16 == 0) receive();  // the kernel's buffer holds a few dozen
  }

  void receive() {
    service_.receive_pending(now_);
    const server::ServiceStats stats = service_.stats();
    require(stats.inbox.total() + stats.socket_drops == sent_);
    drain(true);
  }
  void tick(std::int64_t step) {
    receive();
    now_ += step;
    const server::ServiceStats before = service_.stats();
    service_.tick(now_);
    const server::ServiceStats after = service_.stats();
    // A robot receives the states of the others in one datagram, and signals for it and for all.
    require(after.relayed.datagrams - before.relayed.datagrams <= kRobots);
    require(after.relayed.starts - before.relayed.starts <= 2 * kRobots);
    check();
  }
  void sample(std::int64_t step) {
    receive();
    const std::int64_t due = service_.next_due();
    if (due >= now_ + step) return tick(step);
    now_ = std::max(now_, due);
    service_.sample(now_);
    check();
  }
  void check() {
    drain(true);
    const server::ServiceStats stats = service_.stats();
    require(stats.publisher.packets.sent + stats.answers.sent == received_);
    require(stats.publisher.packets.failed + stats.answers.failed == 0);
    for (const base::Report& state : service_.receiver().states(now_)) {
      require(std::isfinite(state.X_WM.x) && std::isfinite(state.X_WM.y) && std::isfinite(state.X_WM.yaw));
      require(std::abs(state.X_WM.x) < 2.0 * netio::kMaxPosition && std::abs(state.X_WM.y) < 2.0 * netio::kMaxPosition);
      require(state.time <= now_);
    }
  }

  void drain(bool examined) {
    const auto drain_one = [&](const netio::Socket& socket, auto&& take) {
      while (const std::size_t count = batch_.fill(socket))
        for (std::size_t i = 0; i < count; ++i)
          if (examined && batch_.source(i) == farm_) ++received_, take(batch_.bytes(i));
    };
    drain_one(scene_.sink, [&](std::span<const std::uint8_t> bytes) { examine_reading(bytes); });
    for (Sender& sender : senders_) {
      drain_one(*sender.socket, [&](std::span<const std::uint8_t> bytes) { examine_answer(sender, bytes); });
      require(sender.answers || sender.received <= sender.sent);
    }
  }
  void examine_reading(std::span<const std::uint8_t> bytes) {
    netio::Packet packet;
    require(netio::decode(bytes, packet) == netio::PacketStatus::accepted);
    require(packet.header.robot >= 1 && packet.header.robot <= kRobots && packet.header.sensor == 0);
    require(packet.header.time <= now_);
    const auto payload = std::get<netio::Reading>(packet.body).payload;
    const server::SensorStream& stream = scene_.streams[packet.header.robot - 1u];
    require(server::inspect_payload(stream, sensors::WireFormat::farm, packet.header, payload).status ==
            netio::PacketStatus::accepted);
    double ranges[7] = {};
    server::decode_payload(stream, sensors::WireFormat::farm, packet.header, payload, ranges);
    for (const double range : ranges) require(range >= 0.0 && range <= 8.0);
  }
  void examine_answer(Sender& sender, std::span<const std::uint8_t> bytes) {
    sender.received += bytes.size();
    netio::V2vSocket::for_each_state(bytes, [&](std::span<const std::uint8_t> one) {
      netio::Packet packet;
      require(netio::decode(one, packet) == netio::PacketStatus::accepted);
      if (const auto* challenge = std::get_if<netio::Challenge>(&packet.body)) {
        if (sender.answers) sender.session_token.token = challenge->token;
        return;
      }
      require(packet.header.type == netio::Type::v2v || packet.header.type == netio::Type::start);
      const bool known = packet.header.robot >= 1 && packet.header.robot <= kRobots;
      require(known || packet.header.robot == netio::kBroadcastId);
    });
  }

  Scene& scene_;
  base::ByteReader input_{{}};
  server::Service service_;
  netio::Endpoint farm_;
  Sender senders_[4];
  netio::ReceiveBatch batch_{64};
  base::Bytes packet_;
  std::uint32_t sequence_ = 0;
  std::uint64_t sent_ = 0, received_ = 0;  ///< datagrams of all senders together
  std::int64_t now_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Creating a service takes long, so it processes many inputs in sequence.
  constexpr int kInputs = 1000;
  Scene& scene = Scene::get();  // outlives the harness
  static std::optional<Harness> harness;
  static int inputs = 0;
  if (inputs++ % kInputs == 0) harness.emplace(scene);
  harness->run({data, size});
  return 0;
}
