// libFuzzer target: any datagrams through a robot's V2V without the farm, over loopback and with a simulated clock.
//
// An input is one byte, whose first bit gives the group a key, and a sequence of datagrams: one byte of sender,
// signature and elapsed time, two of length, then the bytes.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>

#include "base/bytes.h"
#include "netio/direct_v2v.h"
#include "tests/fuzz/require.h"

namespace {

using namespace sf;

constexpr std::uint32_t kOwn = 1, kOther = 2, kOfSeeds = 7;
constexpr double kRadio = 50.0;  // [m]
constexpr netio::SigningKey kGroup{9};

/// A robot at the origin, and two senders.
struct Radio {
  netio::DirectV2v robot;
  netio::Outbox senders[2] = {netio::Outbox({.bind = {netio::kLoopback, 0}}),
                              netio::Outbox({.bind = {netio::kLoopback, 0}})};
  netio::PacketSigner signer{kGroup};
  std::int64_t now = 0;
  std::uint64_t sent = 0, not_admitted = 0;
  bool has_state[kOfSeeds + 1] = {};

  explicit Radio(bool signs)
      : robot({.bind = {netio::kLoopback, 0},
               .radio = kRadio,
               .robot = kOwn,
               .others = {kOfSeeds, kOther},
               .table = signs ? std::vector<netio::Peer>{{netio::PeerKind::group, 0, std::nullopt, kGroup}}
                              : std::vector<netio::Peer>{},
               .session = 1}) {
    robot.set_position({0.0, 0.0});
  }

  void send(std::uint8_t how, std::span<const std::uint8_t> given) {
    base::Bytes bytes(given.begin(), given.end());
    netio::Packet packet;
    if ((how & 2) != 0 && netio::decode(bytes, packet) == netio::PacketStatus::accepted) signer.sign(bytes);
    netio::Outbox& sender = senders[how & 1];
    sender.queue({netio::kLoopback, robot.port()}, bytes);
    sender.flush();
    ++sent;
    robot.receive(now, [&](std::span<const std::uint8_t> one) { take(one); });
  }

  /// States are those of other robots of the world, within radio range. Maps follow a state.
  void take(std::span<const std::uint8_t> bytes) {
    netio::Packet packet;
    require(netio::decode(bytes, packet) == netio::PacketStatus::accepted);
    const std::uint32_t id = packet.header.robot;
    require(id == kOther || id == kOfSeeds);
    if (std::holds_alternative<netio::TeamMap>(packet.body)) return require(has_state[id]);
    const auto* state = std::get_if<netio::V2v>(&packet.body);
    require(state != nullptr && std::hypot(state->X_WR.x, state->X_WR.y) <= kRadio);
    has_state[id] = true;
    if (robot.admit(packet.header, now))
      require(robot.is_active(id, now));
    else
      ++not_admitted;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  Radio radio((data[0] & 1) != 0);
  base::ByteReader reader({data + 1, size - 1});
  while (reader.left() > 3) {
    const auto how = reader.get<std::uint8_t>();
    const auto length = std::min<std::size_t>(reader.get<std::uint16_t>(), netio::kMaxHeaderlessDatagram);
    radio.now += std::int64_t{how >> 2} * 100'000'000;
    radio.send(how, reader.get_bytes(std::min(length, reader.left())));
  }
  // Each datagram is counted once, and states that were not admitted once more.
  const netio::DirectV2vCounts counts = radio.robot.counts();
  require(counts.packets.total() + counts.duplicates + counts.far + counts.own + counts.over_rate ==
          radio.sent + radio.not_admitted);
  return 0;
}
