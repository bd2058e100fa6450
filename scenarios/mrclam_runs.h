#pragma once
// Localization on the measurements of an MRCLAM data set, compared with its truth.

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "record/mrclam.h"
#include "robots/estimation/team_localization.h"

namespace sf::scenarios {

/// Landmarks whose positions the robots are given. Third: of the landmarks sorted by subject the first, the fourth, the
/// seventh, ...; the others are ignored. None: all are mapped on the way.
enum class MrclamLandmarks : std::uint8_t { all, third, none };
inline constexpr std::string_view kMrclamLandmarks[] = {"all", "third", "none"};

/// An estimate at the time of an odometry reading, and the truth then.
struct MrclamSample {
  double time = 0.0;  ///< [s] since the first sample of all robots
  base::Pose truth;   ///< interpolated
  estimation::Estimate estimate;
  double nees = 0.0;  ///< squared error of x, y, yaw in units of its covariance, divided by 3
};

/// One robot's estimates by one method: one row of results.csv.
struct MrclamRow {
  int robot = 0;  ///< subject
  MrclamLandmarks landmarks = MrclamLandmarks::all;
  bool cooperative = false;  ///< robots measure each other and share one state
  bool smoother = false;     ///< else the causal filter
  double rms_m = 0.0, rms_deg = 0.0;
  double nees = 0.0;  ///< mean
  std::size_t samples = 0;
  std::vector<MrclamSample> kept;  ///< about one per second
};

/// Runs all combinations. Rows are sorted by landmarks, cooperation, method and robot.
/// @param progress receives the completed fraction; called by one thread at a time
/// @throws base::Interrupted if `stop` returns true
std::vector<MrclamRow> run_mrclam(const record::MrclamData& data, const estimation::TeamModel& model, unsigned threads,
                                  const std::function<bool()>& stop, const std::function<void(double)>& progress);

/// Returns the true pose at `time` [ns], with yaw interpolated the short way; nullopt outside of the truth.
std::optional<base::Pose> true_pose(const std::vector<record::MrclamTruth>& truth, std::int64_t time);

}  // namespace sf::scenarios
