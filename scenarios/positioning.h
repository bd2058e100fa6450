#pragma once
// Simulates a positioning system (overhead cameras): measured poses of a robot that localizes itself, late or lost.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "control/controller.h"
#include "netio/link_model.h"

namespace sf::scenarios {

struct PositioningOptions {
  bool known_start = true;      ///< false: robots rest until they receive their first pose
  double rate = 10.0;           ///< [Hz] > 0, at most one pose per tick
  netio::LinkModel link;        ///< of every pose; delay and jitter sum to at most `Positioning::kLatest`
  double position_sigma = 0.0;  ///< [m] noise along x and y
  double yaw_sigma = 0.0;       ///< [rad] noise
  // Standard deviations that the poses state. 0: those of the noise, at least 1 mm and 1 mrad.
  double stated_position_sigma = 0.0;  ///< [m]
  double stated_yaw_sigma = 0.0;       ///< [rad]
  struct Outage {
    double begin = 0.0, end = 0.0;  ///< [s] no pose is measured in [begin, end)
  };
  std::vector<Outage> outages;
};

/// The poses of one robot.
class Positioning {
 public:
  static constexpr double kLatest = 1.0;  ///< [s] age up to which a robot's filter uses poses

  /// @param robot id in packets; selects the robot's random numbers under the link's seed
  /// @throws base::InputError if poses may arrive too late to be used
  Positioning(const PositioningOptions& options, std::uint32_t robot);

  /// Measures the true pose at `time` [ns] if due. Called at each tick.
  void measure(std::int64_t time, const base::Pose& X_WM);

  /// Returns the poses that arrived since the last call, in order of arrival. Valid until the next call.
  std::span<const control::MeasuredPose> receive(std::int64_t now);

 private:
  struct Message {
    std::int64_t arrival = 0;  ///< [ns]
    control::MeasuredPose pose;
  };

  PositioningOptions options_;
  std::uint32_t robot_;
  std::array<double, 6> covariance_{};
  std::uint64_t measured_ = 0;
  std::vector<Message> coming_;
  std::vector<control::MeasuredPose> arrived_;
};

}  // namespace sf::scenarios
