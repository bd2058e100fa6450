#pragma once
// A serial line on POSIX: eight bits, no parity, one stop bit, without flow control, not blocking.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "netio/socket.h"

namespace sf::netio {

/// One thread.
class SerialLine {
 public:
  /// Bytes that wait to be sent, at most; more are refused.
  static constexpr std::size_t kMostWaiting = 256;

  /// @param baud 9600, 19200, 38400, 57600 or 115200
  /// @throws base::InputError where the device cannot be opened or is no serial line, with a remedy
  SerialLine(const std::string& device, unsigned baud);

  /// @return bytes read into `bytes`, 0 where none wait
  std::size_t read(std::span<std::uint8_t> bytes);
  /// Sends all of it, now or with the next call, or nothing. @return false: what was sent before still waits
  bool write(std::span<const std::uint8_t> bytes);
  /// Waits until all is sent, for 100 ms at most.
  void drain();
  /// It hung up, or a call failed; the line is of no more use.
  bool lost() const { return lost_; }

 private:
  void flush();

  Socket descriptor_;
  base::Bytes waiting_;
  bool lost_ = false;
};

}  // namespace sf::netio
