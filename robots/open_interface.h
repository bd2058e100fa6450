#pragma once
// Encodes commands and decodes the sensor stream of the iRobot Create's Open Interface (specification of 2006). Does
// not access a serial line or a clock.
//
// A frame of the stream, every 15 ms: 19, number of bytes N, N bytes of packets (id, data), checksum. All bytes sum to
// 0 modulo 256. Numbers are big-endian.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/bytes.h"
#include "base/pose.h"

namespace sf::robots {

/// [mm/s] in [-kCreateSpeed, kCreateSpeed]
struct CreateWheels {
  std::int16_t right = 0;
  std::int16_t left = 0;
};
inline constexpr double kCreateSpeed = 500.0;  ///< [mm/s] largest speed of a wheel

/// Returns the wheel speeds of a twist in whole mm/s. If one wheel is too fast, both are scaled by the same factor, so
/// the robot stays on the arc. NaN and infinity give speed 0.
/// @param track [m] > 0
CreateWheels create_wheels(const base::Twist& twist, double track);

/// Start, safe mode, wheels stopped, stream of `CreateFrame`. Works in any mode except off.
base::Bytes create_start();
/// Safe mode: the robot stops by itself at cliffs, when a wheel drops and when the charger is plugged in.
base::Bytes create_safe();
base::Bytes create_drive(const CreateWheels& wheels);
/// Wheels stopped, stream paused, passive mode.
base::Bytes create_stop();

/// Contents of packets 7, 19, 20 and 35.
struct CreateFrame {
  enum Mode : std::uint8_t { off = 0, passive = 1, safe = 2, full = 3 };
  bool bumped = false;        ///< left, right or both bumpers
  bool wheel_drop = false;    ///< any wheel dropped: the robot is lifted
  std::int16_t distance = 0;  ///< [mm] since the last frame, forward positive
  std::int16_t angle = 0;     ///< [degree] since the last frame, counter-clockwise
  std::uint8_t mode = safe;
};

/// Finds frames in a byte stream with losses and other data.
class CreateStream {
 public:
  static constexpr std::size_t kFrameBytes = 13;

  /// @return the frame completed by this byte
  std::optional<CreateFrame> take(std::uint8_t byte);
  /// Drops an incomplete frame.
  void reset() { size_ = 0; }

  std::uint64_t frames() const { return frames_; }
  std::uint64_t wrong_checksums() const { return wrong_checksums_; }
  std::uint64_t skipped() const { return skipped_; }  ///< bytes that are not part of a frame

 private:
  std::optional<CreateFrame> whole();
  void drop_first();

  std::array<std::uint8_t, kFrameBytes> bytes_{};
  std::size_t size_ = 0;
  std::uint64_t frames_ = 0, wrong_checksums_ = 0, skipped_ = 0;
};

}  // namespace sf::robots
