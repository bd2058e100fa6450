// One reading for people and spreadsheets.

#include <fmt/format.h>

#include <cmath>

#include "apps/report.h"

namespace sf::apps {

namespace {

/// In quotes where a comma, a quote or a line end would be misread.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string missing_or(double value, bool whole) {
  if (std::isnan(value)) return "";
  return whole ? fmt::format("{:.0f}", value) : fmt::format("{}", value);
}

std::string beams_csv(const world::World& world, const base::ReadingBlock& reading) {
  const world::Laser& laser = world.movers[reading.mover].lasers[reading.sensor];
  std::string text = "bearing_rad,range_m,hit\n";
  for (std::uint32_t i = 0; i < reading.values.size(); ++i) {
    const std::uint32_t hit = reading.hits[i];
    text += fmt::format("{:.12f},{:.9f},{}\n", world::bearing_of(laser, i), reading.values[i],
                        hit == base::kNoHit ? "" : csv_field(world.models[hit].name));
  }
  return text;
}

/// `distance_m,points`; a vector's columns are `vector_T_x,vector_T_y,vector_T_z`.
std::string csv_heading(const sensors::SensorType& kind) {
  std::string text;
  for (const sensors::Column& column : kind.columns)
    for (std::uint32_t k = 0; k < column.width; ++k) {
      if (!text.empty()) text += ',';
      text += column.name;
      if (column.width > 1) text += column.width <= 3 ? fmt::format("_{}", "xyz"[k]) : fmt::format("_{}", k);
    }
  return text + "\n";
}

}  // namespace

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

std::string text_of(const world::World& world, const base::ReadingBlock& reading) {
  if (reading.kind == base::kLaser) return beams_csv(world, reading);
  const sensors::SensorType& kind = *sensors::find_sensor_type(reading.kind);
  std::string text = csv_heading(kind);
  const std::size_t width = element_width(kind);
  for (std::size_t first = 0; first + width <= reading.values.size(); first += width) {
    std::size_t at = first;
    for (const sensors::Column& column : kind.columns)
      for (std::uint32_t k = 0; k < column.width; ++k, ++at)
        text += (at == first ? "" : ",") + missing_or(reading.values[at], column.whole);
    text += "\n";
  }
  return text;
}

}  // namespace sf::apps
