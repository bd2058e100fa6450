#include "netio/radio.h"

#include <variant>

namespace sf::netio {

namespace {

constexpr std::size_t kBatch = 64;
constexpr std::size_t kStateLine = 0;
constexpr std::size_t kSendBuffer = 1u << 18;  ///< [byte]

}  // namespace

Radio::Radio(const RadioOptions& options)
    : options_(options),
      socket_(open_udp({0, 0}, {.receive = options.receive_buffer, .send = kSendBuffer})),
      outbox_(duplicate(socket_), {.capacity = 4}),
      others_(options.others),
      batch_(kBatch) {}

void Radio::send(std::span<const std::uint8_t> bytes) {
  outbox_.queue(options_.farm, bytes, {options_.session, token_});
  outbox_.flush();
}

Reason Radio::accept(std::span<const std::uint8_t> bytes, std::int64_t now, Packet& packet) {
  Reason reason = decode(bytes, packet);
  if (reason == Reason::accepted) reason = judge(packet, now);
  counts_.add(reason);
  return reason;
}

Reason Radio::judge(const Packet& packet, std::int64_t now) {
  const std::uint16_t id = packet.header.robot;
  if (packet.header.token != options_.session) return Reason::wrong_source;
  if (const auto* challenge = std::get_if<Challenge>(&packet.body)) {
    token_ = challenge->token;
    farm_session_ = packet.header.session;
    return Reason::accepted;
  }
  if (packet.header.session != farm_session_) return Reason::wrong_source;
  const bool start = std::holds_alternative<Start>(packet.body);
  if (!start && !std::holds_alternative<V2v>(packet.body)) return Reason::wrong_direction;
  if (start && id != kEveryone && id != options_.robot) return Reason::unknown_robot;
  if (!start && !others_.row(id)) return Reason::unknown_robot;
  return start ? Reason::accepted : others_.admit(id, kStateLine, packet.header.sequence, options_.farm, now);
}

}  // namespace sf::netio
