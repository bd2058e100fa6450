#pragma once
// Estimates a robot's own state in its process: from its wheels, gyro and satellite receiver, and from TAG packets
// (`sensorfarm vps`) of the tag that it carries below overhead cameras.
//
//   OwnState own(mover, row, {.cameras = CameraOptions{.bind = {kLoopback, 9100}, .tag = 7}, .sensors = {.wheels =
//   encoder}}); own.receive(now); own.add_wheels(now, rolled); own.predict(now); if (!own.is_lost()) use(own.state());

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/report.h"
#include "control/own_localization.h"
#include "netio/inbox.h"
#include "robots/estimation/localization.h"
#include "robots/estimation/sender_clock.h"
#include "robots/pose_trail.h"
#include "world/world.h"

namespace sf::server {

struct CameraOptions {
  netio::Endpoint bind;   ///< where TAG packets arrive; port 0: any free port
  std::uint32_t tag = 0;  ///< in [netio::kMinTag, netio::kMaxId]
  estimation::ClockOptions clock;
  std::vector<netio::Peer> peers;  ///< the peer of the tag, or empty
  // Standard deviations of poses without a stated covariance.
  double position_sigma = 0.01;  ///< [m] > 0
  double yaw_sigma = 0.02;       ///< [rad] > 0
  double time_sigma = 0.01;      ///< [s] >= 0 standard deviation of the times of poses, added to stated covariances
};

struct OwnStateOptions {
  std::optional<CameraOptions> cameras;
  control::PositionSensors sensors;  ///< without wheels and receiver: cameras only
  std::optional<base::Pose> start;   ///< known start pose; nullopt: where cameras first see the robot
  std::int64_t stop_after = 0;       ///< [ns] after which a robot without wheels that no camera sees is lost; 0: never
  double most_sigma = 0.5;           ///< [m] > 0 standard deviation of the position at which a robot is lost
};

struct OwnStateCounts {
  netio::PacketCounts packets;            ///< from cameras
  estimation::VerdictCounts readings{};   ///< of wheels and cameras, by verdict
  std::array<std::uint64_t, 4> clocks{};  ///< poses from cameras except flooded ones, by estimation::ClockVerdict
  std::uint64_t flooded = 0;              ///< dropped beyond OwnState::kMostBetweenPredictions
};

/// Times [ns] are on the robot's monotonic clock, which starts at 0. Not thread-safe.
class OwnState {
 public:
  /// Maximum number of poses between two predictions; each may reapply a second of readings.
  static constexpr std::size_t kMostBetweenPredictions = 64;

  /// @throws netio::PortInUse, base::InputError if the address cannot be bound
  /// @param row of the mover
  OwnState(const world::Mover& mover, std::uint32_t row, const OwnStateOptions& options);

  /// [ns] Unix time at the robot's time 0, for estimation::ClockSource::trusted.
  void set_epoch(std::int64_t epoch) { epoch_ = epoch; }
  /// Processes the waiting datagrams of cameras, up to a limit.
  void receive(std::int64_t now);
  /// Adds the distances rolled since the start, as counted by the wheels' encoders.
  void add_wheels(std::int64_t now, const sensors::Rolled& rolled);
  /// Adds the yaw rate [rad/s] of a gyro.
  void add_gyro(std::int64_t now, double rate);
  /// Adds a satellite fix, up to a second after its time. @param p_MS [m] antenna in the robot's frame
  void add_gps(std::int64_t time, const glm::dvec2& antenna, double hdop, const glm::dvec2& p_MS);
  /// Predicts the state to `now`. @param z [m] its height
  void predict(std::int64_t now, double z = 0.0);

  // As of the last `predict`.
  /// Returns whether the position is unknown, or too uncertain to act on.
  bool is_lost() const { return lost_; }
  const base::Report& state() const { return state_; }  ///< valid once the robot was not lost
  base::TiltedPose pose_at(std::int64_t time) const { return trail_.at(time); }
  double sigma() const { return sigma_; }  ///< [m] standard deviation of the position; infinite: never located
  /// Quality of `state`: the age of the last pose or position, and the covariance.
  const netio::StateQuality& quality() const { return quality_; }
  bool has_wheels() const { return sensors().wheels.has_value(); }
  const control::PositionSensors& sensors() const { return options_.sensors; }

  std::uint16_t port() const { return inbox_ ? inbox_->port() : std::uint16_t{0}; }  ///< 0: no cameras
  estimation::Calibration calibration() const { return localization_.calibration(); }
  OwnStateCounts counts() const;

 private:
  void take(const netio::Header& header, const base::Report& seen, std::int64_t now);
  estimation::PoseCovariance covariance_of(const netio::Header& header) const;

  OwnStateOptions options_;
  std::optional<netio::Inbox> inbox_;
  estimation::Localization localization_;
  estimation::SenderClock clock_;
  std::uint32_t session_ = 0;
  base::Tilt tilt_;             ///< of the newest pose from cameras
  std::int64_t tilt_time_ = 0;  ///< [ns] of it, on the cameras' clock
  std::int64_t epoch_ = 0;      ///< [ns]
  std::size_t taken_ = 0;       ///< since the last prediction
  std::array<std::uint64_t, 4> clock_counts_{};
  std::uint64_t flooded_ = 0;
  bool lost_ = true;
  double sigma_ = std::numeric_limits<double>::infinity();
  netio::StateQuality quality_;
  base::Report state_;
  robots::PoseTrail trail_;  ///< of estimates, each made at its own time
};

}  // namespace sf::server
