#pragma once
// UDP sockets over plain POSIX (Linux), never blocking.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "base/error.h"
#include "netio/endpoint.h"

namespace sf::netio {

/// An open file descriptor, closed when it goes.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~Socket();
  int descriptor() const { return descriptor_; }  ///< -1: none

 private:
  int descriptor_ = -1;
};

/// Buffers that the kernel is asked for. [byte] 0 leaves its default (about 92 laser datagrams).
struct SocketBuffers {
  std::size_t receive = 0;
  std::size_t send = 0;
};

/// Another socket is bound there.
class PortInUse : public base::InputError {
 public:
  using base::InputError::InputError;
};

/// A bound, non-blocking UDP socket. The kernel may grant smaller buffers (net.core.rmem_max): see receive_buffer.
/// @throws PortInUse, or base::InputError when the address is not this machine's or there are no descriptors left.
Socket open_udp(const Endpoint& bind, const SocketBuffers& buffers = {});

/// The same socket under a second descriptor.
/// @throws base::InputError when there are no descriptors left.
Socket duplicate(const Socket& socket);

/// Sleeps until there is something to take from either, a signal comes, or `timeout_ms` >= 0 has passed.
void wait_readable(const Socket& one, const Socket& other, int timeout_ms);

/// What `socket` is bound to: tells the port that was picked for port 0.
Endpoint bound_endpoint(const Socket& socket);

/// [byte] that the kernel granted; it counts about 2.3 kB for a laser datagram of 748 B.
std::size_t receive_buffer(const Socket& socket);

/// Datagrams that the kernel threw away since the socket is open, mostly because its buffer was full; 0 where it does
/// not tell.
std::uint64_t kernel_drops(const Socket& socket);

/// Raises this process' soft limit of open files to at least `count` (never lowers it).
/// @throws base::InputError when the hard limit is lower.
void raise_open_file_limit(std::size_t count);

/// Datagrams taken from a socket many at a time, into storage made once.
class ReceiveBatch {
 public:
  static constexpr std::size_t kSlotBytes = 2048;  ///< more than any packet of ours: what is cut off here was too long

  explicit ReceiveBatch(std::size_t capacity);
  ~ReceiveBatch();
  ReceiveBatch(const ReceiveBatch&) = delete;
  ReceiveBatch& operator=(const ReceiveBatch&) = delete;

  /// Takes what waits, at most `capacity`; 0 when nothing does.
  std::size_t fill(const Socket& socket);

  /// Of the last fill; lives until the next.
  std::span<const std::uint8_t> bytes(std::size_t i) const;
  Endpoint source(std::size_t i) const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace sf::netio
