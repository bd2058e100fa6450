#include "sensors/lidar_layout.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "sensors/lidar_modes.h"

namespace sf::sensors {

namespace {

glm::dvec3 direction_of(double azimuth, double elevation) {
  const auto [sa, ca] = base::sin_cos(azimuth);
  const auto [se, ce] = base::sin_cos(elevation);
  return {ce * ca, ce * sa, se};
}

/// Azimuth of a column. A full turn begins behind the sensor and has no beam twice; narrower fields include both ends.
double azimuth_of(const LidarLayout& layout, std::uint32_t column) {
  const bool full = layout.fov >= 2.0 * M_PI;
  if (layout.columns == 1) return full ? -M_PI : 0.0;
  return layout.fov * (static_cast<double>(column) / (full ? layout.columns : layout.columns - 1) - 0.5);
}

/// Beams through two prisms that turn against each other, at rates of 7 294 and -4 664 turns per 1000 s and beam.
std::vector<glm::dvec3> rosette(const LidarLayout& layout) {
  std::vector<glm::dvec3> directions;
  for (std::uint32_t i = 0; i < layout.columns; ++i) {
    const auto [s1, c1] = base::sin_cos(7.294e-3 * i);
    const auto [s2, c2] = base::sin_cos(-4.664e-3 * i);
    directions.push_back(direction_of(0.25 * layout.fov * (c1 + c2), 0.25 * layout.fov * (s1 + s2)));
  }
  return directions;
}

std::vector<glm::dvec3> rings_of(const LidarLayout& layout) {
  std::vector<glm::dvec3> directions;
  for (std::size_t channel = 0; channel < layout.elevations.size(); ++channel)
    for (std::uint32_t column = 0; column < layout.columns; ++column)
      directions.push_back(
          direction_of(azimuth_of(layout, column) + layout.offsets[channel], layout.elevations[channel]));
  return directions;
}

std::vector<glm::dvec3> directions_of(const LidarLayout& layout) {
  if (layout.table == nullptr) return layout.rosette ? rosette(layout) : rings_of(layout);
  std::vector<glm::dvec3> directions;
  for (const world::BeamDirection& row : layout.table->rows)
    directions.push_back(direction_of(row.azimuth, row.elevation));
  return directions;
}

std::vector<std::uint32_t> cast_of(const LidarLayout& layout) {
  std::vector<std::uint32_t> cast;
  for (std::uint32_t i = 0; layout.skip > 1 && i < layout.beams(); ++i) {
    const std::uint32_t column = i % layout.columns;
    if (column % layout.skip == 0 || column + 1 == layout.columns) cast.push_back(i);
  }
  return cast;
}

std::vector<glm::dvec3> chosen(const std::vector<glm::dvec3>& all, const std::vector<std::uint32_t>& rows) {
  if (rows.empty()) return all;
  std::vector<glm::dvec3> some;
  for (const std::uint32_t row : rows) some.push_back(all[row]);
  return some;
}

/// Divides each beam's cone into parts with equal solid angles: pairs opposite each other, on a spiral like Vogel's
/// (1979), and in the middle the first of an odd number. Their mean is the beam.
std::vector<glm::dvec3> parts_of(const LidarBeams& beams, double divergence) {
  constexpr double kTurn = 0.5 * 2.399963229728653;  // half of the golden angle: pairs repeat after half a turn
  const std::uint32_t single = beams.parts % 2;
  std::vector<glm::dvec3> parts;
  for (const glm::dvec3& d : chosen(beams.directions, beams.cast)) {
    const glm::dvec3 aside =
        glm::normalize(glm::cross(std::abs(d.z) < 0.9 ? glm::dvec3{0, 0, 1} : glm::dvec3{1, 0, 0}, d));
    const glm::dvec3 up = glm::cross(d, aside);
    if (single != 0) parts.push_back(d);
    for (std::uint32_t pair = 0; pair < beams.parts / 2; ++pair) {
      const double radius = base::tan(0.5 * divergence) * std::sqrt((single + 2.0 * pair + 1.0) / beams.parts);
      const auto [s, c] = base::sin_cos(kTurn * pair);
      const glm::dvec3 off = radius * (c * aside + s * up);
      parts.push_back(glm::normalize(d + off)), parts.push_back(glm::normalize(d - off));
    }
  }
  return parts;
}

}  // namespace

std::vector<double> LidarLayout::description() const {
  std::vector<double> all{
      static_cast<double>(columns), fov,        rosette ? 1.0 : 0.0,        scan_time,
      static_cast<double>(skip),    divergence, static_cast<double>(parts), static_cast<double>(elevations.size())};
  all.insert(all.end(), elevations.begin(), elevations.end());
  all.insert(all.end(), offsets.begin(), offsets.end());
  if (table != nullptr)
    for (const world::BeamDirection& row : table->rows) all.insert(all.end(), {row.azimuth, row.elevation, row.time});
  return all;
}

std::vector<double> times_of(const LidarLayout& layout) {
  std::vector<double> times;
  if (layout.scan_time == 0.0) return times;
  for (std::size_t i = 0; i < layout.beams(); ++i) {
    const double from_end = static_cast<double>(layout.columns - 1 - i % layout.columns) / layout.columns;
    times.push_back(layout.table != nullptr ? layout.table->rows[i].time - layout.table->duration()
                                            : -layout.scan_time * from_end);
  }
  return times;
}

LidarBeams beams_of(const LidarLayout& layout) {
  LidarBeams beams;
  beams.directions = directions_of(layout);
  beams.times = times_of(layout);
  beams.channels = static_cast<std::uint32_t>(layout.elevations.size());
  beams.parts = layout.parts;
  beams.cast = cast_of(layout);
  if (beams.parts > 1)
    beams.part_directions = parts_of(beams, layout.divergence);
  else if (!beams.cast.empty())
    beams.part_directions = chosen(beams.directions, beams.cast);
  std::vector<double> part_times;
  const std::size_t cast = beams.cast_directions().size() / beams.parts;
  for (std::size_t i = 0; i < cast && !beams.times.empty(); ++i)
    part_times.insert(part_times.end(), beams.parts, beams.times[beams.cast.empty() ? i : beams.cast[i]]);
  const bool rings = layout.has_rings() && beams.parts == 1;
  beams.pattern = scene::make_pattern(beams.cast_directions(),
                                      rings ? static_cast<std::uint32_t>(cast / beams.channels) : 0, part_times);
  if (beams.cast.empty()) return beams;
  beams.between = interpolation_weights(beams);
  if (beams.parts > 1) return beams;
  beams.in_place = true;
  for (scene::BeamTile& tile : beams.pattern) {
    for (std::uint32_t& place : tile.place) place = beams.cast[place];
    tile.run = 1;
  }
  return beams;
}

}  // namespace sf::sensors
