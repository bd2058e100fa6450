#include "netio/v2v_socket.h"

#include <variant>

#include "netio/own_end.h"

namespace sf::netio {

namespace {

constexpr std::size_t kV2vBatch = 64;
constexpr std::size_t kV2vChannel = 0;
constexpr std::size_t kV2vSendBuffer = 1u << 18;  ///< [byte]

}  // namespace

V2vSocket::V2vSocket(const V2vSocketOptions& options)
    : options_(options),
      socket_(open_udp(own_end_for(options.farm.address), {.receive = options.receive_buffer, .send = kV2vSendBuffer})),
      outbox_(duplicate(socket_), {.capacity = 4}),
      others_(options.others),
      lights_(options.lights),
      drives_(std::span(&options.robot, 1)),
      lanes_(std::span(&options.robot, 1)),
      drops_(std::span(&options.robot, 1)),
      batch_(kV2vBatch) {
  if (!options.key) return;
  signer_.emplace(*options.key);
  checker_.emplace(*options.key);
}

void V2vSocket::send(std::span<const std::uint8_t> bytes) {
  outbox_.queue(options_.farm, bytes, {options_.session, token_}, signer_ ? &*signer_ : nullptr);
  outbox_.flush();
}

/// Checks the signature of the whole datagram: the states in a NEIGHBOURS packet are not signed individually. Packets
/// without this robot's session are rejected first: the robot's own packets, sent back to it, have valid signatures and
/// counters of another clock.
PacketStatus V2vSocket::check_signature(std::span<const std::uint8_t> bytes) {
  if (!checker_) return PacketStatus::accepted;
  Packet packet;
  const PacketStatus status = decode(bytes, packet);
  if (status != PacketStatus::accepted) return status;
  return packet.header.token == options_.session ? checker_->check(bytes) : PacketStatus::wrong_source;
}

/// Runs before signatures are checked: if the keys differ, the farm cannot sign validly. It changes only a message.
bool V2vSocket::take_refusal(std::span<const std::uint8_t> bytes) {
  Packet packet;
  if (decode(bytes, packet) != PacketStatus::accepted || packet.header.token != options_.session) return false;
  const auto* const refusal = std::get_if<Refusal>(&packet.body);
  if (refusal == nullptr) return false;
  counts_.add(PacketStatus::accepted);
  trouble_ = {refusal->reason, true, packet.header.time, trouble_.count + 1};
  return true;
}

void V2vSocket::note_trouble(PacketStatus status) {
  if (status != PacketStatus::not_signed && status != PacketStatus::wrong_signature && status != PacketStatus::replayed)
    return;
  trouble_ = {status, false, 0, trouble_.count + 1};
}

PacketStatus V2vSocket::accept(std::span<const std::uint8_t> bytes, std::int64_t now, Packet& packet) {
  PacketStatus status = decode(bytes, packet);
  if (status == PacketStatus::accepted) status = check(packet, now);
  counts_.add(status);
  return status;
}

PacketStatus V2vSocket::check(const Packet& packet, std::int64_t now) {
  const std::uint16_t id = packet.header.robot;
  if (packet.header.token != options_.session) return PacketStatus::wrong_source;
  if (const auto* challenge = std::get_if<Challenge>(&packet.body)) {
    token_ = challenge->token;
    farm_session_ = packet.header.session;
    return PacketStatus::accepted;
  }
  if (packet.header.session != farm_session_) return PacketStatus::wrong_source;
  if (std::holds_alternative<V2i>(packet.body)) {
    if (!lights_.row(id)) return PacketStatus::unknown_light;
    return lights_.admit(id, kV2vChannel, packet.header.sequence, options_.farm, now);
  }
  const bool drive = std::holds_alternative<Drive>(packet.body), dropped = std::holds_alternative<Dropped>(packet.body);
  if (drive || dropped || std::holds_alternative<Lane>(packet.body)) {
    if (id != options_.robot) return PacketStatus::unknown_robot;
    return (drive     ? drives_
            : dropped ? drops_
                      : lanes_)
        .admit(id, kV2vChannel, packet.header.sequence, options_.farm, now);
  }
  const bool start = std::holds_alternative<Start>(packet.body);
  if (!start && !std::holds_alternative<V2v>(packet.body)) return PacketStatus::wrong_direction;
  if (start && id != kBroadcastId && id != options_.robot) return PacketStatus::unknown_robot;
  if (!start && !others_.row(id)) return PacketStatus::unknown_robot;
  return start ? PacketStatus::accepted : others_.admit(id, kV2vChannel, packet.header.sequence, options_.farm, now);
}

}  // namespace sf::netio
