#pragma once
// A non-blocking stream of bytes to a robot.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "base/bytes.h"
#include "netio/socket.h"

namespace sf::netio {

/// Single-threaded.
class ByteLine {
 public:
  virtual ~ByteLine() = default;
  ByteLine(const ByteLine&) = delete;
  ByteLine& operator=(const ByteLine&) = delete;

  /// @return number of bytes read into `bytes`, 0 if none wait
  std::size_t read(std::span<std::uint8_t> bytes);
  /// Sends all bytes, now or in the next call, or none. @return false if too many earlier bytes still wait
  bool write(std::span<const std::uint8_t> bytes);
  /// Waits until all bytes are sent, for at most 100 ms.
  void drain();
  /// Returns whether the other end hung up or a call failed. A lost line cannot be used again.
  bool lost() const { return lost_; }

 protected:
  /// @param most [byte] waiting to be sent; further bytes are refused
  ByteLine(Socket descriptor, std::size_t most) : descriptor_(std::move(descriptor)), most_(most) {}

  // Return the number of bytes moved; 0: none now; nullopt: the line is lost.
  virtual std::optional<std::size_t> receive(std::span<std::uint8_t> bytes) = 0;
  virtual std::optional<std::size_t> send(std::span<const std::uint8_t> bytes) = 0;
  const Socket& descriptor() const { return descriptor_; }

 private:
  void flush();

  Socket descriptor_;
  std::size_t most_;
  base::Bytes waiting_;
  bool lost_ = false;
};

}  // namespace sf::netio
