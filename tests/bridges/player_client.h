#pragma once
// A client of the Player server for tests, and a world for it. The answer to a request proves that everything sent and
// published before it has been processed.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bridges/player_bridge.h"
#include "netio/player/xdr.h"
#include "sensors/sensor_set.h"

namespace sf::bridges::player {

inline world::World load_text(const std::string& text) {
  const std::string file = (std::filesystem::temp_directory_path() / "player.world").string();
  std::ofstream(file) << text;
  return world::load_world(file, {.sensors = sensors::world_file_words()});
}

/// A wall, a robot with one sensor of each type that Player supports, and one with a laser.
inline const char* const kTwoRobots = R"(
name "two"
define wall model( size [0.2 6 1] )
wall( name "west" pose [-3.9 0 0 0] )
wall( name "east" pose [3.9 0 0 0] )
position
(
  name "ann" pose [-1 0 0 90] size [0.4 0.3 0.2]
  velocity_bounds [-0.5 0.5 0 0 0 0 -90 90]
  laser( name "front" pose [0.1 0 0 0] size [0.1 0.1 0.1] samples 3 fov 180 range_max 8 rate 5 )
  sonar( name "ring" scount 2 spose[0] [0.1 0.05 45] spose[1] [0.1 -0.05 -45] range [0.1 4] fov 20 )
  infrared( name "near" scount 2 spose[0] [0.1 0 0] spose[1] [-0.1 0 180] range [0.02 0.5] )
  bumper( name "bump" zones 2 zone[0] [0 90] zone[1] [-90 0] )
  gps( name "fix" satellites 8 )
)
position
(
  name "ben" pose [1 1 0 0] size [0.4 0.3 0.2]
  laser( name "front" samples 3 fov 180 range_max 8 )
)
)";

/// Everything that a bridge needs, and ticks created by the test.
struct PlayerRun {
  explicit PlayerRun(const char* text = kTwoRobots, bool simulated = true)
      : world(load_text(text)), sensor_set(world), scene{world, sensor_set, info, simulated}, bridge(scene, {}) {
    for (std::uint32_t m = 0; m < world.movers.size(); ++m)
      reports.push_back({.mover = m, .X_WM = world.movers[m].X_WM});
    contacts.resize(reports.size());
    info.shape = {.cell = 0.5, .corner = {-4.0, -3.0}, .columns = 3, .rows = 2};
    info.shape.occupied = {true, false, false, false, false, true};
  }
  /// Publishes a tick with `readings`, 0.1 s after the last.
  void tick(std::vector<base::ReadingBlock> readings = {}) {
    base::TickRecord record;
    record.time = time += 100'000'000;
    record.reports = reports;
    record.contacts = contacts;
    record.readings = readings;
    bridge.publish(record, state);
  }
  /// Returns a reading of ann's sensor of that type.
  base::ReadingBlock reading(std::uint8_t type, const std::vector<double>& values, std::uint32_t sequence = 7) const {
    base::ReadingBlock block;
    block.type = type, block.sequence = sequence, block.time = 1'500'000'000, block.values = values;
    return block;
  }
  /// Returns a port of the server.
  /// @param robot 0: the port of all robots
  netio::Endpoint port(std::uint16_t robot = 0) const {
    const netio::Endpoint first = bridge.endpoint();
    return {first.address, static_cast<std::uint16_t>(first.port + robot)};
  }
  Requests asked() {
    Requests requests;
    bridge.take(requests);
    return requests;
  }

  world::World world;
  sensors::SensorSet sensor_set;
  record::RunInfo info;
  Scene scene;
  PlayerBridge bridge;
  std::vector<base::Report> reports;
  std::vector<std::uint8_t> contacts;
  RunState state;
  std::int64_t time = 0;  ///< [ns]
};

struct Message {
  Header header;
  base::Bytes payload;
  bool ended = false;  ///< nothing arrived: the server closed the connection
};

class TestClient {
 public:
  /// @param host own address; 0: any
  explicit TestClient(const netio::Endpoint& server, int buffer = 0, std::uint32_t host = 0)
      : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(host);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    if (buffer > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(server.address);
    address.sin_port = htons(server.port);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~TestClient() { close(socket_); }
  TestClient(const TestClient&) = delete;
  TestClient& operator=(const TestClient&) = delete;

  std::string banner() {
    const base::Bytes bytes = read(kBannerBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  void send(const base::Bytes& bytes) {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), bytes.size());
  }
  /// Returns false if the connection has ended.
  bool try_send(const base::Bytes& bytes) { return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0; }
  void send(MessageType type, const Address& to, std::uint32_t subtype, const base::Bytes& payload = {}) {
    base::Bytes bytes;
    put_header({.address = to,
                .type = type,
                .subtype = subtype,
                .sequence = 3,
                .size = static_cast<std::uint32_t>(payload.size())},
               bytes);
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    send(bytes);
  }
  /// Returns the next message; the test fails if none arrives.
  Message receive() {
    Message message;
    const base::Bytes header = read(kHeaderBytes);
    if (header.size() < kHeaderBytes) return message.ended = true, message;
    message.header = read_header(header);
    message.payload = read(message.header.size);
    return message;
  }
  /// Returns the answer to a request. Drops data that arrives before it.
  Message request(const Address& to, std::uint32_t subtype, const base::Bytes& payload = {}) {
    send(MessageType::request, to, subtype, payload);
    Message message;
    do message = receive();
    while (!message.ended && (message.header.type == MessageType::data || message.header.type == MessageType::sync));
    return message;
  }
  Message access(const Address& device, Access access) {
    base::Bytes payload;
    XdrWriter xdr(payload);
    xdr.put_all({0u, 0u, static_cast<std::uint32_t>(device.interf), device.index, static_cast<std::uint32_t>(access)});
    xdr.put_count(0);
    return request({}, server_request::device, payload);
  }
  Message open(const Address& device) { return access(device, Access::open); }
  void pull() { EXPECT_EQ(request({}, server_request::data_mode, {0, 0, 0, 2}).header.type, MessageType::ack); }

 private:
  base::Bytes read(std::size_t size) {
    constexpr int kPatience = 60'000;  // [ms] timeout of a failing test
    base::Bytes bytes(size);
    std::size_t have = 0;
    while (have < size) {
      pollfd readable{socket_, POLLIN, 0};
      if (poll(&readable, 1, kPatience) <= 0) return ADD_FAILURE() << "no data arrived", base::Bytes();
      const ssize_t n = recv(socket_, bytes.data() + have, size - have, 0);
      if (n <= 0) return {};
      have += static_cast<std::size_t>(n);
    }
    return bytes;
  }

  int socket_;
};

/// Returns a payload of numbers in XDR.
template <class... Numbers>
base::Bytes xdr_of(Numbers... numbers) {
  base::Bytes bytes;
  XdrWriter xdr(bytes);
  (xdr.put(numbers), ...);
  return bytes;
}

inline constexpr Address kPosition{Interface::position2d, 0};
inline constexpr Address kLaserDevice{Interface::laser, 0};
inline constexpr Address kSimulation{Interface::simulation, 0};

}  // namespace sf::bridges::player
