#pragma once
// Non-blocking TCP sockets on POSIX (Linux), and a wait for many of them at once.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/socket.h"

namespace sf::netio {

/// @throws PortInUse
/// @throws base::InputError when the address is not this machine's or no descriptors are left
Socket listen_tcp(const Endpoint& bind);

/// The next connection that waits, without delays for small messages. Its descriptor is -1 where none waits or none can
/// be taken.
/// @param peer out: its other end
Socket accept_tcp(const Socket& listener, Endpoint& peer);

/// [byte] received into `bytes`, which is not empty; 0: none wait; nullopt: the connection has ended.
std::optional<std::size_t> receive_some(const Socket& connection, std::span<std::uint8_t> bytes);
/// [byte] taken from the front of `bytes`; 0: the connection is full; nullopt: it has ended.
std::optional<std::size_t> send_some(const Socket& connection, std::span<const std::uint8_t> bytes);

/// Waits for sockets. One thread, except `wake`. Closed sockets leave by themselves.
class SocketWait {
 public:
  static constexpr std::uint64_t kWoken = ~std::uint64_t{0};  ///< key of `wake`

  /// @throws base::InputError when no descriptors are left
  SocketWait();

  /// Reports each new connection once: after a report, accept all that wait.
  void add_listener(const Socket& listener, std::uint64_t key);
  void add(const Socket& connection, std::uint64_t key);
  /// @param room also report when the connection has room to send
  void update(const Socket& connection, std::uint64_t key, bool room);

  /// Keys of sockets that can be read (or written, where asked for), or have ended. Waits for at least one; valid until
  /// the next call.
  std::span<const std::uint64_t> wait();
  /// Ends a wait with kWoken, ahead of the sockets' keys. From any thread.
  void wake();

 private:
  Socket epoll_;
  Socket event_;
  std::vector<std::uint64_t> ready_;
};

}  // namespace sf::netio
