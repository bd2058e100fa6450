#pragma once
// One client of the Player server: bytes in, messages out.
//
// Data of a device that the client has not been sent yet is replaced by newer data, so a slow client skips ahead. In
// push mode data goes out when it comes; in pull mode a round goes out when the client asks for one, and a message ends
// it (docs/bridges.md).

#include <chrono>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "bridges/player/protocol.h"
#include "netio/tcp.h"

namespace sf::bridges::player {

inline constexpr std::size_t kMostRequest = 64u << 10;  ///< [byte] payload of a client's message
inline constexpr std::size_t kMostWaiting = 16u << 20;  ///< [byte] of data for one client that is not sent yet
inline constexpr std::size_t kMostUnsent = 32u << 20;   ///< [byte] more of answers end the connection

/// A device that a client has opened.
struct Subscription {
  std::uint32_t device = 0;  ///< row of `Devices`
  base::Bytes waiting;       ///< the newest message of data, with its header; empty: none
  bool described = false;    ///< geometry and configuration were sent with data
  bool describes = false;    ///< `waiting` has them
};

/// One thread.
class Connection {
 public:
  /// Greets the client. @param port row of the port it came to  @param local address and port of this end
  /// @param host address of the client
  Connection(netio::Socket socket, std::size_t port, const netio::Endpoint& local, std::uint32_t host);

  /// Passes each whole message to `take(const Header&, std::span<const std::uint8_t> payload)`, which returns false
  /// when it is malformed. @return false when the connection has ended, or is to end
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
  /// Open devices, by address.
  std::map<Address, Subscription>& subscriptions() { return subscriptions_; }
  void unsubscribe(const Address& address);
  /// Replaces the data that waits for a subscription. Dropped where too much waits.
  void put_data(const Address& address, Subscription& subscription, std::uint32_t subtype, double time,
                std::span<const std::uint8_t> payload);
  /// Sends what the client takes. @return false when the connection has ended, or is to end
  bool flush(double time);
  /// Something waits for room.
  bool is_full() const { return sent_ < out_.size(); }

  std::uint32_t host() const { return host_; }
  /// Of its last whole message, or of its beginning.
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
  base::Bytes in_;   ///< received, not a whole message yet
  base::Bytes out_;  ///< of which `sent_` bytes are sent
  std::size_t sent_ = 0;
  std::size_t waiting_ = 0;  ///< [byte] of data
  std::uint32_t sequence_ = 0;
  bool pull_ = false;
  bool asked_ = false;  ///< for a round of data
  std::map<Address, Subscription> subscriptions_;
};

}  // namespace sf::bridges::player
