#pragma once
// Colours of cameras as payloads: a PNG or JPEG file in parts, of the extended type; docs/packets.md specifies every
// byte. Its length differs from image to image, so receivers do not count it among the datagrams of a reading.

#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/reading.h"
#include "sensors/sensor_set.h"

namespace sf::sensors {

inline constexpr std::uint32_t kImagePartBytes = 1240;       ///< of each part except the last
inline constexpr std::uint32_t kMostImageBytes = 4'000'000;  ///< more than noise needs in the largest image
inline constexpr std::uint16_t kPngForm = 1, kJpegForm = 2;  ///< in the header of a part; 0: depths

struct ImageFile {
  std::string bytes;              ///< at most kMostImageBytes
  std::uint16_t form = kPngForm;  ///< or kJpegForm
};

/// Returns the colours of a reading as a file; empty if it is not of a camera with colours.
ImageFile image_file(const SensorSet& sensor_set, const base::ReadingBlock& reading);

/// Number of payloads of a file of at most kMostImageBytes.
constexpr std::uint32_t image_parts(std::size_t bytes) {
  return static_cast<std::uint32_t>((bytes + kImagePartBytes - 1) / kImagePartBytes);
}

/// Appends payload `part` in [0, image_parts) of a file. @return its type
std::uint8_t encode_image(const ImageFile& file, std::uint32_t part, base::Bytes& out);

struct ImagePart {
  std::uint32_t total = 0;  ///< [byte] of the whole file, in [1, kMostImageBytes]
  std::uint32_t first = 0;  ///< index of this part's first byte
  std::uint16_t part = 0, parts = 1;
  std::uint16_t form = kPngForm;        ///< or kJpegForm
  std::span<const std::uint8_t> bytes;  ///< of the file; view of the payload
};

/// Returns the form of a camera's payload: 0: depths; kPngForm, kJpegForm; larger ones are unknown. @param type of the
/// packet
std::uint16_t camera_form(std::uint8_t type, std::span<const std::uint8_t> payload);
/// Accepts any bytes whose form is kPngForm or kJpegForm.
PayloadError read_image(std::span<const std::uint8_t> payload, ImagePart& part);

}  // namespace sf::sensors
