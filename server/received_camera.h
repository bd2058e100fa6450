#pragma once
// Puts a camera's image, which arrives as a file in parts (sensors/image_packets.h), into its reading.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "netio/reading_assembler.h"
#include "sensors/camera_settings.h"

namespace sf::server {

struct ImageCounts {
  std::uint64_t whole = 0;    ///< readings with depths and image
  std::uint64_t invalid = 0;  ///< images of which all parts arrived, but which are no file of the camera's size
};

/// The newest reading of one camera with colours, of which both depths and image have arrived. Not thread-safe.
class ReceivedCamera {
 public:
  explicit ReceivedCamera(const sensors::CameraSettings& settings) : settings_(settings) {}

  /// Takes a part of the file of reading `sequence`; its payload may be any bytes. Parts of an older reading than the
  /// newest are dropped, and a new reading replaces one that is not complete.
  void take_part(std::uint32_t sequence, std::span<const std::uint8_t> payload);
  /// Takes the newest complete reading, whose depths have arrived.
  void take_depths(const netio::CompleteReading& reading);

  /// Returns the reading with depths and colours; its other values are not numbers. Valid until the next part.
  std::optional<netio::CompleteReading> newest() const;
  const ImageCounts& counts() const { return counts_; }
  /// Forgets all readings, because the sender has changed.
  void restart();

 private:
  void begin_image(std::uint32_t sequence, std::uint32_t bytes, std::uint32_t parts);
  void combine();

  sensors::CameraSettings settings_;
  // The image in progress, or the newest one.
  bool any_image_ = false;
  std::uint32_t image_ = 0;  ///< sequence
  std::string file_;
  std::vector<bool> seen_;     ///< per part
  std::uint32_t missing_ = 0;  ///< parts
  // The newest depths, and with them the newest whole reading.
  std::optional<netio::CompleteReading> depths_, whole_;
  std::vector<double> depth_values_, values_;
  ImageCounts counts_;
};

}  // namespace sf::server
