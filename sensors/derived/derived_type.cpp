#include "sensors/derived/derived_type.h"

#include "sensors/host_backend.h"
#include "sensors/settings.h"

namespace sf::sensors {

ParsedSensors parse_derived(const world::World& world, const SensorType& type, std::uint32_t rows, double rate) {
  std::vector<SensorSpec> specs;
  for_each_sensor(world, type, [&](const MountedSensor& mounted) {
    SensorSpec& spec = specs.emplace_back(mounted.row);
    spec.rate = rate_of(mounted.settings, rate);
    spec.elements = rows;
    spec.sigma = HUGE_VAL;  // its inputs may be noisy
  });
  return {std::move(specs), {}};
}

ParsedSensors parse_derived_rows(const world::World& world, const SensorType& type, std::uint32_t rows,
                                 std::uint32_t most, double rate) {
  ParsedSensors parsed = parse_derived(world, type, rows, rate);
  std::size_t row = 0;
  for_each_sensor(world, type, [&](const MountedSensor& mounted) {
    parsed.rows[row++].elements = whole(mounted.settings, "most", rows, 1, most);
  });
  return parsed;
}

std::unique_ptr<SensorBackend> no_backend(const SensorContext&, const ParsedSensors&) { return nullptr; }

}  // namespace sf::sensors
