#include "sensors/range_source.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/cones/rangers.h"
#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/pose_sensor.h"
#include "sensors/sonar.h"

namespace sf::sensors {

namespace {

ConeArray cone_array(const world::World& world, const RangeSensor& sensor) {
  const world::Sensor& settings =
      input_settings(world, {.mover = sensor.mover, .type = sensor.type, .sensor = sensor.sensor});
  return (sensor.type == kInfrared ? read_infrared : read_sonar)(settings, sensor.mover, sensor.sensor);
}

}  // namespace

RangeSource::RangeSource(const world::World& world, const RangeSensor& sensor) : sensor_(sensor) {
  if (sensor.type == kLaser) {
    const LaserSettings laser = lasers_of(world.movers[sensor.mover])[sensor.sensor];
    require_level(world, laser, "an occupancy map");
    limits_ = {laser.range_min, laser.range_max};
    constant_ = laser.noise.range_sigma, proportional_ = laser.noise.range_proportional;
    for (std::uint32_t i = 0; i < laser.samples; ++i)
      elements_.push_back({base::compose(laser.X_MS, {0.0, 0.0, 0.0, raycast::bearing_of(laser, i)}), 0.0});
    return;
  }
  const ConeArray array = cone_array(world, sensor);
  limits_ = {array.range_min, array.range_max};
  constant_ = array.sigma, proportional_ = array.proportional, turns_ = array.turns;
  if (sensor.type == kInfrared) width_ = kInfraredColumns;
  if (array.min_cosine > 0.0) seen_ = base::acos(array.min_cosine) / (0.5 * M_PI);
  for (const Pose& X_SC : array.X_SC) elements_.push_back({base::compose(array.row.X_MS, X_SC), 0.5 * array.fov});
}

double RangeSource::sigma_at(double range) const {
  return sensor_.type == kInfrared ? infrared_sigma(range, limits_, proportional_)
                                   : base::hypot(constant_, proportional_ * range);
}

std::span<const maps::RangeCone> RangeSource::cones(const base::ReadingBlock& reading, const base::Pose& X_WM) {
  cones_.clear();
  const std::uint64_t last = is_first_ ? reading.sequence : last_;
  is_first_ = false, last_ = reading.sequence;
  const std::size_t count = std::min(elements_.size(), reading.values.size() / width_);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double range = reading.values[i * width_];
    const bool near = i < reading.quality.size() && reading.quality[i] == base::QualityFlag::too_near;
    if (near || !(range >= limits_.min) || !has_fired(i, turns_, reading.sequence, last)) continue;
    const bool has_echo = range < limits_.max;
    const double told = std::min(range, limits_.max);
    cones_.push_back(
        {base::compose(X_WM, elements_[i].X_MC), elements_[i].half, told, has_echo, sigma_at(told), seen_});
  }
  return cones_;
}

void RangeSource::add_to(std::span<maps::LogOddsGrid* const> grids, std::span<const maps::RangeCone> cones,
                         maps::RangeEvidence& evidence) const {
  const std::size_t together = sensor_.type == kLaser ? std::max<std::size_t>(cones.size(), 1) : 1;
  for (std::size_t first = 0; first < cones.size(); first += together) {
    if (!grids.empty()) evidence.trace(grids[0]->geometry, cones.subspan(first, together));
    for (maps::LogOddsGrid* grid : grids) evidence.add_to(*grid);
  }
}

}  // namespace sf::sensors
