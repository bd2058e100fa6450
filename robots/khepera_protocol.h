#pragma once
// Encodes commands and decodes answers of the Khepera II's serial protocol (K-Team's manual of 2002, "The control
// protocol"). Does not access a serial line or a clock.
//
// A command is a line: a capital letter and numbers, separated by commas ("D,5,-3"). The robot answers each command
// with a line that begins with the same letter in lower case ("d"), or with "z,..." to a wrong command. There are no
// checksums.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/pose.h"

namespace sf::robots {

inline constexpr double kKheperaPulse = 1e-3 / 12.0;  ///< [m] that a wheel rolls per pulse of its encoder
inline constexpr int kKheperaSpeed = 127;             ///< [pulses per 10 ms] largest speed of a wheel, 1.06 m/s

/// [pulses per 10 ms] in [-kKheperaSpeed, kKheperaSpeed]; 1 is 8.3 mm/s
struct KheperaWheels {
  int left = 0;
  int right = 0;
};
/// Returns the wheel speeds of a twist. If one wheel is too fast, both are scaled by the same factor, so the robot
/// stays on the arc. NaN and infinity give speed 0. @param track [m] > 0
KheperaWheels khepera_wheels(const base::Twist& twist, double track);

/// Returns "D,5,-3" and a line feed.
base::Bytes khepera_command(char letter, std::initializer_list<int> numbers = {});

struct KheperaAnswer {
  char letter = 0;  ///< in lower case
  std::vector<std::int64_t> numbers;
};
/// @return nullopt if the line, without its end, is not a lower-case letter followed by integers
std::optional<KheperaAnswer> parse_khepera(std::string_view line);

/// Splits received bytes into lines.
class KheperaLines {
 public:
  static constexpr std::size_t kMostBytes = 128;  ///< of a line; longer ones are dropped

  /// @return the line completed by this byte, without its end; empty lines are skipped
  std::optional<std::string> take(std::uint8_t byte);
  /// Drops an incomplete line.
  void reset();

  std::uint64_t skipped() const { return skipped_; }  ///< bytes of dropped lines

 private:
  std::string line_;
  bool too_long_ = false;
  std::uint64_t skipped_ = 0;
};

}  // namespace sf::robots
