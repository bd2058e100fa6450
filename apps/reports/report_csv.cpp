// Formats one reading as text or CSV.

#include <fmt/format.h>

#include <cmath>

#include "apps/reports/csv_text.h"
#include "apps/reports/report.h"
#include "apps/reports/spatial_pose.h"
#include "base/elementary.h"
#include "base/number_name.h"
#include "base/tilted_pose.h"
#include "sensors/laser_modes.h"

namespace sf::apps {

namespace {

std::string missing_or(double value, const sensors::Column& column) {
  if (std::isnan(value)) return "";
  return column.whole || column.decimals > 0 ? fmt::format("{:.{}f}", value, column.decimals)
                                             : fmt::format("{}", value);
}

/// `distance_m,points`; a vector has the columns `vector_T_x,vector_T_y,vector_T_z`. Scans also have bearings and
/// models.
/// @param width of the sensor's columns
std::string csv_heading(const sensors::SensorType& type, std::size_t width) {
  std::string text = type.is_scan ? "bearing_rad" : type.beams != nullptr ? "azimuth_rad,elevation_rad" : "";
  for (const sensors::Column& column : type.columns)
    for (std::uint32_t k = 0; k < column.width && width > 0; ++k, --width) {
      if (!text.empty()) text += ',';
      text += base::number_name(column, k);
    }
  return text + (type.is_scan || type.beams != nullptr ? ",hit\n" : "\n");
}

/// Returns the bearing of a beam, or its azimuth and elevation; empty for other elements.
std::string direction_csv(const sensors::SensorSet& sensor_set, const base::ReadingBlock& reading, std::uint32_t i) {
  const sensors::SensorType& type = *sensors::find_sensor_type(reading.type);
  if (type.is_scan) return fmt::format("{:.12f}", bearing_of(sensor_set.row(reading), i));
  if (type.beams == nullptr) return "";
  const auto [azimuth, elevation] = sensors::angles_of(sensor_set.beams(reading).directions[i]);
  return fmt::format("{:.12f},{:.12f}", azimuth, elevation);
}

}  // namespace

std::string hit_name(const world::World& world, std::uint32_t hit) {
  if (hit == base::kNoHit) return "";
  return hit == base::kFloorHit ? "floor" : world.models[hit].name;
}

std::string csv_number(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::optional<base::RigidTransform> spatial_pose(const sensors::SensorSet& sensor_set,
                                                 const base::ReadingBlock& reading) {
  const sensors::SensorType& type = *sensors::find_sensor_type(reading.type);
  if (type.beams == nullptr && !type.is_scan) return std::nullopt;
  const auto X_WS =
      base::compose(base::transform_of(reading.X_WM, reading.tilt),
                    type.is_scan ? sensors::laser_mount(sensor_set, reading) : sensor_set.beams(reading).X_MS);
  if (type.is_scan && X_WS.R[2].z == 1.0) return std::nullopt;
  return X_WS;
}

std::string place_of(const world::World& world, const sensors::SensorSet& sensor_set,
                     const base::ReadingBlock& reading) {
  const world::Mover& mover = world.movers[reading.mover];
  const base::Pose& R = reading.X_WM;
  const base::Pose& S = reading.X_WS;
  constexpr double kDegrees = 180.0 / M_PI;
  const auto spatial = [](const base::TiltedPose& pose) {
    return fmt::format("at ({:.6f}, {:.6f}, {:.6f}) m, roll {:.6f}, pitch {:.6f}, yaw {:.6f} deg", pose.X.x, pose.X.y,
                       pose.X.z, kDegrees * pose.tilt.roll, kDegrees * pose.tilt.pitch,
                       kDegrees * base::wrap_angle(pose.X.yaw));
  };
  const auto X_WS = spatial_pose(sensor_set, reading);
  if (R.z != 0.0 || !base::is_level(reading.tilt))
    return fmt::format("{} {}; its {} {}", mover.name, spatial({R, reading.tilt}), sensor_set.row(reading).name,
                       spatial(X_WS ? base::tilted_pose_of(*X_WS) : base::TiltedPose{S, {}}));
  return fmt::format("{} at ({:.6f}, {:.6f}) m, {:.6f} deg; its {} at ({:.6f}, {:.6f}, {:.6f}) m, {:.6f} deg",
                     mover.name, R.x, R.y, kDegrees * base::wrap_angle(R.yaw), sensor_set.row(reading).name, S.x, S.y,
                     S.z, kDegrees * base::wrap_angle(S.yaw));
}

std::string reading_csv(const world::World& world, const sensors::SensorSet& sensor_set,
                        const base::ReadingBlock& reading) {
  const sensors::SensorType& type = *sensors::find_sensor_type(reading.type);
  const std::size_t width = element_width(type, sensor_set.row(reading));
  std::string text = csv_heading(type, width);
  const bool directed = type.is_scan || type.beams != nullptr;
  for (std::uint32_t i = 0; (i + 1) * width <= reading.values.size(); ++i) {
    std::string line = direction_csv(sensor_set, reading, i);
    std::size_t at = i * width;
    for (const sensors::Column& column : type.columns)
      for (std::uint32_t k = 0; k < column.width && at < (i + 1) * width; ++k, ++at)
        line += (directed || at > i * width ? "," : "") + missing_or(reading.values[at], column);
    if (directed) line += "," + csv_field(hit_name(world, reading.hits[i]));
    text += line + "\n";
  }
  return text;
}

}  // namespace sf::apps
