#pragma once
// The network protocol of the Player robot server, version 3: banner, headers, and the numbers of the interfaces, types
// and subtypes used by the farm. Payloads are in XDR (xdr.h).

#include <cstdint>
#include <span>
#include <string_view>

#include "base/bytes.h"

namespace sf::netio::player {

inline constexpr std::uint16_t kPort = 6665;     ///< default port of clients
inline constexpr std::size_t kBannerBytes = 32;  ///< sent on connection, padded with zeros
inline constexpr std::string_view kBanner = "Player v.3.1.0 (sensorfarm)";
inline constexpr std::size_t kHeaderBytes = 40;
inline constexpr std::size_t kMostPayload = 8u << 20;  ///< [byte] maximum accepted by clients
inline constexpr std::size_t kMostDriverName = 63;     ///< characters

/// Interface codes in headers.
enum class Interface : std::uint32_t {
  player = 1,
  power = 2,
  position2d = 4,
  sonar = 5,
  laser = 6,
  fiducial = 10,
  gps = 13,
  bumper = 14,
  ir = 22,
  simulation = 31,
  map = 42,
  opaque = 51,
  ranger = 62
};

/// Returns Player's name, such as "position2d".
std::string_view interface_name(Interface interf);

enum class MessageType : std::uint32_t { data = 1, command = 2, request = 3, ack = 4, sync = 5, nack = 6 };

namespace server_request {
enum : std::uint32_t {
  device_list = 1,
  driver_info = 2,
  device = 3,
  data = 4,
  data_mode = 5,
  name_service = 8,
  replace_rule = 10
};
}
enum class Access : std::uint32_t { open = 1, close = 2, error = 3 };
enum class DataMode : std::uint32_t { push = 1, pull = 2 };

namespace position2d {
enum : std::uint32_t { state = 1 };
enum class Command : std::uint32_t { velocity = 1, position = 2, car = 3, heading = 4 };
enum class Request : std::uint32_t {
  geometry = 1,
  motors = 2,
  velocity_mode = 3,
  position_mode = 4,
  set_odometry = 5,
  reset_odometry = 6
};
}  // namespace position2d

namespace ranger_data {
enum : std::uint32_t { ranges = 1, stamped = 2 };
}

/// The address of a device as sent by clients. Each connection is to one port, so host and port do not matter.
struct Address {
  Interface interf = Interface::player;
  std::uint32_t index = 0;
  friend auto operator<=>(const Address&, const Address&) = default;
};

struct Header {
  std::uint32_t host = 0;   ///< IPv4 address
  std::uint32_t robot = 0;  ///< port
  Address address;          ///< any numbers
  MessageType type = MessageType::data;
  std::uint32_t subtype = 0;
  double time = 0.0;  ///< [s]
  std::uint32_t sequence = 0;
  std::uint32_t size = 0;  ///< [byte] of the payload
};

/// Appends the kHeaderBytes of `header`.
void put_header(const Header& header, base::Bytes& out);
/// @param bytes at least kHeaderBytes
Header read_header(std::span<const std::uint8_t> bytes);

}  // namespace sf::netio::player
