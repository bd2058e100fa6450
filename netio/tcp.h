#pragma once
// Non-blocking TCP sockets on POSIX (Linux), and a wait for many of them.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/byte_line.h"
#include "netio/socket.h"

namespace sf::netio {

/// @throws PortInUse
/// @throws base::InputError if the address does not belong to this machine or no descriptors are left
Socket listen_tcp(const Endpoint& bind);

/// Accepts the next waiting connection, without delays for small messages. The descriptor is -1 if no connection waits
/// or none can be accepted.
/// @param peer out: the remote endpoint
Socket accept_tcp(const Socket& listener, Endpoint& peer);

/// Connects, without delays for small messages.
/// @param wait_ms [ms] to wait for the connection; 0: it continues to connect, and ends if that fails
/// @throws base::InputError if the connection fails at once, or within `wait_ms`, or no descriptors are left
Socket connect_tcp(const Endpoint& server, int wait_ms);

/// Returns the number of bytes received into `bytes`, which is not empty; 0: no bytes wait; nullopt: the connection has
/// ended.
std::optional<std::size_t> receive_some(const Socket& connection, std::span<std::uint8_t> bytes);
/// Returns the number of bytes sent from the front of `bytes`; 0: the connection is full; nullopt: it has ended.
std::optional<std::size_t> send_some(const Socket& connection, std::span<const std::uint8_t> bytes);

/// A connection to a robot's server.
class TcpLine final : public ByteLine {
 public:
  /// Maximum number of bytes waiting to be sent.
  static constexpr std::size_t kMostWaiting = 4096;

  /// Connects as `connect_tcp`.
  TcpLine(const Endpoint& server, int wait_ms) : ByteLine(connect_tcp(server, wait_ms), kMostWaiting) {}

 private:
  std::optional<std::size_t> receive(std::span<std::uint8_t> bytes) override {
    return receive_some(descriptor(), bytes);
  }
  std::optional<std::size_t> send(std::span<const std::uint8_t> bytes) override {
    return send_some(descriptor(), bytes);
  }
};

/// Waits for sockets. Single-threaded, except `wake`. Closed sockets are removed automatically.
class SocketWait {
 public:
  static constexpr std::uint64_t kWoken = ~std::uint64_t{0};  ///< key of `wake`

  /// @throws base::InputError if no descriptors are left
  SocketWait();

  /// Reports each new connection once: after a report, accept all waiting connections.
  void add_listener(const Socket& listener, std::uint64_t key);
  void add(const Socket& connection, std::uint64_t key);
  /// @param room also report when the connection has room to send
  void update(const Socket& connection, std::uint64_t key, bool room);

  /// Waits for at least one socket. Returns the keys of sockets that can be read (or written, if requested), or have
  /// ended; valid until the next call.
  std::span<const std::uint64_t> wait();
  /// Ends a wait with kWoken, which precedes the sockets' keys. Callable from any thread.
  void wake();

 private:
  Socket epoll_;
  Socket event_;
  std::vector<std::uint64_t> ready_;
};

}  // namespace sf::netio
