#pragma once
// Packets as names and values, in SI units: the keys of tests/netio/vectors and of `dump --json`.

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "netio/packets.h"

namespace sf::server {

/// A list contains the values of a reading's column or of a vector. NaN: no number; infinity: no return of a laser.
struct PacketField {
  std::string name;
  std::variant<std::int64_t, double, std::vector<double>, std::string> value;
};

/// Returns the values, floating-point numbers with ten digits: "3", "0.25", "1 none inf".
std::string packet_field_text(const PacketField& field);

/// A datagram as judged by a receiver of its type.
struct PacketDescription {
  netio::PacketStatus status = netio::PacketStatus::too_short;  ///< other members are set only if it is accepted
  netio::Header header;
  std::string name;                 ///< "laser", "V2V", ...
  std::vector<PacketField> fields;  ///< of the header, then of the payload
  std::size_t header_fields = 0;    ///< of `fields`
};

/// Accepts any bytes.
PacketDescription describe_packet(std::span<const std::uint8_t> bytes);

}  // namespace sf::server
