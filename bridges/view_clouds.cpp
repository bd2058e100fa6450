#include "bridges/view_clouds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/rigid_transform.h"
#include "record/cdr.h"
#include "record/fleet_message.h"
#include "record/ros_messages.h"
#include "sensors/laser_modes.h"
#include "sensors/lidar.h"

namespace sf::bridges {

namespace {

bool is_shown(const sensors::SensorType& type) { return type.id == sensors::kLidar || type.is_scan; }

std::size_t beam_count(const sensors::SensorSet& sensor_set) {
  std::size_t count = 0;
  for (const auto& group : sensor_set.groups())
    if (is_shown(*group.type))
      for (const sensors::SensorSpec& row : group.rows) count += row.elements;
  return count;
}

/// Beams are sent in steps of the golden section of their number, around and around, which visits each once: the first
/// ones of any number are spread evenly over the scan.
std::size_t step_of(std::size_t beams) {
  auto step = static_cast<std::size_t>(0.6180339887 * static_cast<double>(beams));
  while (std::gcd(step, beams) != 1) ++step;
  return step;
}

}  // namespace

glm::dvec3 view_origin(const world::World& world) {
  const world::Extent& e = world.extent;
  return {std::round(0.5 * (e.x_min + e.x_max)), std::round(0.5 * (e.y_min + e.y_max)), 0.0};
}

ViewClouds::ViewClouds(const Scene& scene) : sensor_set_(scene.sensor_set), origin_(view_origin(scene.world)) {
  stride_ = static_cast<std::uint32_t>(
      std::max<std::size_t>(1, (beam_count(sensor_set_) + kMostViewPoints - 1) / kMostViewPoints));
}

void ViewClouds::add(const base::TickRecord& tick) {
  if (tick.time < time_) clouds_.clear();
  time_ = tick.time;
  for (const base::ReadingBlock& reading : tick.readings) {
    const auto* const group = sensor_set_.group(reading.type);
    if (group != nullptr && is_shown(*group->type) && !base::is_absent(reading.X_WM)) add(reading);
  }
}

void ViewClouds::add(const base::ReadingBlock& reading) {
  if (reading.values.size() < sensor_set_.row(reading).elements) return;  // of another world
  const std::uint64_t key = std::uint64_t{reading.mover} << 32 | std::uint64_t{reading.type} << 24 | reading.sensor;
  Cloud& cloud = clouds_[key];
  cloud.mover = reading.mover, cloud.type = reading.type, cloud.sensor = reading.sensor;
  cloud.planar = sensor_set_.group(reading.type)->type->is_scan;
  cloud.is_new = true;
  cloud.points.clear();
  add_points(reading, cloud);
}

void ViewClouds::add_points(const base::ReadingBlock& reading, Cloud& cloud) const {
  const sensors::SensorSpec& spec = sensor_set_.row(reading);
  const sensors::SpatialBeams spatial = cloud.planar
                                            ? sensors::SpatialBeams{sensors::laser_mount(sensor_set_, reading), {}, {}}
                                            : sensor_set_.beams(reading);
  base::RigidTransform X = base::compose(base::transform_of(reading.X_WM, reading.tilt), spatial.X_MS);
  X.p -= origin_;
  cloud.position = X.p;
  const std::size_t beams = spec.elements, width = reading.values.size() / beams, step = step_of(beams);
  std::size_t i = 0;
  for (std::size_t left = (beams + stride_ - 1) / stride_; left > 0; --left, i = (i + step) % beams) {
    const double range = reading.values[i * width];
    const bool too_near = !reading.quality.empty() && reading.quality[i] == base::QualityFlag::too_near;
    if (too_near || base::echo_of(range, sensors::limits_of(spec)) != base::Echo::valid) continue;
    const glm::dvec3 direction =
        cloud.planar ? glm::dvec3(base::direction(sensors::bearing_of(spec, static_cast<std::uint32_t>(i))), 0.0)
                     : spatial.directions[i];
    const glm::dvec3 p = base::transform(X, range * direction);
    const double intensity = width > 1 ? reading.values[i * width + 1] : -1.0;
    for (const double value : {p.x, p.y, p.z, intensity}) cloud.points.push_back(static_cast<float>(value));
  }
}

void ViewClouds::encode(const base::TickRecord& tick, base::Bytes& out) {
  record::CdrWriter cdr(out);
  record::put_header(cdr, tick.time, "world");
  for (const double value : {origin_.x, origin_.y, origin_.z}) cdr.put(value);
  cdr.put(stride_);
  record::put_tilts(cdr, tick);
  cdr.put_count(
      static_cast<std::size_t>(std::ranges::count_if(clouds_, [](const auto& each) { return each.second.is_new; })));
  for (auto& [key, cloud] : clouds_) {
    if (!cloud.is_new) continue;
    cloud.is_new = false;
    cdr.put(cloud.mover);
    cdr.put(cloud.type);
    cdr.put(cloud.sensor);
    cdr.put(cloud.planar);
    for (const double value : {cloud.position.x, cloud.position.y, cloud.position.z})
      cdr.put(static_cast<float>(value));
    cdr.put_count(cloud.points.size());
    base::ByteWriter(out).put_bytes(cloud.points.data(), cloud.points.size() * sizeof(float));
  }
}

}  // namespace sf::bridges
