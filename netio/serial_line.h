#pragma once
// A non-blocking serial line on POSIX: eight bits, no parity, no flow control.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "netio/socket.h"

namespace sf::netio {

/// Single-threaded.
class SerialLine {
 public:
  /// Maximum number of bytes waiting to be sent. Further bytes are refused.
  static constexpr std::size_t kMostWaiting = 256;

  /// @param baud 9600, 19200, 38400, 57600 or 115200 @param stop_bits 1 or 2
  /// @throws base::InputError with a remedy if the device cannot be opened or is not a serial line
  SerialLine(const std::string& device, unsigned baud, int stop_bits = 1);

  /// @return number of bytes read into `bytes`, 0 if none wait
  std::size_t read(std::span<std::uint8_t> bytes);
  /// Sends all bytes, now or in the next call, or none. @return false if earlier bytes still wait
  bool write(std::span<const std::uint8_t> bytes);
  /// Waits until all bytes are sent, for at most 100 ms.
  void drain();
  /// Returns whether the line hung up or a call failed. A lost line cannot be used again.
  bool lost() const { return lost_; }

 private:
  void flush();

  Socket descriptor_;
  base::Bytes waiting_;
  bool lost_ = false;
};

}  // namespace sf::netio
