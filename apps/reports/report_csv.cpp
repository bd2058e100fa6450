// Formats one reading as text or CSV.

#include <fmt/format.h>

#include <cmath>

#include "apps/reports/csv_text.h"
#include "apps/reports/report.h"

namespace sf::apps {

namespace {

std::string missing_or(double value, const sensors::Column& column) {
  if (std::isnan(value)) return "";
  return column.whole || column.decimals > 0 ? fmt::format("{:.{}f}", value, column.decimals)
                                             : fmt::format("{}", value);
}

/// `distance_m,points`; a vector has the columns `vector_T_x,vector_T_y,vector_T_z`. Scans also have bearings and
/// models.
std::string csv_heading(const sensors::SensorType& type) {
  std::string text = type.is_scan ? "bearing_rad" : "";
  for (const sensors::Column& column : type.columns)
    for (std::uint32_t k = 0; k < column.width; ++k) {
      if (!text.empty()) text += ',';
      text += column.name;
      if (column.width > 1) text += column.width <= 3 ? fmt::format("_{}", "xyz"[k]) : fmt::format("_{}", k);
    }
  return text + (type.is_scan ? ",hit\n" : "\n");
}

}  // namespace

std::string csv_number(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string place_of(const world::World& world, const sensors::SensorSet& sensor_set,
                     const base::ReadingBlock& reading) {
  const world::Mover& mover = world.movers[reading.mover];
  const base::Pose& R = reading.X_WM;
  const base::Pose& S = reading.X_WS;
  constexpr double kDegrees = 180.0 / M_PI;
  return fmt::format("{} at ({:.6f}, {:.6f}) m, {:.6f} deg; its {} at ({:.6f}, {:.6f}, {:.6f}) m, {:.6f} deg",
                     mover.name, R.x, R.y, kDegrees * base::wrap_angle(R.yaw), sensor_set.row(reading).name, S.x, S.y,
                     S.z, kDegrees * base::wrap_angle(S.yaw));
}

std::string reading_csv(const world::World& world, const sensors::SensorSet& sensor_set,
                        const base::ReadingBlock& reading) {
  const sensors::SensorType& type = *sensors::find_sensor_type(reading.type);
  std::string text = csv_heading(type);
  const std::size_t width = element_width(type);
  for (std::uint32_t i = 0; (i + 1) * width <= reading.values.size(); ++i) {
    std::string line = type.is_scan ? fmt::format("{:.12f}", bearing_of(sensor_set.row(reading), i)) : "";
    std::size_t at = i * width;
    for (const sensors::Column& column : type.columns)
      for (std::uint32_t k = 0; k < column.width; ++k, ++at)
        line += (type.is_scan || at > i * width ? "," : "") + missing_or(reading.values[at], column);
    if (type.is_scan)
      line += "," + (reading.hits[i] == base::kNoHit ? "" : csv_field(world.models[reading.hits[i]].name));
    text += line + "\n";
  }
  return text;
}

}  // namespace sf::apps
