#pragma once
// Rate-limited, non-blocking log lines on standard error.

#include <cstdint>
#include <string>
#include <string_view>

namespace sf::netio {

/// Writes as much of `text` as is possible without waiting. @return false when nothing was written: the reader is slow
bool write_nonblocking(int descriptor, std::string_view text);

/// One thread.
class RateLimitedLog {
 public:
  static constexpr double kLinesPerSecond = 5.0;
  static constexpr double kBurst = 20.0;  ///< lines

  /// @param descriptor 2: standard error
  explicit RateLimitedLog(int descriptor = 2) : descriptor_(descriptor) {}

  /// Writes "sensorfarm: <text>" or omits it. The next written line states the number of omitted ones.
  /// @param now [ns] of any clock that does not decrease
  void write(std::string_view text, std::int64_t now);

  std::uint64_t left_out() const { return left_out_; }

 private:
  int descriptor_;
  double allowed_ = kBurst;
  std::int64_t last_ = 0;
  std::uint64_t left_out_ = 0;
  std::uint64_t reported_ = 0;  ///< of `left_out_`
};

/// Occurrences of one event that is logged: the first, then every ten seconds their number while more come.
class RepeatedEvent {
 public:
  /// @param now [ns] of any clock that does not decrease
  /// @param tolerated fewer than so many in ten seconds are not logged
  /// @return number to log, this one included; 0: nothing is due
  std::uint64_t count(std::int64_t now, std::uint64_t tolerated = 0);
  /// [ns] Nothing is due before this time.
  std::int64_t next_line() const { return next_line_; }

 private:
  std::uint64_t count_ = 0;     ///< since the last line
  std::int64_t since_ = 0;      ///< [ns] of the first of them
  std::int64_t next_line_ = 0;  ///< [ns]
};

/// "1 packet", "12 packets".
std::string packets_text(std::uint64_t count);

}  // namespace sf::netio
