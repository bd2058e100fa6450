#pragma once
// Rows of `tracks` against the truth, for experiments.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "base/report.h"

namespace sf::scenarios {

using TrackRow = std::span<const double>;

/// Sums over the robots that have a track. Trivially copyable.
struct TrackErrors {
  std::uint64_t found = 0;
  double position_squares = 0.0, velocity_squares = 0.0;  ///< [m^2], [m^2/s^2]
  double nees = 0.0;                                      ///< position error over its covariance

  void add(TrackRow row, const base::Report& truth);
  void add(const TrackErrors& other);
};

/// Returns the square of a position error [m] over its covariance [m^2], divided by the 2 dimensions.
double position_nees(double ex, double ey, double xx, double xy, double yy);

/// Returns part / whole; NaN of nothing.
double share_of(double part, std::uint64_t whole);
/// Returns the root mean square; NaN of nothing.
double rms_of(double squares, std::uint64_t count);

/// Returns the rows of a reading that are valid tracks of objects.
std::vector<TrackRow> object_rows(const base::ReadingBlock& reading);
/// Returns the planar distance [m] of a track from a pose.
double distance_to(TrackRow row, const base::Pose& X);
/// Returns the nearest row that is not used and nearer than `most` [m]; rows.size() if there is none.
std::size_t nearest_row(std::span<const TrackRow> rows, const std::vector<bool>& used, const base::Pose& X,
                        double most);

}  // namespace sf::scenarios
