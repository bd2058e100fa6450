#pragma once
// One client of the Player server: receives bytes, sends messages.
//
// New data of a device replaces its unsent data, so a slow client skips ahead. In push mode data is sent when it
// arrives. In pull mode a round is sent when the client requests one, and ends with a message (docs/bridges.md).

#include <chrono>
#include <cstdint>
#include <map>
#include <span>

#include "base/bytes.h"
#include "netio/player/protocol.h"
#include "netio/tcp.h"

namespace sf::bridges::player {

using namespace netio::player;

inline constexpr std::size_t kMostRequest = 64u << 10;  ///< [byte] maximum payload of a client's message
inline constexpr std::size_t kMostWaiting = 16u << 20;  ///< [byte] maximum unsent data for one client
inline constexpr std::size_t kMostUnsent = 32u << 20;   ///< [byte] of answers beyond which the connection is closed

/// A device opened by a client.
struct Subscription {
  std::uint32_t device = 0;  ///< row of `Devices`
  base::Bytes waiting;       ///< the newest data message, with its header; empty: none
  bool described = false;    ///< whether geometry and configuration were sent with data
  bool describes = false;    ///< whether `waiting` contains them
};

/// Not thread-safe.
class Connection {
 public:
  /// Greets the client.
  /// @param port row of the port it connected to @param local address and port of this end @param host address of the
  /// client
  Connection(netio::Socket socket, std::size_t port, const netio::Endpoint& local, std::uint32_t host);

  /// Passes each complete message to `take(const Header&, std::span<const std::uint8_t> payload)`, which returns false
  /// for a malformed message.
  /// @return false: the connection has ended or must be closed
  template <class Take>
  bool receive(Take&& take) {
    const bool open = fill();
    std::size_t at = 0;
    while (in_.size() - at >= kHeaderBytes) {
      const Header header = read_header(std::span(in_).subspan(at));
      if (header.size > kMostRequest) return false;
      if (in_.size() - at < kHeaderBytes + header.size) break;
      heard_ = std::chrono::steady_clock::now();
      if (!take(header, std::span<const std::uint8_t>(in_).subspan(at + kHeaderBytes, header.size))) return false;
      at += kHeaderBytes + header.size;
    }
    in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(at));
    return open;
  }

  /// Answers a request. @param time [s]
  void answer(const Header& request, MessageType type, std::span<const std::uint8_t> payload, double time);
  void set_mode(DataMode mode) { pull_ = mode == DataMode::pull; }
  void ask_for_data() { asked_ = true; }
  /// Returns the open devices by address.
  std::map<Address, Subscription>& subscriptions() { return subscriptions_; }
  void unsubscribe(const Address& address);
  /// Replaces the unsent data of a subscription. Drops it if too much is unsent.
  void put_data(const Address& address, Subscription& subscription, std::uint32_t subtype, double time,
                std::span<const std::uint8_t> payload);
  /// Sends as much as the client accepts.
  /// @return false: the connection has ended or must be closed
  bool flush(double time);
  /// Returns whether output is waiting for buffer space.
  bool is_full() const { return sent_ < out_.size(); }

  std::uint32_t host() const { return host_; }
  /// Returns the time of its last complete message, or of its start.
  std::chrono::steady_clock::time_point heard() const { return heard_; }
  const netio::Socket& socket() const { return socket_; }
  std::size_t port() const { return port_; }

 private:
  bool fill();
  bool send();
  void add(const Header& header, std::span<const std::uint8_t> payload);
  void add_round(double time);

  netio::Socket socket_;
  std::size_t port_;
  netio::Endpoint local_;
  std::uint32_t host_;
  std::chrono::steady_clock::time_point heard_ = std::chrono::steady_clock::now();
  base::Bytes in_;   ///< received, incomplete message
  base::Bytes out_;  ///< `sent_` bytes of it are sent
  std::size_t sent_ = 0;
  std::size_t waiting_ = 0;  ///< [byte] of unsent data
  std::uint32_t sequence_ = 0;
  bool pull_ = false;
  bool asked_ = false;  ///< a round of data was requested
  std::map<Address, Subscription> subscriptions_;
};

}  // namespace sf::bridges::player
