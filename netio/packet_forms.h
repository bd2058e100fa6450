#pragma once
// Names and sizes of packet types, for messages to users.

#include <string_view>

#include "netio/packets.h"

namespace sf::netio {

struct PacketForm {
  Type type;
  std::string_view name;  ///< as in docs/packets.md: "V2V"
  std::size_t bytes;      ///< header included, without a signature; 0: not of one size
};

/// Of all types but readings, whose sensor types name them. @return nullptr for a reading or an unknown type
const PacketForm* find_packet_form(Type type);

}  // namespace sf::netio
