#pragma once
// The incoming side of `serve`: states for the fleet, packets for the relay, challenges for unproven addresses.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
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
#include "world/shapes.h"
#include "world/world.h"

namespace sf::server {

struct StateReceiverOptions {
  netio::Endpoint bind = {netio::kLoopback, netio::kInboxPort};
  double radio = netio::kV2vRange;  ///< [m] range within which states are relayed; 0: no relay
  double forget = 10.0;             ///< [s] of silence after which a robot is no longer an obstacle; 0: never
  int log_descriptor = 2;           ///< -1: no log
  /// Rows of robots, tags and posts of lights that are in the world only from their first state until they leave or are
  /// silent for netio::kSenderTimeout.
  std::vector<std::uint32_t> joining;
  bool keep_heights = false;  ///< movers keep their heights at load, regardless of their states
  StateFilterOptions filter;
  std::vector<netio::Peer> peers;     ///< of the world's robots, tags and intersections, and of START
  std::vector<std::uint32_t> lights;  ///< ids of intersections whose V2I are accepted
};

/// Times [ns] are on one monotonic clock. The world must outlive it. Not thread-safe.
class StateReceiver {
 public:
  /// @throws netio::PortInUse, base::InputError if the address cannot be bound
  StateReceiver(const world::World& world, const StateReceiverOptions& options);

  /// Sets the handler of accepted V2I.
  using LightHandler = std::function<void(const netio::Header&, const netio::V2i&, std::int64_t now)>;
  void set_light_handler(LightHandler handler) { light_handler_ = std::move(handler); }
  /// Sets the handler of accepted LANE.
  using LaneHandler = std::function<void(const netio::Lane&)>;
  void set_lane_handler(LaneHandler handler) { lane_handler_ = std::move(handler); }

  /// Sets the handler of accepted OWN_READINGS of the robot in row `mover`.
  using OwnReadingsHandler =
      std::function<void(const netio::Header&, const netio::OwnReadings&, std::uint32_t mover, std::int64_t now)>;
  void set_own_readings_handler(OwnReadingsHandler handler) { own_readings_handler_ = std::move(handler); }

  /// Returns the changes of shapes that were requested since the last call, by row: the newest of each kind. Robots
  /// and tags that joined and left get their original shape.
  std::map<std::uint32_t, world::ShapeChange> take_shape_changes() { return std::exchange(shape_changes_, {}); }
  /// Requests a change as an OBJECT does.
  void change_shape(std::uint32_t row, const world::ShapeChange& wanted);
  /// Call this after the outline of a mover has changed in the world.
  void update_outline(std::uint32_t row) { fleet_.update_outline(row); }

  /// Processes every waiting datagram.
  void receive_pending(std::int64_t now);
  /// Queues a packet for the active robot `id`, with its session and signature. `relay` sends it.
  void queue(std::uint32_t id, std::span<const std::uint8_t> packet);
  /// Forwards packets received since the last call to robots that subscribed to them.
  void relay(std::int64_t now);
  /// Predicts the states to `now` for the calls below.
  void predict(std::int64_t now);
  /// Returns whether a robot is absent: it was active and has been silent for `forget`, or the policy removes stale
  /// states from the world and either its state is stale, or it has sent no state yet and is not active. Call it at
  /// each tick.
  bool update_absent(std::uint32_t id, std::int64_t now);
  /// Returns whether a tag is absent: an OBJECT removed it, or its state is stale and the policy removes stale states.
  /// A tag without any state is in the world, unless it is one that joins.
  bool update_absent_tag(std::uint32_t id, std::int64_t now);
  /// Returns whether the post of a light that joins is absent: no V2I of it was accepted in the last two seconds.
  bool update_absent_light(std::uint32_t id, std::int64_t now);
  /// Returns whether a TAG or an OBJECT was accepted for the object in this row: packets move it.
  bool is_moved_by_packets(std::uint32_t row) const { return heard_[row]; }
  /// Sets the state of an object that no packets move, as if a packet with it had arrived at its time.
  void place(const base::Report& report, bool present);
  /// Returns the outlines and the presence of the movers.
  const robots::Fleet& fleet() const { return fleet_; }
  /// Returns the newest states at `now`, valid until the next call.
  std::span<const base::Report> states(std::int64_t now) { return fleet_.predict(now); }
  /// Returns the quality of a mover's state at `now`. The age of unfiltered states counts from their arrival, and their
  /// covariance is unknown.
  netio::StateQuality quality(std::uint32_t row, std::int64_t now) const;

  const std::map<std::uint32_t, std::uint32_t>& robots() const { return names_.robots; }  ///< rows by id
  const std::map<std::uint32_t, std::uint32_t>& tags() const { return names_.tags; }      ///< rows by id
  const std::map<std::uint32_t, std::uint32_t>& lights() const { return names_.lights; }  ///< rows of posts by id
  const StateFilter& filter() const { return filter_; }
  StateFilter& filter() { return filter_; }
  const netio::Inbox& inbox() const { return inbox_; }
  netio::Inbox& inbox() { return inbox_; }
  const netio::RelayCounts& relayed() const { return relay_.counts(); }
  netio::OutboxCounts answered() const { return answers_.counts(); }  ///< challenges and relayed packets
  netio::RateLimitedLog& log() { return log_; }
  const netio::RateLimitedLog& log() const { return log_; }

 private:
  void take(const netio::Packet& packet, std::int64_t now);
  bool filter(const base::Report& report, const netio::Header& header, std::int64_t now);
  bool hides_stale() const;
  void change_shape(std::uint32_t row, const netio::Object& object);
  void forget_sender(const netio::Claim& sender, std::uint32_t row);
  void forget_silent(const netio::Claim& sender, std::uint32_t row, std::int64_t now);
  void place_light(const netio::Header& header, const netio::V2i& signals, std::int64_t now);
  bool is_gone(std::uint32_t row, std::int64_t now) const;
  std::string sender_name(const netio::Header& header) const;
  std::string sender_text(const netio::Header& header) const;
  std::optional<netio::Endpoint> bound_address(const netio::Header& header, std::int64_t now) const;
  void log_wrong_source(const netio::Packet& packet, const netio::Endpoint& who, std::int64_t now);

  static constexpr std::int64_t kNever = -1;
  static constexpr std::int64_t kLongestPeriod = 2'000'000'000;  ///< [ns] of a sender that counts as slow

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
  bool keep_heights_;
  std::int64_t forget_;  ///< [ns] timeout since the last activity, or kNever
  LightHandler light_handler_;
  LaneHandler lane_handler_;
  OwnReadingsHandler own_readings_handler_;
  std::vector<bool> removed_;  ///< per mover, by OBJECT or `place`
  std::vector<bool> heard_;    ///< per mover: see is_moved_by_packets
  std::map<std::uint32_t, world::ShapeChange> shape_changes_;
  std::vector<bool> joining_;              ///< per mover: StateReceiverOptions::joining
  std::vector<std::int64_t> last_active_;  ///< [ns] per mover, or kNever
  std::vector<std::int64_t> last_state_;   ///< [ns] arrival per mover, or kNever
  std::vector<std::int64_t> periods_;      ///< [ns] per mover, between its last two states; at most kLongestPeriod
  std::vector<bool> hidden_;               ///< per mover: absent though active, which was logged
  std::vector<bool> filter_logged_;        ///< per mover: the log has a line of its filter
  netio::RateLimitedLog log_;
  netio::SignatureTroubleLog trouble_;
  netio::RejectionLog rejections_;
  /// The bound address for which other senders have already been logged.
  std::map<std::pair<netio::PeerKind, std::uint32_t>, std::optional<netio::Endpoint>> logged_;
};

}  // namespace sf::server
