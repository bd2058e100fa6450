// libFuzzer target: any bytes through the decoder, the inbox' rules and the listener's, without a socket in the way.
//
//   cmake -S . -B build/fuzz -G Ninja -DSENSORFARM_FUZZ=ON -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang
//   ninja -C build/fuzz packets_fuzz && build/fuzz/packets_fuzz -max_total_time=60
//
// An input is a row of datagrams: one byte of sender and elapsed time, two of length, then the bytes.

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "netio/inbox.h"
#include "netio/listener.h"

namespace {

using namespace sf;

void require(bool holds) {
  if (!holds) std::abort();
}

void examine(const netio::Packet& packet) {
  require(packet.header.time >= 0 && packet.header.time <= netio::kMaxTime);
  if (const auto* state = std::get_if<netio::V2v>(&packet.body)) {
    require(std::abs(state->X_WR.x) <= netio::kMaxPosition && std::abs(state->velocity.turn) <= netio::kMaxSpeed);
  }
  if (const auto* tag = std::get_if<netio::Tag>(&packet.body)) {
    require(std::isfinite(netio::report(packet.header, *tag, 0).X_WM.yaw));
  }
}

/// What was accepted must say the same when it is written and read again.
void round_trip(const netio::Packet& packet, std::span<const std::uint8_t> bytes) {
  base::Bytes again;
  if (const auto* state = std::get_if<netio::V2v>(&packet.body)) netio::encode(packet.header, *state, again);
  if (const auto* state = std::get_if<netio::Tag>(&packet.body)) netio::encode(packet.header, *state, again);
  if (const auto* request = std::get_if<netio::Subscribe>(&packet.body)) netio::encode(packet.header, *request, again);
  require(again.size() == bytes.size());
  for (std::size_t i = 0; i < again.size(); ++i) require(again[i] == bytes[i] || i == 10 || i == 11);  // reserved
}

void read_scan(std::span<const std::uint8_t> bytes) {
  netio::Packet packet;
  if (netio::decode(bytes, packet) != netio::Reason::accepted) return;
  const auto* scan = std::get_if<netio::LaserPart>(&packet.body);
  if (scan == nullptr) return;
  require(std::uint64_t{scan->first} + scan->count <= scan->total && scan->part < scan->parts);
  for (std::uint32_t i = 0; i < scan->count; ++i) require(netio::range(*scan, i) >= 0.0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static netio::Inbox inbox({.bind = {netio::kLoopback, 0}, .robots = {0, 7, 40'000}, .tags = {1, 12}});
  static const std::uint32_t free_base =
      20'000 + static_cast<std::uint32_t>(getpid()) % 5'000 * 2;  // for fuzzers side by side
  static netio::Listener listener({.streams = {{.robot = 7, .samples = 3, .range_max = 8.0, .rule = {free_base, 8}},
                                               {.robot = 7, .sensor = 1, .range_max = 100.0, .rule = {free_base, 8}}}});
  static std::int64_t now = 0;

  base::ByteReader reader({data, size});
  while (reader.left() > 3) {
    const auto sender = reader.get<std::uint8_t>();
    const auto length = reader.get<std::uint16_t>();
    const auto bytes = reader.get_bytes(std::min<std::size_t>(length, reader.left()));
    now += std::int64_t{sender >> 2} * 100'000'000;

    netio::Packet packet;
    const netio::Endpoint source{netio::kLoopback, static_cast<std::uint16_t>(sender & 3)};
    if (inbox.accept(bytes, source, now, packet) == netio::Reason::accepted) {
      examine(packet);
      round_trip(packet, bytes);
      const std::uint32_t id = packet.header.robot;
      if (packet.header.type != netio::Type::tag) require(inbox.heard(id, now) && inbox.address(id) == source);
    }
    read_scan(bytes);
    listener.accept(sender & 1, bytes);
  }
  return 0;
}
