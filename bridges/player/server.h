#pragma once
// The Player server: its ports, clients and messages, on its own thread.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <thread>
#include <vector>

#include "bridges/player/connection.h"
#include "bridges/player/devices.h"
#include "bridges/player/exchange.h"
#include "bridges/player/requests.h"
#include "netio/player/xdr.h"
#include "netio/rate_limited_log.h"
#include "netio/tcp.h"

namespace sf::bridges::player {

inline constexpr std::size_t kMostClients = 64;
inline constexpr std::size_t kMostRobotPorts = 256;
inline constexpr double kSilent = 10.0;  ///< [s] without a message after which a connection may be replaced

struct ServerCounts {
  std::uint64_t clients = 0;    ///< accepted since the start
  std::uint64_t refused = 0;    ///< closed immediately, because kMostClients clients are connected and active
  std::uint64_t evicted = 0;    ///< closed for a new client
  std::uint64_t malformed = 0;  ///< connections closed because of a malformed message
};

class Server {
 public:
  /// All robots are at the first port. Robot k, counted from 1, is also alone at the k-th port after it, up to
  /// kMostRobotPorts.
  /// @param bind port 0: any free consecutive ports @param silent [s] in place of kSilent
  /// @param follows see Requester
  /// @throws base::InputError if a port is in use
  Server(const Scene& scene, const Devices& devices, Exchange& exchange, const netio::Endpoint& bind,
         double silent = kSilent, int log_descriptor = 2, const Follows& follows = {});
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Signals that data was published. Never blocks.
  void wake();
  /// The first port.
  netio::Endpoint endpoint() const { return endpoint_; }
  std::size_t ports() const { return ports_.size(); }
  ServerCounts counts() const { return {clients_, refused_, evicted_, malformed_}; }

 private:
  struct Port {
    netio::Socket listener;
    netio::Endpoint endpoint;
    Listing listing;
  };
  void open(const netio::Endpoint& first);
  void open_all(netio::Endpoint endpoint);
  void run();
  void accept_all(std::size_t port);
  bool make_room(std::uint32_t host);
  void note_full(const netio::Endpoint& peer);
  void receive(std::uint64_t key);
  void publish();
  void publish(Connection& connection);
  void flush();
  void end(std::uint64_t key);
  void subscribe(Connection& connection, const Address& address, std::uint32_t device);
  void unsubscribe(Connection& connection, const Address& address);
  bool handle(Connection& connection, const Header& header, std::span<const std::uint8_t> payload);
  bool handle_own(Connection& connection, const Header& header, std::span<const std::uint8_t> payload);
  bool open_or_close(Connection& connection, const Header& header, XdrReader& xdr);
  bool describe(Connection& connection, const Header& header, XdrReader& xdr);
  void list(Connection& connection, const Header& header);
  void put_address(const Connection& connection, const Address& address, XdrWriter& xdr) const;
  std::string driver_name(const Connection& connection, const Address& address) const;
  double time() const { return 1e-9 * static_cast<double>(snapshot_.time); }

  Scene scene_;
  const Devices& devices_;
  Exchange& exchange_;
  Requester requester_;
  netio::Endpoint endpoint_;
  std::vector<Port> ports_;
  netio::SocketWait wait_;
  Snapshot snapshot_;
  std::map<std::uint64_t, Connection> connections_;  ///< by key
  std::vector<std::uint32_t> users_;                 ///< per device
  base::Bytes payload_;
  std::uint64_t next_key_ = 0;
  std::atomic<std::uint64_t> clients_ = 0, refused_ = 0, evicted_ = 0, malformed_ = 0;
  std::atomic<bool> watched_ = false;  ///< by a client
  std::atomic<bool> stop_ = false;
  const double silent_;
  netio::RateLimitedLog log_;
  std::chrono::steady_clock::time_point next_line_;  ///< of a refused client
  std::uint64_t stated_ = 0;                         ///< value of `refused_` in the last line
  std::thread thread_;
};

}  // namespace sf::bridges::player
