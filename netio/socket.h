#pragma once
// Non-blocking UDP sockets on POSIX (Linux).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "base/error.h"
#include "netio/endpoint.h"

namespace sf::netio {

/// Owns a file descriptor.
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

/// Buffer sizes to request from the kernel [byte]. 0: the kernel's default (about 92 laser datagrams).
struct SocketBuffers {
  std::size_t receive = 0;
  std::size_t send = 0;
};

/// The port is in use by another socket.
class PortInUse : public base::InputError {
 public:
  using base::InputError::InputError;
};

/// Opens a bound, non-blocking UDP socket. The kernel may grant smaller buffers (net.core.rmem_max), see
/// receive_buffer.
/// @throws PortInUse
/// @throws base::InputError if the address does not belong to this machine or no descriptors are left
Socket open_udp(const Endpoint& bind, const SocketBuffers& buffers = {});

/// Returns the same socket under a second descriptor.
/// @throws base::InputError if no descriptors are left
Socket duplicate(const Socket& socket);

/// Sleeps until one of the sockets is readable, a signal arrives, or `timeout_ms` >= 0 has passed.
void wait_readable(const Socket& one, const Socket& other, int timeout_ms);

/// Returns the address and port to which `socket` is bound, with the chosen port if port 0 was requested.
Endpoint bound_endpoint(const Socket& socket);

/// Returns the size [byte] granted by the kernel, which counts about 2.3 kB for a laser datagram of 748 B.
std::size_t receive_buffer(const Socket& socket);

/// Returns the number of datagrams that the operating system has dropped since the socket was opened, mostly because of
/// a full buffer; 0 if it is unknown.
std::uint64_t socket_drops(const Socket& socket);

/// Raises this process' soft limit of open files to at least `count`; never lowers it.
/// @throws base::InputError if the hard limit is lower
void raise_open_file_limit(std::size_t count);

/// Receives datagrams in batches into preallocated storage.
class ReceiveBatch {
 public:
  static constexpr std::size_t kSlotBytes = 2048;  ///< longer datagrams are truncated; all packets of the farm are
                                                   ///< shorter

  explicit ReceiveBatch(std::size_t capacity);
  ~ReceiveBatch();
  ReceiveBatch(const ReceiveBatch&) = delete;
  ReceiveBatch& operator=(const ReceiveBatch&) = delete;

  /// Receives at most `capacity` waiting datagrams. @return their number
  std::size_t fill(const Socket& socket);

  /// Passes waiting datagrams to `take(std::span<const std::uint8_t> bytes, const Endpoint& source)`, batch by batch,
  /// until none waits or at least `most` were passed. @return their number
  template <class Take>
  std::size_t drain(const Socket& socket, std::size_t most, Take&& take) {
    std::size_t taken = 0;
    for (std::size_t n = 1; n > 0 && taken < most; taken += n) {
      n = fill(socket);
      for (std::size_t i = 0; i < n; ++i) take(bytes(i), source(i));
    }
    return taken;
  }

  /// Returns a datagram of the last `fill`. Valid until the next `fill`.
  std::span<const std::uint8_t> bytes(std::size_t i) const;
  Endpoint source(std::size_t i) const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace sf::netio
