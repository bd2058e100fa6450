#include "control/clearance_estimator.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/laser.h"

namespace sf::control {

namespace {

constexpr std::uint32_t kBeams = 512;     // maximum number of beams used per laser
constexpr double kFarthestBearing = 1.8;  // [rad] beams farther from straight ahead are not used

}  // namespace

struct ClearanceEstimator::Sum {
  double ahead = HUGE_VAL;
  double left = 0.0, right = 0.0;
  double lefts = 0.0, rights = 0.0;
};

ClearanceEstimator::ClearanceEstimator(const world::Mover& mover, std::span<const sensors::SensorSpec> lasers) {
  double half_width = 0.0;
  for (const world::Segment& s : mover.body) {
    front_ = std::max({front_, s.a.x, s.b.x});
    half_width = std::max({half_width, std::abs(s.a.y), std::abs(s.b.y)});
  }
  half_width_ = 1.15 * half_width + 0.01;

  for (const sensors::SensorSpec& laser : lasers) {
    View view{{laser.X_MS.x, laser.X_MS.y}, laser.limit, static_cast<std::uint32_t>(beams_.size()), 0};
    const std::uint32_t stride = (laser.elements + kBeams - 1) / kBeams;
    for (std::uint32_t i = 0; i < laser.elements; i += stride) {
      const double along = laser.elements > 1 ? static_cast<double>(i) / (laser.elements - 1) - 0.5 : 0.0;
      const double bearing = base::wrap_angle(laser.X_MS.yaw + along * laser.fov);
      if (std::abs(bearing) > kFarthestBearing) continue;
      beams_.push_back({i, static_cast<float>(base::cos(bearing)), static_cast<float>(base::sin(bearing))});
      if (std::abs(bearing) < 0.6) range_ = std::max(range_, laser.X_MS.x + laser.limit - front_);
    }
    view.end = static_cast<std::uint32_t>(beams_.size());
    views_.push_back(view);
  }
  if (!std::isfinite(range_)) range_ = 1e3;
}

void ClearanceEstimator::add(const View& view, std::span<const double> ranges, Sum& sum) const {
  for (const Beam& beam : std::span(beams_).subspan(view.first, view.end - view.first)) {
    if (beam.sample >= ranges.size() || std::isnan(ranges[beam.sample])) continue;
    const double range = std::max(ranges[beam.sample], 0.0);

    // A hit is an obstacle if it lies in the lane that the body sweeps.
    if (range < view.range_max) {
      const double x = view.p_MS.x + range * beam.x;
      const double y = view.p_MS.y + range * beam.y;
      if (x >= 0.0 && std::abs(y) < half_width_) sum.ahead = std::min(sum.ahead, x - front_);
    }
    const double free = std::min({range, view.range_max, range_});
    if (beam.y > 0.05f) {
      sum.left += free;
      sum.lefts += 1.0;
    } else if (beam.y < -0.05f) {
      sum.right += free;
      sum.rights += 1.0;
    }
  }
}

Clearance ClearanceEstimator::estimate(std::span<const base::ReadingBlock> readings) const {
  Sum sum;
  for (const base::ReadingBlock& block : readings) {
    if (block.type == sensors::kLaser && block.sensor < views_.size()) add(views_[block.sensor], block.values, sum);
  }
  const double left = sum.lefts > 0.0 ? sum.left / sum.lefts : 0.0;
  const double right = sum.rights > 0.0 ? sum.right / sum.rights : 0.0;
  const bool both = sum.lefts > 0.0 && sum.rights > 0.0;
  const double ahead =
      sum.ahead == HUGE_VAL ? std::max(range_, 0.0) : std::clamp(sum.ahead, 0.0, std::max(range_, 0.0));
  return {ahead, both ? left : 0.0, both ? right : 0.0};
}

}  // namespace sf::control
