#pragma once
// Rate-limited, non-blocking log lines on standard error.

#include <cstdint>
#include <string>
#include <string_view>

namespace sf::netio {

/// Writes as much of `text` as is possible without blocking. @return false if nothing was written because the reader is
/// slow
bool write_nonblocking(int descriptor, std::string_view text);

/// Single-threaded.
class RateLimitedLog {
 public:
  static constexpr double kLinesPerSecond = 5.0;
  static constexpr double kBurst = 20.0;  ///< lines

  /// @param descriptor 2: standard error
  explicit RateLimitedLog(int descriptor = 2) : descriptor_(descriptor) {}

  /// Writes "sensorfarm: <text>" or omits it. The next line that is written states the number of omitted lines.
  /// @param now [ns] of any clock that does not decrease
  void write(std::string_view text, std::int64_t now);

  std::uint64_t left_out() const { return left_out_; }

 private:
  int descriptor_;
  double allowed_ = kBurst;
  std::int64_t last_ = 0;
  std::uint64_t left_out_ = 0;
  std::uint64_t reported_ = 0;  ///< part of `left_out_` that was reported
};

/// Decides when to log a repeated event: the first occurrence, then the number of occurrences every ten seconds while
/// it continues.
class RepeatedEvent {
 public:
  /// @param now [ns] of any clock that does not decrease
  /// @param tolerated fewer occurrences than this in ten seconds are not logged
  /// @return number to log, including this occurrence; 0: nothing is due
  std::uint64_t count(std::int64_t now, std::uint64_t tolerated = 0);
  /// [ns] Nothing is due before this time.
  std::int64_t next_line() const { return next_line_; }

 private:
  std::uint64_t count_ = 0;     ///< since the last line
  std::int64_t since_ = 0;      ///< [ns] time of the first of these occurrences
  std::int64_t next_line_ = 0;  ///< [ns]
};

/// Returns "1 packet", "12 packets".
std::string packets_text(std::uint64_t count);

}  // namespace sf::netio
