#pragma once
// Localizes robots by dead reckoning and by range and bearing of landmarks and of each other: one robot alone, or a
// team with one joint covariance. Landmarks at unknown positions are mapped on the way.
//
//   TeamLocalization localization({.model = model, .robots = 1, .landmarks = landmarks});
//   localization.add_pose(0, time, X_WM, covariance);               // a known start
//   localization.add_odometry(0, time, forward, turn);              // for each reading
//   localization.add_sighting(0, time, target, range, bearing);
//   localization.predict(0, time).estimate.X_WM
//
// Readings are applied in the order of their times. Those that arrive within the window give bitwise identical results
// in any order of arrival, if odometry has no gaps above a minute.

#include <cstdint>
#include <vector>

#include "robots/estimation/measurement_window.h"
#include "robots/estimation/team_state.h"
#include "robots/estimation/track_filter.h"

namespace sf::estimation {

/// Not thread-safe.
class TeamLocalization {
 public:
  explicit TeamLocalization(Team team);

  // Each call adds one reading taken at `time` [ns] in [0, 2^61], at most `kWindow` before the newest. Readings that
  // are not finite, or of no robot, are `invalid`; those of a robot without a pose `no_track`.

  /// Starts or restarts a robot. @param covariance positive definite
  Verdict add_pose(std::uint32_t robot, std::int64_t time, const base::Pose& X_WM, const PoseCovariance& covariance);
  /// @param forward [m/s] @param turn [rad/s]
  Verdict add_odometry(std::uint32_t robot, std::int64_t time, double forward, double turn);
  /// @param target a robot, or number of robots + k for landmark k @param range [m] > 0 @param bearing [rad]
  Verdict add_sighting(std::uint32_t robot, std::int64_t time, std::uint32_t target, double range, double bearing);

  static constexpr std::int64_t kWindow = 1'000'000'000;  ///< [ns]

  /// Returns the estimate of a robot at `time`; its age is the time since the team's last event. Status `none` before
  /// the robot's start. Never stale.
  Prediction predict(std::uint32_t robot, std::int64_t time) const;

  const Team& team() const { return team_; }
  /// Number of poses and sightings by verdict.
  const VerdictCounts& counts() const { return counts_; }
  /// Returns the sum of the normalised squared innovations of the used sightings, each with two degrees of freedom.
  double squared_innovations() const { return squared_; }

 private:
  /// The motion from a state to the newest speeds, so that frequent predictions do not repeat it.
  struct Ahead {
    std::int64_t from = -1;  ///< [ns] time of the robot in the state; -1: none
    std::int64_t time = 0;   ///< [ns]
    TeamMotion motion;
  };

  Verdict take(const TeamEvent& event);
  void step_to(std::uint32_t robot, std::int64_t time);
  void forget(std::uint32_t robot, std::int64_t newest);
  auto apply_to_state();

  Team team_;
  std::vector<std::vector<Speeds>> speeds_;  ///< by robot, sorted
  std::vector<std::size_t> most_speeds_;     ///< by robot: old ones are dropped at this number
  std::vector<std::int64_t> next_step_;      ///< [ns] by robot; -1: not started
  MeasurementWindow<TeamEvent, TeamState> window_;
  VerdictCounts counts_{};
  double last_squared_ = 0.0, squared_ = 0.0;
  mutable std::vector<Ahead> ahead_;
};

}  // namespace sf::estimation
