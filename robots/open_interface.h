#pragma once
// Bytes of the iRobot Create's Open Interface (specification of 2006): what a computer sends on the serial line, and
// the sensor stream that it gets. No line, no clock.
//
// A frame of the stream, every 15 ms: 19, number of bytes N, N bytes of packets (id, data), checksum. The sum of all
// its bytes is 0 modulo 256. Numbers are big-endian.

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
inline constexpr double kCreateSpeed = 500.0;  ///< [mm/s] of a wheel, at most

/// Wheel speeds of a twist in whole mm/s. Where one wheel is too fast both slow down alike, so that the robot keeps to
/// the arc. NaN and infinity stand. @param track [m] > 0
CreateWheels create_wheels(const base::Twist& twist, double track);

/// Start, safe mode, at rest, stream of `CreateFrame`. From any mode, but off.
base::Bytes create_start();
/// Safe mode: the robot stops by itself at cliffs, when a wheel drops and when its charger is plugged in.
base::Bytes create_safe();
base::Bytes create_drive(const CreateWheels& wheels);
/// At rest, no stream, passive mode.
base::Bytes create_stop();

/// Packets 7, 19, 20 and 35.
struct CreateFrame {
  enum Mode : std::uint8_t { off = 0, passive = 1, safe = 2, full = 3 };
  bool bumped = false;        ///< right, left or both
  bool wheel_drop = false;    ///< of any wheel: the robot is lifted
  std::int16_t distance = 0;  ///< [mm] since the last frame, forward positive
  std::int16_t angle = 0;     ///< [degree] since the last frame, counter-clockwise
  std::uint8_t mode = safe;
};

/// Finds frames in a stream of bytes with losses and other text.
class CreateStream {
 public:
  static constexpr std::size_t kFrameBytes = 13;

  /// @return the frame that this byte completes
  std::optional<CreateFrame> take(std::uint8_t byte);
  /// Forgets an incomplete frame.
  void reset() { size_ = 0; }

  std::uint64_t frames() const { return frames_; }
  std::uint64_t wrong_checksums() const { return wrong_checksums_; }
  std::uint64_t skipped() const { return skipped_; }  ///< bytes that belong to no frame

 private:
  std::optional<CreateFrame> whole();
  void drop_first();

  std::array<std::uint8_t, kFrameBytes> bytes_{};
  std::size_t size_ = 0;
  std::uint64_t frames_ = 0, wrong_checksums_ = 0, skipped_ = 0;
};

}  // namespace sf::robots
