#include "scenarios/track_errors.h"

#include <cmath>

#include "base/elementary.h"
#include "sensors/tracks.h"

namespace sf::scenarios {

void TrackErrors::add(TrackRow row, const base::Report& truth) {
  const double* const c = row.data() + sensors::kTrackCovarianceAt;
  const double ex = row[0] - truth.X_WM.x, ey = row[1] - truth.X_WM.y;
  const glm::dvec2 v = base::rotate(truth.X_WM.yaw, {truth.velocity.forward, truth.velocity.left});
  ++found;
  position_squares += ex * ex + ey * ey;
  velocity_squares += (row[2] - v.x) * (row[2] - v.x) + (row[3] - v.y) * (row[3] - v.y);
  nees += position_nees(ex, ey, c[0], c[1], c[4]);
}

void TrackErrors::add(const TrackErrors& other) {
  found += other.found, position_squares += other.position_squares;
  velocity_squares += other.velocity_squares, nees += other.nees;
}

double position_nees(double ex, double ey, double xx, double xy, double yy) {
  return (yy * ex * ex - 2.0 * xy * ex * ey + xx * ey * ey) / (xx * yy - xy * xy) / 2.0;
}

double share_of(double part, std::uint64_t whole) { return whole == 0 ? NAN : part / static_cast<double>(whole); }
double rms_of(double squares, std::uint64_t count) { return std::sqrt(share_of(squares, count)); }

std::vector<TrackRow> object_rows(const base::ReadingBlock& reading) {
  std::vector<TrackRow> rows;
  for (std::size_t at = 0; at < reading.values.size(); at += sensors::kTrackNumbers) {
    const TrackRow row = reading.values.subspan(at, sensors::kTrackNumbers);
    if (row[sensors::kTrackValidAt] != 0.0 && row[sensors::kTrackKindAt] != 3.0) rows.push_back(row);
  }
  return rows;
}

double distance_to(TrackRow row, const base::Pose& X) { return base::hypot(row[0] - X.x, row[1] - X.y); }

std::size_t nearest_row(std::span<const TrackRow> rows, const std::vector<bool>& used, const base::Pose& X,
                        double most) {
  std::size_t nearest = rows.size();
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (const double away = distance_to(rows[k], X); !used[k] && away < most) nearest = k, most = away;
  return nearest;
}

}  // namespace sf::scenarios
