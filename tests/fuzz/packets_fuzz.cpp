// libFuzzer target: any bytes through the decoder, the inbox' rules and the listener's with the laser's payload checks,
// without a socket.
//
//   cmake -S . -B build/fuzz -G Ninja -DSENSORFARM_FUZZ=ON -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang
//   ninja -C build/fuzz packets_fuzz && build/fuzz/packets_fuzz -max_total_time=60
//
// An input is a sequence of datagrams: one byte of sender and elapsed time, two of length, then the bytes. A token of 0
// is replaced by the sender's own token, which no input could guess.

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <variant>

#include "netio/inbox.h"
#include "netio/receiver.h"
#include "netio/relay.h"
#include "netio/stream_monitor.h"
#include "netio/v2v_socket.h"
#include "sensors/laser_packets.h"
#include "tests/fuzz/require.h"

namespace {

using namespace sf;

void examine(const netio::Packet& packet) {
  require(packet.header.time >= 0 && packet.header.time <= netio::kMaxTime);
  if (const auto* state = std::get_if<netio::V2v>(&packet.body)) {
    require(std::abs(state->X_WR.x) <= netio::kMaxPosition && std::abs(state->velocity.turn) <= netio::kMaxSpeed);
  }
  if (const auto* tag = std::get_if<netio::Tag>(&packet.body)) {
    require(std::isfinite(netio::report(packet.header, *tag, 0).X_WM.yaw));
  }
}

/// Returns the bytes that the long form of a packet has in addition, and that encoding leaves out if they say what the
/// short form says: no types above 31, no tilt.
std::size_t bytes_of_default(netio::Type type) {
  if (type == netio::Type::subscribe) return netio::kWideSubscribeBytes - netio::kSubscribeBytes;
  return type == netio::Type::v2v ? netio::kTiltBytes : 0;
}

/// Accepted packets keep their meaning when encoded and decoded again.
void round_trip(const netio::Packet& packet, std::span<const std::uint8_t> bytes) {
  base::Bytes again;
  std::visit(
      [&]<class Body>(const Body& body) {
        if constexpr (!std::is_same_v<Body, netio::Reading>) netio::encode(packet.header, body, again);
      },
      packet.body);
  const std::size_t trailer = bytes[60] | std::size_t{bytes[61]} << 8, written = again.size();
  require(trailer <= netio::kMaxTrailer);
  if (bytes.size() - trailer == written + bytes_of_default(packet.header.type)) again.resize(bytes.size() - trailer);
  require(again.size() + trailer == bytes.size());
  const bool v2i = packet.header.type == netio::Type::v2i, v2v = packet.header.type == netio::Type::v2v;
  const auto reserved = [&](std::size_t i) {
    return i == 10 || i == 11 || (i >= 32 && i < netio::kHeaderBytes) || (v2i && i >= 68 && i < 72) ||
           (v2v && i >= written);  // 0 or -0
  };
  for (std::size_t i = 0; i < again.size(); ++i) require(again[i] == bytes[i] || reserved(i));
}

/// An unproven address is never sent more bytes than it has sent.
void challenge(netio::Inbox& inbox, const netio::Packet& packet, const netio::Endpoint& source, std::size_t size,
               std::int64_t now) {
  base::Bytes answer;
  require(packet.header.token != inbox.token(source));
  if (!inbox.challenge(packet, source, now, answer)) return;
  require(answer.size() <= size);
  netio::Packet asked;
  require(netio::decode(answer, asked) == netio::PacketStatus::accepted);
  require(std::get<netio::Challenge>(asked.body).token == inbox.token(source));
}

/// A laser of 3 beams up to 8 m, and an arbitrary one: the two streams of the listener below.
sensors::SensorSpec laser_of(std::size_t stream) {
  sensors::SensorSpec row;
  row.elements = stream == 0 ? 3 : 0;
  row.limit = stream == 0 ? 8.0 : 100.0;
  return row;
}

netio::PayloadInfo inspect_scan(std::size_t stream, const netio::Header& header,
                                std::span<const std::uint8_t> payload) {
  const auto type = static_cast<std::uint8_t>(header.type);
  const sensors::PayloadPart part = sensors::decode_laser(laser_of(stream), payload, type, sensors::WireFormat::farm);
  if (part.fault != sensors::PayloadError::none) return {netio::PacketStatus::out_of_range};

  sensors::LaserPart scan;
  require(sensors::read_laser(payload, type > sensors::kExtended, scan) == sensors::PayloadError::none);
  require(std::uint64_t{scan.first} + scan.count <= scan.total && scan.part < scan.parts);
  for (std::uint32_t i = 0; i < scan.count; ++i) require(sensors::range_of(scan, i) >= 0.0);
  return {netio::PacketStatus::accepted, part.elements, part.part, part.parts};
}

const netio::V2v* state_of(const netio::Packet& packet) { return std::get_if<netio::V2v>(&packet.body); }

/// The robot's side of the same two streams: the newest reading is complete, and within the sensor's range.
void receive(std::size_t stream, std::span<const std::uint8_t> bytes, std::int64_t now) {
  static const auto read = [](std::size_t, const netio::Header&, std::span<const std::uint8_t> payload,
                              std::span<double> values) { values[0] = static_cast<double>(payload.size()); };
  static netio::Receiver receiver(
      {.streams = {{{.robot = 7}, 1}, {{.robot = 7, .sensor = 1}, 1}}, .inspect = inspect_scan, .read = read});
  const netio::PartStatus taken = receiver.accept(stream, bytes, now);
  const auto newest = receiver.newest(stream);
  if (taken == netio::PartStatus::complete) require(newest && newest->arrival == now && newest->values[0] > 0.0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static netio::Inbox inbox({.bind = {netio::kLoopback, 0},
                             .robots = {0, 7, 40'000},
                             .tags = {1, 12},
                             .peers = {{netio::PeerKind::tag, 1, std::nullopt, netio::SigningKey{}}},
                             .lights = {2}});
  static const std::uint32_t free_base =
      20'000 + static_cast<std::uint32_t>(getpid()) % 5'000 * 2;  // allows several fuzzers to run concurrently
  static netio::StreamMonitor monitor(
      {.streams = {{.robot = 7, .rule = {free_base, 8}}, {.robot = 7, .sensor = 1, .rule = {free_base, 8}}},
       .inspect = inspect_scan});
  static netio::Relay relay(std::vector<std::uint32_t>{0, 7, 40'000}, {}, std::vector<std::uint32_t>{2});
  static netio::Outbox nowhere({.patience_ms = 0});
  static netio::V2vSocket v2v_socket({.robot = 7, .others = {0, 40'000}, .session = 7, .lights = {2}});
  static std::int64_t now = 0;

  base::ByteReader reader({data, size});
  while (reader.left() > 3) {
    const auto sender = reader.get<std::uint8_t>();
    const auto length = reader.get<std::uint16_t>();
    const auto given = reader.get_bytes(std::min<std::size_t>(length, reader.left()));
    now += std::int64_t{sender >> 2} * 100'000'000;

    netio::Packet packet;
    const netio::Endpoint source{netio::kLoopback, static_cast<std::uint16_t>(sender & 3)};
    base::Bytes bytes(given.begin(), given.end());
    if (netio::decode(bytes, packet) == netio::PacketStatus::accepted && packet.header.token == 0)
      netio::write_session_token(bytes, {packet.header.session, inbox.token(source)});
    const netio::PacketStatus reason = inbox.accept(bytes, source, now, packet);
    if (reason == netio::PacketStatus::unproven) challenge(inbox, packet, source, bytes.size(), now);
    if (reason == netio::PacketStatus::accepted) {
      examine(packet);
      round_trip(packet, bytes);
      const std::uint32_t id = packet.header.robot;
      const bool of_robot = packet.header.type == netio::Type::v2v || packet.header.type == netio::Type::subscribe;
      if (of_robot) require(inbox.is_active(id, now) && inbox.address(id) == source);
      relay.take(packet);
    }
    monitor.accept(sender & 1, given, source, now);
    receive(sender & 1, given, now);
    netio::V2vSocket::for_each_state(given, [&](std::span<const std::uint8_t> one) {
      if (v2v_socket.accept(one, now, packet) == netio::PacketStatus::accepted)
        require(packet.header.robot != 7 || !state_of(packet));
    });
    if (sender % 8 == 0) relay.forward(inbox, now, nowhere);
  }
  return 0;
}
