#include "sensors/derived/public_types.h"

#include <fmt/format.h>

namespace sf::sensors {

sensorfarm::SensorInfo public_info(const SensorType& type, const SensorSpec& spec) {
  sensorfarm::SensorInfo info{std::string(type.name),
                              spec.sensor,
                              spec.name,
                              public_pose(spec.X_MS),
                              spec.rate,
                              spec.elements,
                              {},
                              spec.limit,
                              {}};
  const std::size_t width = element_width(type, spec);
  for (const Column& column : type.columns)
    for (std::uint32_t k = 0; k < column.width && info.columns.size() < width; ++k)
      info.columns.push_back(column.width == 1 ? std::string(column.name) : fmt::format("{}[{}]", column.name, k));
  for (std::uint32_t i = 0; type.is_scan && i < spec.elements; ++i) info.bearings.push_back(bearing_of(spec, i));
  return info;
}

sensorfarm::Reading public_reading(const base::ReadingBlock& reading, const SensorType& type) {
  return {type.name,
          reading.sensor,
          1e-9 * static_cast<double>(reading.time),
          public_pose(reading.X_WS),
          reading.values,
          reading.hits,
          reading.bound,
          reading.bound_without_noise,
          reading.sigma,
          {reinterpret_cast<const std::uint8_t*>(reading.quality.data()), reading.quality.size()}};
}

}  // namespace sf::sensors
