#pragma once
// Listens on the ports at which sensors' packets arrive.
//
// Each port has its own socket, because Linux offers no unprivileged socket for a range of ports. One epoll set covers
// all sockets, so idle ports cost nothing; recvmmsg reads each ready socket.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "netio/ports.h"
#include "netio/socket.h"

namespace sf::netio {

/// The stream of readings expected on one port.
struct StreamSpec {
  std::uint32_t robot = 0;
  std::uint32_t sensor = 0;
  PortRule rule;
  std::string type = "sensor";  ///< used in messages about colliding ports
};

/// Single-threaded.
class PortListener {
 public:
  /// Binds all ports at `address` (0: all interfaces) and raises the limit of open files as needed.
  /// @param receive_buffer [byte] per port, requested from the kernel
  /// @throws base::InputError if ports collide, are in use, or exceed the machine's limits
  PortListener(std::uint32_t address, std::size_t receive_buffer, std::span<const StreamSpec> streams);

  /// Waits at most `timeout_ms` (0: no wait) for a datagram, then passes all waiting ones, up to a limit, to
  /// `take(std::size_t stream, std::span<const std::uint8_t> bytes, const Endpoint& source)`.
  /// @return number of datagrams
  template <class Take>
  std::size_t drain(int timeout_ms, Take&& take) {
    std::size_t taken = 0;
    for (wait(timeout_ms); !ready_.empty() && taken < kMaxPerDrain; wait(0)) {
      for (const std::size_t stream : ready_)  // one batch per stream, so that no stream delays the others
        taken += batch_.drain(sockets_[stream], 1, [&](std::span<const std::uint8_t> bytes, const Endpoint& source) {
          take(stream, bytes, source);
        });
    }
    return taken;
  }

  /// Readable while a datagram waits on any port; for wait_readable.
  const Socket& epoll() const { return epoll_; }
  std::size_t receive_buffer_size() const;  ///< [byte] size at the first port; 0 without ports
  std::uint64_t socket_drops() const;       ///< datagrams lost to full receive buffers

 private:
  static constexpr std::size_t kMaxPerDrain = 65'536;  ///< bounds the duration under a flood
  /// Fills `ready_` with the streams that have datagrams.
  void wait(int timeout_ms);

  Socket epoll_;
  std::vector<Socket> sockets_;  ///< per stream
  std::vector<std::size_t> ready_;
  ReceiveBatch batch_;
};

}  // namespace sf::netio
