#pragma once
// A robot's own state from cameras: TAG packets of the tag that it carries (`sensorfarm vps`), filtered as `serve
// --filter` does with states.
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
  netio::Endpoint bind;            ///< where TAG packets come; port 0: any free one
  StateFilterOptions filter;       ///< enabled or not; `stale_after` is the time that a state counts without cameras
  std::vector<netio::Peer> peers;  ///< of the tag, or none
};

/// Errors of estimates, by comparison with the truth.
struct PositionErrors {
  std::uint64_t count = 0;
  double squares = 0.0;          ///< [m²] sum over the positions
  double largest = 0.0;          ///< [m]
  double largest_heading = 0.0;  ///< [rad]

  double rms() const;  ///< [m]; 0 of none
};
void add(PositionErrors& errors, const base::Pose& estimate, const base::Pose& truth);

/// Times are of the robot's clock [ns], which begins at 0 and does not go back. The world must outlive it. One thread.
class CameraPositions {
 public:
  /// @param tag in [netio::kMinTag, netio::kMaxId]
  /// @throws netio::PortInUse, base::InputError when the address cannot be bound
  CameraPositions(const world::World& world, std::uint32_t mover, std::uint32_t tag,
                  const CameraPositionsOptions& options);

  /// [ns] Unix time at the robot's time 0, for estimation::ClockSource::trusted.
  void set_epoch(std::int64_t epoch) { filter_.set_epoch(epoch); }
  /// Takes every datagram that waits, up to a limit.
  void receive(std::int64_t now);
  /// Predicts the state to `now`.
  void predict(std::int64_t now);

  // As of the last `predict`.
  bool is_fresh() const { return filter_.quality(mover_).stated && !filter_.quality(mover_).stale; }
  const base::Report& state() const { return state_; }  ///< where it was fresh once
  base::Pose pose_at(std::int64_t time) const { return trail_.at(time); }

  std::uint16_t port() const { return inbox_.port(); }
  const netio::PacketCounts& packets() const { return inbox_.counts(); }
  StateFilterCounts states() const { return filter_.counts(); }

 private:
  std::uint32_t mover_;
  netio::Inbox inbox_;
  StateFilter filter_;
  base::Report state_;
  robots::PoseTrail trail_;  ///< of estimates, each made at its time
};

}  // namespace sf::server
