#pragma once
// The incoming side of `serve`: states for the fleet, packets for the relay, challenges for unproven addresses.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/report.h"
#include "netio/inbox.h"
#include "netio/outbox.h"
#include "netio/rate_limited_log.h"
#include "netio/rejection_log.h"
#include "netio/relay.h"
#include "netio/signature_trouble_log.h"
#include "robots/fleet.h"
#include "server/state_filter.h"
#include "server/wire_ids.h"
#include "world/world.h"

namespace sf::server {

struct StateReceiverOptions {
  netio::Endpoint bind = {netio::kLoopback, netio::kInboxPort};
  double radio = netio::kV2vRange;  ///< [m] farther away, states are not relayed; 0: none is
  double forget = 10.0;             ///< [s] of silence after which a robot is no obstacle any more; 0: never
  int log_descriptor = 2;           ///< -1: no log
  StateFilterOptions filter;
  std::vector<netio::Peer> peers;     ///< of the world's robots, tags and intersections, and START
  std::vector<std::uint32_t> lights;  ///< ids of intersections whose V2I are taken
};

/// Times are of one clock [ns] that does not go back. The world must outlive it. One thread.
class StateReceiver {
 public:
  /// @throws netio::PortInUse, or base::InputError when the address cannot be bound.
  StateReceiver(const world::World& world, const StateReceiverOptions& options);

  /// From now on `handler` is given accepted V2I.
  using LightHandler = std::function<void(const netio::Header&, const netio::V2i&, std::int64_t now)>;
  void set_light_handler(LightHandler handler) { light_handler_ = std::move(handler); }

  /// Takes every datagram that waits.
  void receive_pending(std::int64_t now);
  /// Queues a packet for robot `id`, which is active, with its session and signature; it leaves with `relay`.
  void queue(std::uint32_t id, std::span<const std::uint8_t> packet);
  /// Passes on what came since the last time, to robots that asked for it.
  void relay(std::int64_t now);
  /// Predicts the states to `now`, for the calls below.
  void predict(std::int64_t now);
  /// Whether a robot spoke once and has been silent since for as long as `forget`, or its state is stale and the policy
  /// takes it out of the world: until it speaks again. To be asked at each tick.
  bool update_absent(std::uint32_t id, std::int64_t now);
  /// Likewise of a tag, whose silence alone does not matter, and which an OBJECT can take out of the world.
  bool update_absent_tag(std::uint32_t row);
  /// The newest states at `now`. They live until the next call.
  std::span<const base::Report> states(std::int64_t now) { return fleet_.predict(now); }
  /// Of a mover's state at `now`. Unfiltered states are as old as their arrival, of unknown covariance.
  netio::StateQuality quality(std::uint32_t row, std::int64_t now) const;

  const std::map<std::uint32_t, std::uint32_t>& robots() const { return names_.robots; }  ///< rows by id
  const std::map<std::uint32_t, std::uint32_t>& tags() const { return names_.tags; }      ///< likewise
  const StateFilter& filter() const { return filter_; }
  StateFilter& filter() { return filter_; }
  const netio::Inbox& inbox() const { return inbox_; }
  netio::Inbox& inbox() { return inbox_; }
  const netio::RelayCounts& relayed() const { return relay_.counts(); }
  netio::OutboxCounts answered() const { return answers_.counts(); }  ///< challenges, and relayed packets
  netio::RateLimitedLog& log() { return log_; }
  const netio::RateLimitedLog& log() const { return log_; }

 private:
  void take(const netio::Packet& packet, std::int64_t now);
  std::string name_of(const netio::Header& header) const;
  std::string sender_text(const netio::Header& header) const;
  std::optional<netio::Endpoint> bound_address(const netio::Header& header, std::int64_t now) const;
  void log_wrong_source(const netio::Packet& packet, const netio::Endpoint& who, std::int64_t now);

  static constexpr std::int64_t kNever = -1;

  const world::World& world_;
  WireNames names_;
  netio::Inbox inbox_;
  std::vector<netio::Peer> peers_;
  netio::Outbox answers_;  ///< from the port that the robots send to
  netio::Relay relay_;
  robots::Fleet fleet_;
  StateFilter filter_;
  std::vector<base::Report> reports_;
  base::Bytes challenge_;
  std::int64_t forget_;  ///< [ns] since it was last active, or kNever
  LightHandler light_handler_;
  std::vector<bool> removed_;              ///< per mover, by OBJECT
  std::vector<std::int64_t> last_active_;  ///< [ns] per mover
  std::vector<std::int64_t> last_state_;   ///< [ns] arrival, per mover, or kNever
  netio::RateLimitedLog log_;
  netio::SignatureTroubleLog trouble_;
  netio::RejectionLog rejections_;
  /// The bound address whose other senders are in the log already.
  std::map<std::pair<netio::PeerKind, std::uint32_t>, std::optional<netio::Endpoint>> logged_;
};

}  // namespace sf::server
