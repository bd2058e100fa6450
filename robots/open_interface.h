#pragma once
// Encodes commands and decodes the sensor stream of the iRobot Create's Open Interface (specification of 2006). Does
// not access a serial line or a clock.
//
// A frame of the stream, every 15 ms: 19, number of bytes N, N bytes of packets (id, data), checksum. All bytes sum to
// 0 modulo 256. Numbers are big-endian.

#include <array>
#include <cstdint>
#include <numbers>
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

/// Packets of odometry. Firmware of the Create 2 reports wrong distances and angles, so its wheels are used.
enum class CreateOdometry : std::uint8_t {
  motion,  ///< 19 and 20
  wheels   ///< 43 and 44
};
inline constexpr double kCreate2Count = 0.072 * std::numbers::pi / 508.8;  ///< [m] that a wheel rolls per count

/// Start, safe mode, wheels stopped, stream of `CreateFrame`. Works in any mode except off.
base::Bytes create_start(CreateOdometry odometry = CreateOdometry::motion);
/// Safe mode: the robot stops by itself at cliffs, when a wheel drops and when the charger is plugged in.
base::Bytes create_safe();
base::Bytes create_drive(const CreateWheels& wheels);
/// Sets the outputs of the cargo bay. Works in safe and full mode.
/// @param bits 0 to 2: digital outputs at pins 19, 7, 20; 3 to 5: low-side drivers at pins 23, 22, 24
base::Bytes create_outputs(std::uint8_t bits);
/// Wheels stopped, stream paused, passive mode.
base::Bytes create_stop();

/// Contents of the stream's packets (the specification's ids in brackets).
struct CreateFrame {
  enum Mode : std::uint8_t { off = 0, passive = 1, safe = 2, full = 3 };
  bool bumped_left = false;              ///< [7]
  bool bumped_right = false;             ///< [7]
  bool wheel_drop = false;               ///< [7] any wheel dropped: the robot is lifted
  bool wall = false;                     ///< [8] on its right
  std::array<std::uint8_t, 4> cliffs{};  ///< [9 to 12] left, front left, front right, right: 1 without floor, else 0
  bool virtual_wall = false;             ///< [13]
  std::uint8_t overcurrents = 0;         ///< [14] bits 3 and 4: right and left wheel
  std::uint8_t infrared = 255;           ///< [17] received byte; 255: none
  std::uint8_t buttons = 0;              ///< [18] bit 0: play, bit 2: advance
  std::int16_t distance = 0;             ///< [19] [mm] since the last frame, forward positive
  std::int16_t angle = 0;                ///< [20] [degree] since the last frame, counter-clockwise
  std::uint16_t left = 0, right = 0;     ///< [43, 44] counts of the wheels, in place of 19 and 20
  std::uint8_t charging = 0;             ///< [21] 0 none, 1 reconditioning, 2 full, 3 trickle, 4 waiting, 5 fault
  std::uint16_t voltage = 0;             ///< [22] [mV]
  std::int16_t current = 0;              ///< [23] [mA] into the battery
  std::int8_t temperature = 0;           ///< [24] [degree Celsius] of the battery
  std::uint16_t charge = 0;              ///< [25] [mAh]
  std::uint16_t capacity = 0;            ///< [26] [mAh]
  std::uint8_t inputs = 0;               ///< [32] bits 0 to 3: digital inputs of the cargo bay, pins 17, 5, 18, 6
  std::uint16_t analog = 0;              ///< [33] 0 to 1023 for 0 to 5 V at pin 4
  std::uint8_t mode = safe;              ///< [35]
};

/// Packets of the stream, in this order: id and number of data bytes. The packets of wheels replace those of motion.
struct CreatePacket {
  std::uint8_t id, bytes;
};
inline constexpr CreatePacket kCreatePackets[] = {{7, 1},  {8, 1},  {9, 1},  {10, 1}, {11, 1}, {12, 1}, {13, 1},
                                                  {14, 1}, {17, 1}, {18, 1}, {19, 2}, {20, 2}, {21, 1}, {22, 2},
                                                  {23, 2}, {24, 1}, {25, 2}, {26, 2}, {32, 1}, {33, 2}, {35, 1}};

/// Finds frames in a byte stream with losses and other data.
class CreateStream {
 public:
  /// 19, number of bytes, packets, checksum. At 57600 baud 86 bytes fit into 15 ms.
  static constexpr std::size_t kFrameBytes = [] {
    std::size_t bytes = 3;
    for (const CreatePacket& packet : kCreatePackets) bytes += 1 + packet.bytes;
    return bytes;
  }();

  explicit CreateStream(CreateOdometry odometry = CreateOdometry::motion) : odometry_(odometry) {}

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

  CreateOdometry odometry_;
  std::array<std::uint8_t, kFrameBytes> bytes_{};
  std::size_t size_ = 0;
  std::uint64_t frames_ = 0, wrong_checksums_ = 0, skipped_ = 0;
};

}  // namespace sf::robots
