#include "sensors/lidar_columns.h"

#include <algorithm>
#include <cmath>

#include "base/echo.h"
#include "base/elementary.h"
#include "sensors/settings.h"

namespace sf::sensors {

LidarColumns::LidarColumns(const LidarSettings& lidar, std::size_t width)
    : X_MS_(planar_mount(lidar.X_MS)), limits_{lidar.echo.range_min, lidar.echo.range_max}, width_(width) {
  const std::vector<glm::dvec3>& directions = lidar.beams->directions;
  const std::size_t count = directions.size() / lidar.beams->channels;
  const double first = base::atan2(directions[0].y, directions[0].x);
  const double step = count > 1 ? base::wrap_angle(base::atan2(directions[1].y, directions[1].x) - first) : 2.0 * M_PI;
  for (std::size_t i = 0; i < count; ++i) bearings_.push_back(first + static_cast<double>(i) * step);
  columns_.resize(count), ranges_.resize(count);
  add_beams(lidar);
  for (std::vector<Beam>& column : columns_)
    std::ranges::stable_sort(column, {}, [](const Beam& beam) { return beam.vertical / beam.horizontal; });
}

/// Beams are in the column of their bearing in the robot's frame, whose rings may be turned or tilted against each
/// other.
void LidarColumns::add_beams(const LidarSettings& lidar) {
  const double step = bearings_.size() > 1 ? bearings_[1] - bearings_[0] : 2.0 * M_PI;
  const auto round = static_cast<long>(std::lround(2.0 * M_PI / step));
  for (std::uint32_t row = 0; row < lidar.beams->directions.size(); ++row) {
    const glm::dvec3 u = lidar.X_MS.R * lidar.beams->directions[row];
    const double horizontal = base::hypot(u.x, u.y);
    if (!(horizontal > 1e-3)) continue;
    const double bearing = base::wrap_angle(base::atan2(u.y, u.x) - X_MS_.yaw - bearings_[0]);
    const long column = (std::lround(bearing / step) % round + round) % round;
    if (column < static_cast<long>(columns_.size()))
      columns_[static_cast<std::size_t>(column)].push_back({row, horizontal, u.z});
  }
}

std::span<const double> LidarColumns::ranges(const sensorfarm::Reading& reading) {
  for (std::size_t i = 0; i < columns_.size(); ++i) ranges_[i] = obstacle(columns_[i], reading);
  return ranges_;
}

double LidarColumns::obstacle(std::span<const Beam> column, const sensorfarm::Reading& reading) const {
  double ground_at = 0.0, ground = 0.0, nearest = NAN;  // [m] from the sensor, above the robot's origin
  for (const Beam& beam : column) {
    const double range = reading.values[beam.row * width_];
    const bool near = beam.row < reading.flags.size() &&
                      reading.flags[beam.row] == static_cast<std::uint8_t>(base::QualityFlag::too_near);
    if (near || base::echo_of(range, limits_) != base::Echo::valid) continue;
    const double at = range * beam.horizontal, z = X_MS_.z + range * beam.vertical;
    const double rise = z - ground;
    if (rise <= kGroundStep + kGroundSlope * std::max(at - ground_at, 0.0)) {
      if (at > ground_at) ground_at = at, ground = z;
    } else if (rise <= kTallest && !(at >= nearest)) {
      nearest = at;
    }
  }
  return nearest;
}

}  // namespace sf::sensors
