#pragma once
// The ports that sensors' packets come to.
//
// One socket per port, since Linux has no way for an ordinary user to take a range of ports with one; one epoll set
// over all, so that a thousand quiet ports cost nothing, and recvmmsg on each that has something.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "netio/ports.h"
#include "netio/socket.h"

namespace sf::netio {

/// What to expect on one port.
struct StreamSpec {
  std::uint32_t robot = 0;
  std::uint32_t sensor = 0;
  PortRule rule;
  std::string kind = "sensor";  ///< for the error where ports collide
};

/// One thread.
class PortListener {
 public:
  /// Binds all ports of `address` (0: of every interface), raising the limit of open files as needed.
  /// @param receive_buffer [byte] per port, asked of the kernel
  /// @throws base::InputError when ports collide, are taken, or are more than the machine allows.
  PortListener(std::uint32_t address, std::size_t receive_buffer, std::span<const StreamSpec> streams);

  /// Waits at most `timeout_ms` (0: not at all) for something to come, then gives `take(std::size_t stream,
  /// std::span<const std::uint8_t> bytes, const Endpoint& source)` all that waits, as far as it is not a flood. Returns
  /// datagrams taken.
  template <class Take>
  std::size_t drain(int timeout_ms, Take&& take) {
    std::size_t taken = 0;
    for (wait(timeout_ms); !ready_.empty() && taken < kMaxPerDrain; wait(0)) {
      for (const std::size_t stream : ready_) {
        const std::size_t n = batch_.fill(sockets_[stream]);
        for (std::size_t i = 0; i < n; ++i) take(stream, batch_.bytes(i), batch_.source(i));
        taken += n;
      }
    }
    return taken;
  }

  /// Readable while anything waits on any port: for wait_readable.
  const Socket& epoll() const { return epoll_; }
  std::size_t receive_buffer_size() const;  ///< [byte] receive buffer of the first port; 0 without ports
  std::uint64_t kernel_drops() const;       ///< datagrams that came while a port's buffer was full

 private:
  static constexpr std::size_t kMaxPerDrain = 65'536;  ///< so that a flood cannot keep others from being served
  /// Fills `ready_` with the streams that have something.
  void wait(int timeout_ms);

  Socket epoll_;
  std::vector<Socket> sockets_;  ///< per stream
  std::vector<std::size_t> ready_;
  ReceiveBatch batch_;
};

}  // namespace sf::netio
