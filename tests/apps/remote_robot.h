#pragma once
// Robots in other processes and a service for them: two robots in a room, over loopback.

#include <gtest/gtest.h>

#include <cstdlib>

#include "netio/packets.h"
#include "netio/socket.h"
#include "netio/v2v_socket.h"
#include "sensors/laser_packets.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {

// Two robots in a room; `sense` computes their expected readings.
inline const char* const kRoom = R"(
model( name "room" size [6 4 1] boundary 1 noblocks 0 color "gray" )
define bot position( size [0.3 0.3 0.1] laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] ) )
bot( name "roomba1" pose [-2 0 0 0] )
bot( name "roomba2" pose [2 1 0 0] )
)";

/// A remote robot: one socket to send from, one to receive its sensor on.
class Robot {
 public:
  Robot(std::uint16_t id, unsigned service, unsigned port)
      : id_(id),
        v2v_socket_({.farm = {netio::kLoopback, static_cast<std::uint16_t>(service)},
                     .robot = id,
                     .others = {id == 1 ? 2u : 1u}}),
        socket_(netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(port)})),
        batch_(16) {}

  base::Bytes state(const base::Pose& X_WR, std::uint32_t follows = netio::kNone) {
    netio::Header header;
    header.robot = id_;
    header.sequence = sequence_++;
    netio::V2v state;
    state.X_WR = X_WR;
    state.follows = follows;
    base::Bytes bytes;
    netio::encode(header, state, bytes);
    return bytes;
  }
  void send_state(const base::Pose& X_WR, std::uint32_t follows = netio::kNone) { send(state(X_WR, follows)); }
  void send(const base::Bytes& bytes) {
    challenged();
    v2v_socket_.send(bytes);
  }
  /// True once the farm has challenged its address. The answer proves it.
  bool challenged() {
    v2v_socket_.receive([&](std::span<const std::uint8_t> bytes) {
      netio::Packet packet;
      if (v2v_socket_.accept(bytes, 0, packet) == netio::PacketStatus::accepted &&
          packet.header.type == netio::Type::v2v)
        ++states_;
    });
    return v2v_socket_.farm_session_token().session != 0;
  }

  /// Requests readings of its laser and the states of the other.
  void ask() {
    base::Bytes bytes;
    netio::encode({.robot = id_, .sequence = requests_++}, netio::Subscribe{netio::kNeighboursBit | 1u << 1}, bytes);
    send(bytes);
  }
  std::size_t states() const { return states_; }  ///< number of states of the other received

  void leave() {
    base::Bytes bytes;
    netio::encode({.robot = id_}, netio::Leave{}, bytes);
    send(bytes);
  }

  /// True if a reading for `other` arrives at this robot.
  bool receives_for(const Robot& other) {
    bool found = false;
    batch_.drain(socket_, kMost, [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) {
      netio::Packet packet;
      EXPECT_EQ(netio::decode(bytes, packet), netio::PacketStatus::accepted);
      found = found || packet.header.token == other.v2v_socket_.farm_session_token().token;
    });
    return found;
  }

  /// Returns the ranges of the newest pending scan; empty if there is none.
  std::vector<double> receive() {
    std::vector<double> ranges;
    batch_.drain(socket_, kMost, [&](std::span<const std::uint8_t> datagram, const netio::Endpoint&) {
      netio::Packet packet;
      EXPECT_EQ(netio::decode(datagram, packet), netio::PacketStatus::accepted);
      EXPECT_EQ(packet.header.robot, id_);
      EXPECT_EQ(packet.header.sensor, 0u);
      stamps_.push_back(packet.header.time);
      EXPECT_EQ(packet.header.session, v2v_socket_.farm_session_token().session);
      EXPECT_EQ(packet.header.token, v2v_socket_.farm_session_token().token);
      sensors::LaserPart scan;
      EXPECT_EQ(sensors::read_laser(std::get<netio::Reading>(packet.body).payload, false, scan),
                sensors::PayloadError::none);
      ranges.clear();
      for (std::uint32_t k = 0; k < scan.count; ++k) ranges.push_back(sensors::range_of(scan, k));
    });
    return ranges;
  }

  /// Returns the measurement times [ns] of the scans received so far, on the farm's clock.
  const std::vector<std::int64_t>& stamps() const { return stamps_; }

 private:
  static constexpr std::size_t kMost = 65'536;  ///< datagrams at a time

  std::vector<std::int64_t> stamps_;
  std::uint16_t id_;
  netio::V2vSocket v2v_socket_;
  netio::Socket socket_;
  netio::ReceiveBatch batch_;
  std::uint32_t sequence_ = 0;
  std::uint32_t requests_ = 0;
  std::size_t states_ = 0;
};

/// Sends states until it is challenged.
inline bool prove(Robot& robot) {
  return until([&] {
    if (robot.challenged()) return true;
    robot.send_state({});
    return false;
  });
}

struct Service {
  Folder folder;
  std::string world;
  unsigned lasers = free_ports(24);
  Program program;
  unsigned port = 0;

  /// @param rate of ticks; empty: the world's
  explicit Service(const std::string& text = kRoom, const Words& rate = {"--rate", "50"})
      : world(folder.write("room.world", text)), program(words(rate)) {
    if (!program.prints("; press Ctrl-C to stop")) return;
    const std::string message = program.err();
    port = static_cast<unsigned>(std::atoi(message.c_str() + message.find("127.0.0.1:") + 10));
  }
  unsigned laser_port(unsigned robot) const { return lasers + 8 * robot; }

 private:
  Words words(const Words& rate) const {
    return with({"serve", world, "--port", "0", "--json", "--laser-port", std::to_string(lasers)}, rate);
  }
};

/// The room with lasers at 50 Hz; the world has 10 ticks per second.
inline std::string fast_room() {
  std::string text = kRoom;
  return text.replace(text.find("samples 91"), 10, "samples 91 rate 50");
}

inline std::vector<double> sensed(const std::string& world, const std::string& robot, const std::string& pose) {
  const Json scan(run_program({"sense", world, "--robot", robot, "--pose", pose, "--json"}).out);
  std::vector<double> ranges;
  for (std::size_t i = 0; i < scan.size("/beams"); ++i)
    ranges.push_back(scan.number("/beams/" + std::to_string(i) + "/range_m"));
  return ranges;
}

}  // namespace sf
