#include "control/sonars.h"

#include "sensors/sensor_set.h"
#include "sensors/sonar.h"

namespace sf::control {

Sonars::Sonars(const ControllerContext& context) {
  std::optional<sensors::SensorSet> made;
  const auto sonars = context.sensors_or(made).settings_of<sensors::ConeArray>(sensors::kSonar, context.mover);
  all_.assign(sonars.begin(), sonars.end());
}

std::optional<Sonars::Source> Sonars::source_of(const base::ReadingBlock& reading) const {
  if (reading.type != sensors::kSonar || all_.empty()) return std::nullopt;
  if (reading.sensor < all_.size()) return Source{all_[reading.sensor], reading.X_WS};
  return Source{all_[0], base::compose(reading.X_WM, all_[0].row.X_MS)};
}

}  // namespace sf::control
