#include "netio/rejection_log.h"

#include <fmt/format.h>

#include <algorithm>

#include "netio/packet_forms.h"

namespace sf::netio {

namespace {

/// Returns "a V2V of 131 bytes", with the expected size.
std::string size_text(std::span<const std::uint8_t> bytes, bool is_short) {
  if (bytes.size() < kHeaderBytes)
    return fmt::format("{} bytes: every packet starts with a header of {} bytes", bytes.size(), kHeaderBytes);
  const PacketForm* const form = find_packet_form(static_cast<Type>(bytes[kTypeAt]));
  const std::string size = form == nullptr
                               ? fmt::format("a packet of type {} and {} bytes", bytes[kTypeAt], bytes.size())
                               : fmt::format("a {} of {} bytes", form->name, bytes.size());
  const std::string fault = fmt::format("{} is too {}", size, is_short ? "short" : "long");
  if (form == nullptr || form->bytes == 0) return fault;
  const std::string longer = form->more > 0 ? fmt::format(" or {}", form->bytes + form->more) : "";
  return fmt::format("{}: expected {}{}", fault, form->bytes, longer);
}

std::string ids_text(std::span<const std::uint32_t> ids) {
  if (ids.empty()) return "none";
  constexpr std::size_t kShown = 8;
  return fmt::format("{}{}", fmt::join(ids.first(std::min(ids.size(), kShown)), ", "),
                     ids.size() > kShown ? fmt::format(" and {} more", ids.size() - kShown) : "");
}

/// Relies on the order of `PacketStatus`. Reasons about signatures and sources have their own log.
bool is_reported(PacketStatus reason) {
  return (reason >= PacketStatus::too_short && reason <= PacketStatus::unknown_light) ||
         reason == PacketStatus::unproven || reason == PacketStatus::stale;
}

bool is_tolerated(PacketStatus reason) { return reason == PacketStatus::unproven || reason == PacketStatus::stale; }

}  // namespace

std::string rejection_text(PacketStatus reason, std::span<const std::uint8_t> bytes,
                           std::span<const std::uint32_t> robots) {
  const bool whole = bytes.size() >= kHeaderBytes;
  const unsigned type = whole ? bytes[kTypeAt] : 0;
  const unsigned id = whole ? bytes[kRobotAt] + 256u * bytes[kRobotAt + 1] : 0;
  switch (reason) {
    case PacketStatus::too_short:
    case PacketStatus::too_long:
      return size_text(bytes, reason == PacketStatus::too_short);
    case PacketStatus::bad_magic:
      return "it does not start with SFPK: is it meant for another program, or in the layout of --wire thesis?";
    case PacketStatus::unknown_version:
      return fmt::format("protocol version {}: expected {}; update the sender", unsigned{bytes[kVersionAt]},
                         unsigned{kVersion});
    case PacketStatus::unknown_type:
      return fmt::format("type {} is unknown", type);
    case PacketStatus::not_finite:
      return "it contains NaN or infinity";
    case PacketStatus::out_of_range:
      return "a number in it is out of range";
    case PacketStatus::wrong_direction:
      return fmt::format(
          "type {} is not for this service: only the farm sends it, or it belongs to the other mode (lockstep or real "
          "time)",
          type);
    case PacketStatus::unknown_robot:
      return fmt::format("the world has no robot with id {}; it has {}", id, ids_text(robots));
    case PacketStatus::unknown_tag:
      return fmt::format("the world has no tag with id {}; give it a model named tag{}", id, id);
    case PacketStatus::unknown_light:
      return fmt::format("the world has no intersection with id {}", id);
    case PacketStatus::unproven:
      return "they lack the token of their address: the sender must copy it from the CHALLENGE sent in reply";
    case PacketStatus::stale:
      return "their sequence number is not newer than that of an accepted packet: it must increase with every packet "
             "of a session";
    default:
      return std::string(name(reason));
  }
}

RepeatedEvent& RejectionLog::row_of(const Endpoint& who, PacketStatus reason, std::int64_t now) {
  const std::tuple key{who.address, who.port, reason};
  const auto found = rows_.find(key);
  if (found != rows_.end()) return found->second;
  if (rows_.size() == kMaxRows) std::erase_if(rows_, [&](const auto& row) { return row.second.next_line() < now; });
  return rows_.size() == kMaxRows ? others_ : rows_[key];
}

void RejectionLog::note(PacketStatus reason, std::span<const std::uint8_t> bytes, const Endpoint& who, std::int64_t now,
                        RateLimitedLog& log) {
  if (!is_reported(reason)) return;
  RepeatedEvent& row = row_of(who, reason, now);
  const std::uint64_t count = row.count(now, is_tolerated(reason) ? kTolerated : 0);
  if (count == 0) return;
  log.write(fmt::format("{} from {} dropped: {} (docs/packets.md)", packets_text(count),
                        &row == &others_ ? endpoint_text(who) + " and other senders" : endpoint_text(who),
                        rejection_text(reason, bytes, robots_)),
            now);
}

}  // namespace sf::netio
