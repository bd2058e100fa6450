#pragma once
// V2X messages as they are sent: SAE J2735 message frames with SPaT or MAP inside, in UPER.
//
//   DecodeResult result = decode(bytes, frame);     // any bytes
//   encode(frame, bytes);                           // the same bytes again
//
// Extensions, regional parts and octets behind the message are kept as they came, so that decoding and encoding give
// the same bytes wherever the sender followed X.691.

#include <span>
#include <string>
#include <variant>

#include "v2x/map_data.h"
#include "v2x/spat.h"

namespace sf::v2x {

inline constexpr std::size_t kMaxFrame = 65'535;  ///< [byte]

struct Frame {
  std::variant<Spat, MapData> message;
  base::Bytes rest;     ///< octets of the value behind the message; normally none
  Additions additions;  ///< of the frame
  base::Bytes padding;  ///< octets behind the frame
  bool operator==(const Frame&) const = default;
};

struct DecodeResult {
  std::size_t size = 0;  ///< [byte] of the frame; more may follow it
  std::string error;     ///< "SPAT.intersections[0].states[2].signalGroup: ..."; empty: decoded
  bool ok() const { return error.empty(); }
};

/// Decodes the frame at the start of `bytes`; the padding stays empty. After an error the frame's content is
/// unspecified.
DecodeResult decode(std::span<const std::uint8_t> bytes, Frame& frame);

/// Replaces the content of `out`, padding included. @pre every number, text and list is within its bounds
void encode(const Frame& frame, base::Bytes& out);

}  // namespace sf::v2x
