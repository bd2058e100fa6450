#pragma once
// Exchange of maps between the explorers of a team in separate processes, by TEAM_MAP packets (docs/packets.md).
//
//   MapExchange exchange({.robot = 7, .session = session});
//   exchange.publish(controller.shared_map());                               // after each step
//   exchange.send(now, [&](const netio::TeamMap& map) { ... });              // packets that are due
//   exchange.receive(packet.header, std::get<netio::TeamMap>(packet.body), now);
//   controller.receive_maps(exchange.teammates(now));                        // before each step
//
// Measurements arrive completely and in order: each robot acknowledges the pieces that it has received of each other
// robot, and a sender repeats those that a present teammate lacks (selective repeat). So the list of changes that a
// teammate holds is that of the sender, as in a simulation. Claims are states: the last one counts.
//
// Not thread-safe. Reads no clock.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "control/shared_map.h"
#include "netio/packets.h"

namespace sf::server {

struct MapExchangeOptions {
  std::uint32_t robot = 0;    ///< own id
  std::uint32_t session = 0;  ///< own session, as in its packets
  std::size_t most_bytes =
      8u << 20;  ///< [byte] of measurements, encoded, that are accepted of one robot; pieces below 64 bytes count as 64
};

struct MapExchangeCounts {
  std::uint64_t sent = 0;          ///< TEAM_MAP packets
  std::uint64_t pieces = 0;        ///< of these with a piece of measurements
  std::uint64_t repeated = 0;      ///< of these with a piece that was sent before
  std::uint64_t cut = 0;           ///< of `sent` with a claim that did not fit
  std::uint64_t received = 0;      ///< TEAM_MAP packets
  std::uint64_t changes = 0;       ///< complete sets of measurements received
  std::uint64_t malformed = 0;     ///< sets of measurements that were dropped, because their bytes have another form
  std::uint64_t foreign = 0;       ///< of `received`: of a map of another area, ignored
  std::uint64_t full = 0;          ///< robots of which no more measurements are accepted
  std::uint32_t last_foreign = 0;  ///< id of the last robot with a map of another area
};

class MapExchange {
 public:
  static constexpr double kRate = 50.0;                     ///< [1/s] packets sent, at most
  static constexpr double kBurst = 10.0;                    ///< packets sent at once, at most
  static constexpr std::size_t kMaxPiece = 1000;            ///< [byte]
  static constexpr std::size_t kMaxRuns = 250;              ///< of a claim
  static constexpr std::size_t kWindow = 32;                ///< pieces from the first that a teammate lacks
  static constexpr std::int64_t kAckTimeout = 500'000'000;  ///< [ns] after which a piece is sent again
  static constexpr std::int64_t kBeat = 500'000'000;        ///< [ns] between packets while nothing changes
  static constexpr std::int64_t kPatience = 5'000'000'000;  ///< [ns] without progress: others are served first

  explicit MapExchange(const MapExchangeOptions& options) : options_(options) {}

  /// Sets the own map. Its changes and those of the last call have the same beginning. Null: none yet.
  void publish(std::shared_ptr<const control::SharedMap> map);

  /// Called with a packet, which is valid during the call.
  using SendMap = std::function<void(const netio::TeamMap&)>;
  /// Passes the packets that are due. @param now [ns] of any clock that does not decrease
  void send(std::int64_t now, const SendMap& send);

  /// Processes a packet of another robot of the team. Packets may be lost, repeated or overtaken. Ignores all before
  /// the own map is known.
  void receive(const netio::Header& header, const netio::TeamMap& map, std::int64_t now);

  /// The maps of the robots from which a packet arrived in the last two seconds, by id. Valid until the next call.
  std::span<const control::TeammateMap> teammates(std::int64_t now);

  /// Returns whether all present teammates have all published measurements, except those that make no progress.
  bool is_complete(std::int64_t now) const;

  const MapExchangeCounts& counts() const { return counts_; }

 private:
  struct Piece {
    base::Bytes bytes;
    bool ends = false;
    std::optional<std::int64_t> sent;  ///< [ns] when it was sent last; nullopt: not yet
  };
  struct Teammate {
    std::uint32_t session = 0;
    std::optional<std::uint32_t> session_before;  ///< packets of it are late for two seconds
    std::int64_t started = 0;                     ///< [ns] arrival of the first packet of this session
    std::int64_t last = 0;                        ///< [ns] arrival of its last packet
    // Own pieces that it has received.
    std::size_t acked = 0;                      ///< number, from the first
    std::uint32_t later = 0;                    ///< as in netio::MapAck
    std::optional<std::uint32_t> ack_sequence;  ///< of the packet with its last acknowledgement
    bool takes_no_more = false;
    std::int64_t progress = 0;  ///< [ns] when it last had all pieces, or acknowledged some
    // Its pieces that this robot has received.
    std::uint32_t pieces = 0;              ///< received in order
    std::map<std::uint32_t, Piece> early;  ///< received before earlier ones, at most kWindow
    std::size_t bytes = 0;                 ///< of all these
    base::Bytes partial;                   ///< of the changes that are not complete
    bool is_full = false;
    std::optional<std::uint32_t> claim_sequence;  ///< of the packet with its last claim
    control::SharedMap map;
    std::shared_ptr<const control::SharedMap> snapshot;  ///< of `map`; null: changed since
  };
  static bool is_present(const Teammate& teammate, std::int64_t now);
  bool lacks_pieces(const Teammate& teammate, std::int64_t now) const;
  Teammate& teammate_of(const netio::Header& header, std::int64_t now);
  void take_acks(const netio::Header& header, const netio::TeamMap& map, std::int64_t now, Teammate& teammate) const;
  void take_piece(const netio::TeamMap& map, Teammate& teammate);
  void append_piece(const Piece& piece, Teammate& teammate);
  void add_pieces(const control::MapChanges& changes);
  static netio::MapAck ack_of(std::uint32_t id, const Teammate& teammate);
  netio::TeamMap head() const;
  void gather_acks(std::int64_t now);
  void send_claim(std::int64_t now, const SendMap& send);
  void send_pieces(std::int64_t now, const SendMap& send);
  void send_lacking(const Teammate& teammate, std::size_t most, std::int64_t now, const SendMap& send);

  MapExchangeOptions options_;
  std::shared_ptr<const control::SharedMap> own_;  ///< null before the first
  std::vector<Piece> pieces_;                      ///< of its changes
  std::size_t encoded_ = 0;                        ///< number of changes in `pieces_`
  std::size_t first_served_ = 0;                   ///< teammate that is served first
  std::optional<std::vector<std::int64_t>> sent_claim_;
  std::int64_t last_claim_ = 0;  ///< [ns] when it was sent
  double allowed_ = kBurst;      ///< packets
  std::int64_t last_send_ = 0;   ///< [ns]
  bool owes_ack_ = false;        ///< a piece arrived since the last packet was sent
  std::size_t first_ack_ = 0;    ///< teammate that the next acknowledgements begin with, if there are too many
  base::Bytes acks_, claim_;
  std::map<std::uint32_t, Teammate> teammates_;  ///< by id
  std::vector<control::TeammateMap> present_;
  MapExchangeCounts counts_;
};

}  // namespace sf::server
