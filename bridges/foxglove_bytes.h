#pragma once
// Binary messages of Foxglove's WebSocket protocol, little endian, each preceded by its opcode byte.
//
//   server: 1 message data, 2 time, 3 service response, 5 playback state (foxglove.sdk.v1)
//   client: 1 message data, 2 service request, 3 playback request (foxglove.sdk.v1)

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "base/bytes.h"
#include "base/pose.h"

namespace sf::bridges {

/// Returns the header of a topic's message.
/// @param time [ns]
std::array<std::uint8_t, 13> message_head(std::uint32_t subscription, std::int64_t time);
/// @param time [ns]
base::Bytes time_bytes(std::int64_t time);
base::Bytes service_response_bytes(std::uint32_t service, std::uint32_t call, std::string_view encoding,
                                   std::span<const std::uint8_t> payload);

struct PlaybackState {
  enum class Status : std::uint8_t { playing, paused, buffering, ended };
  Status status = Status::playing;
  std::int64_t time = 0;  ///< [ns] >= 0
  float speed = 1.0F;     ///< [1] recorded time over real time
  bool did_seek = false;  ///< whether a request changed the time
  std::string request;    ///< id of the request that this answers; empty: none
};
base::Bytes playback_state_bytes(const PlaybackState& state);

struct ClientPublish {
  std::uint32_t channel = 0;
  std::span<const std::uint8_t> payload;  ///< points into the parsed message
};

struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string encoding;
  std::span<const std::uint8_t> payload;  ///< points into the parsed message
};

struct PlaybackRequest {
  bool pause = false;
  float speed = 1.0F;                ///< as received; may not be finite
  std::optional<std::int64_t> time;  ///< [ns] >= 0, target of a seek
  std::string id;
};

using ClientBinary = std::variant<ClientPublish, ServiceCall, PlaybackRequest>;

/// @return nullopt for any other bytes
std::optional<ClientBinary> parse_client_binary(std::span<const std::uint8_t> bytes);

/// Reads a geometry_msgs Twist, or TwistStamped if `stamped`, in CDR.
/// @return nullopt for any other bytes
std::optional<base::Twist> read_cdr_twist(std::span<const std::uint8_t> message, bool stamped);

}  // namespace sf::bridges
