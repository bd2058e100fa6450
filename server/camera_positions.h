#pragma once
// Estimates a robot's own state from cameras: receives TAG packets (`sensorfarm vps`) of the tag that the robot carries
// and filters them as `serve --filter` filters states.
//
//   CameraPositions cameras(world, mover, 7, {.bind = {kLoopback, 9100}});
//   cameras.receive(now);
//   cameras.predict(now);
//   if (cameras.is_fresh()) use(cameras.state());

#include <cstdint>
#include <vector>

#include "base/report.h"
#include "netio/inbox.h"
#include "robots/pose_trail.h"
#include "server/state_filter.h"
#include "world/world.h"

namespace sf::server {

struct CameraPositionsOptions {
  netio::Endpoint bind;            ///< where TAG packets arrive; port 0: any free port
  StateFilterOptions filter;       ///< `stale_after`: how long a state remains valid without cameras
  std::vector<netio::Peer> peers;  ///< the peer of the tag, or empty
};

/// Errors of estimates compared with the truth.
struct PositionErrors {
  std::uint64_t count = 0;
  double squares = 0.0;          ///< [m²] sum of squared position errors
  double largest = 0.0;          ///< [m]
  double largest_heading = 0.0;  ///< [rad]

  double rms() const;  ///< [m]; 0 if empty
};
void add(PositionErrors& errors, const base::Pose& estimate, const base::Pose& truth);

/// Times [ns] are on the robot's monotonic clock, which starts at 0. The world must outlive it. Not thread-safe.
class CameraPositions {
 public:
  /// @param tag in [netio::kMinTag, netio::kMaxId]
  /// @throws netio::PortInUse, base::InputError if the address cannot be bound
  CameraPositions(const world::World& world, std::uint32_t mover, std::uint32_t tag,
                  const CameraPositionsOptions& options);

  /// [ns] Unix time at the robot's time 0, for estimation::ClockSource::trusted.
  void set_epoch(std::int64_t epoch) { filter_.set_epoch(epoch); }
  /// Processes the waiting datagrams, up to a limit.
  void receive(std::int64_t now);
  /// Predicts the state to `now`.
  void predict(std::int64_t now);

  // As of the last `predict`.
  bool is_fresh() const { return filter_.quality(mover_).stated && !filter_.quality(mover_).stale; }
  const base::Report& state() const { return state_; }  ///< valid once it has been fresh
  base::Pose pose_at(std::int64_t time) const { return trail_.at(time); }

  std::uint16_t port() const { return inbox_.port(); }
  const netio::PacketCounts& packets() const { return inbox_.counts(); }
  StateFilterCounts states() const { return filter_.counts(); }

 private:
  std::uint32_t mover_;
  netio::Inbox inbox_;
  StateFilter filter_;
  base::Report state_;
  robots::PoseTrail trail_;  ///< of estimates, each made at its own time
};

}  // namespace sf::server
