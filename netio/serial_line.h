#pragma once
// A non-blocking serial line on POSIX: eight bits, no parity, no flow control.

#include <string>

#include "netio/byte_line.h"

namespace sf::netio {

class SerialLine final : public ByteLine {
 public:
  /// Maximum number of bytes waiting to be sent.
  static constexpr std::size_t kMostWaiting = 256;

  /// @param baud 9600, 19200, 38400, 57600 or 115200 @param stop_bits 1 or 2
  /// @throws base::InputError with a remedy if the device cannot be opened or is not a serial line
  SerialLine(const std::string& device, unsigned baud, int stop_bits = 1);

 private:
  std::optional<std::size_t> receive(std::span<std::uint8_t> bytes) override;
  std::optional<std::size_t> send(std::span<const std::uint8_t> bytes) override;
};

}  // namespace sf::netio
