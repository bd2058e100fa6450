#pragma once
// V2X messages as transmitted: SAE J2735 message frames that contain SPaT or MAP, in UPER.
//
//   DecodeResult result = decode(bytes, frame);     // any bytes
//   encode(frame, bytes);                           // the same bytes again
//
// Extensions, regional parts and octets after the message are stored unchanged, so decoding and encoding reproduces the
// bytes of any sender that follows X.691.

#include <span>
#include <string>
#include <variant>

#include "v2x/map_data.h"
#include "v2x/spat.h"

namespace sf::v2x {

inline constexpr std::size_t kMaxFrame = 65'535;  ///< [byte]

struct Frame {
  std::variant<Spat, MapData> message;
  base::Bytes rest;     ///< octets of the value after the message; normally none
  Additions additions;  ///< of the frame
  base::Bytes padding;  ///< octets after the frame
  bool operator==(const Frame&) const = default;
};

struct DecodeResult {
  std::size_t size = 0;  ///< [byte] of the frame; more bytes may follow
  std::string error;     ///< "SPAT.intersections[0].states[2].signalGroup: ..."; empty: success
  bool ok() const { return error.empty(); }
};

/// Decodes the frame at the start of `bytes`; the padding remains empty. After an error the content of the frame is
/// unspecified.
DecodeResult decode(std::span<const std::uint8_t> bytes, Frame& frame);

/// Replaces the content of `out`, padding included.
/// @pre every number, text and list is within its bounds
void encode(const Frame& frame, base::Bytes& out);

}  // namespace sf::v2x
