#pragma once
// Names and sizes of packet types, for messages to users.

#include <string_view>

#include "netio/packets.h"

namespace sf::netio {

struct PacketForm {
  Type type;
  std::string_view name;  ///< name in docs/packets.md: "V2V"
  std::size_t bytes;      ///< including the header, without a signature; 0: the size varies
  std::size_t more = 0;   ///< that a longer form has
};

/// Returns the form of a packet type that is not a reading; sensor types name readings. @return nullptr for a reading
/// or an unknown type
const PacketForm* find_packet_form(Type type);

}  // namespace sf::netio
