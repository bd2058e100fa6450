#pragma once
// Lines on standard error while something runs: a few a second at most, and nobody waits until they are read.

#include <cstdint>
#include <string>
#include <string_view>

namespace sf::netio {

/// Writes `text` as far as that can be done at once. @return false when nothing was written: nobody reads
bool write_nonblocking(int descriptor, std::string_view text);

/// One thread.
class RateLimitedLog {
 public:
  static constexpr double kLinesPerSecond = 5.0;
  static constexpr double kBurst = 20.0;  ///< lines that may come at once

  /// @param descriptor 2: standard error
  explicit RateLimitedLog(int descriptor = 2) : descriptor_(descriptor) {}

  /// Writes "sensorfarm: <text>", or leaves it out. The next line that is written says how many were.
  /// @param now [ns] of any clock that does not go back
  void write(std::string_view text, std::int64_t now);

  std::uint64_t left_out() const { return left_out_; }

 private:
  int descriptor_;
  double allowed_ = kBurst;
  std::int64_t last_ = 0;
  std::uint64_t left_out_ = 0;
  std::uint64_t reported_ = 0;  ///< of these
};

}  // namespace sf::netio
