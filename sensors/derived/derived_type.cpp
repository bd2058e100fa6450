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

std::unique_ptr<SensorBackend> no_backend(const SensorContext&, const ParsedSensors&) { return nullptr; }

}  // namespace sf::sensors
