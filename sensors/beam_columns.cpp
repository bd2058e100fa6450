#include "sensors/beam_columns.h"

#include <algorithm>
#include <cmath>

#include "base/echo.h"
#include "base/elementary.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

/// [rad] Returns the bearings of the ends of a camera's middle row and column, in the robot's frame, relative to `yaw`.
std::pair<double, double> sight_of(const CameraSettings& s, double yaw) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (std::uint32_t i = 0; i < s.width * s.height; ++i) {
    if (i / s.width != s.height / 2 && i % s.width != s.width / 2) continue;
    const glm::dvec3 u = s.X_MS.R * s.beams->directions[i];
    const double bearing = base::wrap_angle(base::atan2(u.y, u.x) - yaw);
    least = std::min(least, bearing), most = std::max(most, bearing);
  }
  return {least, most};
}

}  // namespace

BeamColumns::BeamColumns(const LidarSettings& lidar)
    : X_MS_(planar_mount(lidar.X_MS)), limits_{lidar.echo.range_min, lidar.echo.range_max}, width_(lidar.echo.width) {
  const std::vector<glm::dvec3>& directions = lidar.beams->directions;
  const std::size_t count = directions.size() / lidar.beams->channels;
  const double first = base::atan2(directions[0].y, directions[0].x);
  const double step = count > 1 ? base::wrap_angle(base::atan2(directions[1].y, directions[1].x) - first) : 2.0 * M_PI;
  set_bearings(first, step, count);
  add_beams(lidar.X_MS.R, *lidar.beams, false);
}

BeamColumns::BeamColumns(const CameraSettings& camera)
    : X_MS_(planar_mount(camera.X_MS)),
      limits_{camera.range_min, camera.range_max},
      width_(camera.columns()),
      across_(camera.width),
      depth_noise_(camera.depth_noise) {
  const double step = 1.0 / std::min(camera.lens.focal.x, camera.lens.focal.y);
  const auto [first, last] = sight_of(camera, X_MS_.yaw);
  set_bearings(first, step, static_cast<std::size_t>((last - first) / step) + 1);
  add_beams(camera.X_MS.R, *camera.beams, true);
}

void BeamColumns::set_bearings(double first, double step, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bearings_.push_back(first + static_cast<double>(i) * step);
  columns_.resize(count), ranges_.resize(count);
}

/// Beams are in the column of their bearing in the robot's frame, whose rings may be turned or tilted against each
/// other. @param depths readings are along the sensor's x axis, not along the beam
void BeamColumns::add_beams(const glm::dmat3& R_MS, const LidarBeams& beams, bool depths) {
  const auto round = static_cast<long>(std::lround(2.0 * M_PI / step()));
  for (std::uint32_t row = 0; row < beams.directions.size(); ++row) {
    const glm::dvec3& d = beams.directions[row];
    const glm::dvec3 u = R_MS * d / (depths ? d.x : 1.0);
    const double horizontal = base::hypot(u.x, u.y);
    if (!(horizontal > 1e-3)) continue;
    const double bearing = base::wrap_angle(base::atan2(u.y, u.x) - X_MS_.yaw - bearings_[0]);
    const long column = (std::lround(bearing / step()) % round + round) % round;
    if (column < static_cast<long>(columns_.size()))
      columns_[static_cast<std::size_t>(column)].push_back({row, horizontal, u.z});
  }
  for (std::vector<Beam>& column : columns_)
    std::ranges::stable_sort(column, {}, [](const Beam& beam) { return beam.vertical / beam.horizontal; });
}

std::span<const double> BeamColumns::ranges(const sensorfarm::Reading& reading) {
  take(reading);
  for (std::size_t i = 0; i < columns_.size(); ++i) ranges_[i] = obstacle(columns_[i]);
  if (depth_noise_ > 0.0) drop_narrow();
  return ranges_;
}

/// Drops obstacles in fewer columns than kLeastColumns.
void BeamColumns::drop_narrow() {
  for (std::size_t first = 0, next = 0; first < ranges_.size(); first = next) {
    for (next = first + 1;
         next < ranges_.size() && std::abs(ranges_[next] - ranges_[next - 1]) < kGroundStep + slack(ranges_[first]);)
      ++next;
    if (next - first < kLeastColumns)
      std::fill_n(ranges_.begin() + static_cast<std::ptrdiff_t>(first), next - first, NAN);
  }
}

void BeamColumns::take(const sensorfarm::Reading& reading) {
  values_.resize(reading.values.size() / width_);
  for (std::size_t k = 0; k < values_.size(); ++k) {
    const double range = reading.values[k * width_];
    const bool near =
        k < reading.flags.size() && reading.flags[k] == static_cast<std::uint8_t>(base::QualityFlag::too_near);
    values_[k] = !near && base::echo_of(range, limits_) == base::Echo::valid ? range : NAN;
  }
  if (depth_noise_ > 0.0) smooth_depths(across_, depth_noise_, values_, before_);
}

double BeamColumns::obstacle(std::span<const Beam> column) {
  double ground_at = 0.0, ground = 0.0, nearest = NAN;  // [m] from the sensor, above the robot's origin
  obstacles_.clear();
  for (const Beam& beam : column) {
    const double range = values_[beam.row];
    if (std::isnan(range)) continue;
    const double at = range * beam.horizontal, z = X_MS_.z + range * beam.vertical;
    const double rise = z - ground;
    if (rise <= kGroundStep + kGroundSlope * std::max(at - ground_at - slack(at), 0.0)) {
      if (at > ground_at && rise <= kWallSlope * (at - ground_at)) ground_at = at, ground = z;
    } else if (rise <= kTallest) {
      obstacles_.emplace_back(at, z);
      if (!(at >= nearest)) nearest = at;
    }
  }
  return depth_noise_ > 0.0 ? steep_obstacle() : nearest;
}

double BeamColumns::steep_obstacle() {
  std::ranges::sort(obstacles_, {}, [](const glm::dvec2& each) { return each.x; });
  for (auto first = obstacles_.begin(); first != obstacles_.end(); ++first) {
    const double within = kGroundStep + slack(first->x);
    double sum = 0.0, count = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
    for (auto each = first; each != obstacles_.end() && each->x <= first->x + within; ++each)
      sum += each->x, ++count, low = std::min(low, each->y), high = std::max(high, each->y);
    if (high - low > kGroundStep + kGroundSlope * within) return sum / count;
  }
  return NAN;
}

}  // namespace sf::sensors
