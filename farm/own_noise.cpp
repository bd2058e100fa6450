#include "farm/own_noise.h"

#include <cmath>

#include "sensors/altimeter.h"
#include "sensors/compass.h"
#include "sensors/gyro.h"
#include "sensors/imu.h"
#include "sensors/inclinometer.h"

namespace sf::farm {

double own_noise(const sensors::SensorSet::Group& group, const sensors::SensorSpec& row, std::uint32_t offset) {
  const auto index = static_cast<std::size_t>(&row - group.rows.data());
  const auto of_reading = [&](const sensors::TriadErrors& errors) { return errors.noise * std::sqrt(row.rate); };
  if (group.type->id == sensors::kGyro && offset == 0) return group.settings_as<sensors::Gyro>()[index].noise;
  if (group.type->id == sensors::kImu && offset < 6) {
    const sensors::Imu& imu = group.settings_as<sensors::Imu>()[index];
    return of_reading(offset < 3 ? imu.gyro : imu.accel);
  }
  if (group.type->id == sensors::kCompass && offset >= 1 && offset <= 3)
    return of_reading(group.settings_as<sensors::Compass>()[index].instrument.errors);
  if (group.type->id == sensors::kAltimeter)
    return of_reading(group.settings_as<sensors::Altimeter>()[index].instrument.errors);
  if (group.type->id == sensors::kInclinometer && offset < 2)
    return of_reading(group.settings_as<sensors::TriadInstrument>()[index].errors);
  return offset == 0 ? row.sigma : HUGE_VAL;
}

}  // namespace sf::farm
