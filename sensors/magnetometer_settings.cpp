#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/elements.h"
#include "sensors/magnetometer.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kMostGauss = 1e9;
constexpr double kSensitivity = 214748.3647;  // [Gauss] range of a 32-bit word in 1e-4 Gauss

}  // namespace

Magnetometer read_magnetometer(const world::Sensor& sensor) {
  Magnetometer m;
  m.X_SE = read_elements(sensor, kMostElements);
  const auto limits = tuple(sensor, "ssensitivity", 2, "[min max] in Gauss");
  const double least = limits ? (*limits)[0] : -kSensitivity;
  const double most = limits ? (*limits)[1] : kSensitivity;
  if (!(least < most) || std::max(-least, most) > kMostGauss)
    refuse(
        sensor, "ssensitivity",
        fmt::format("'ssensitivity' is [{:g} {:g}]; expected [min max] in Gauss with min below max, both within {:g}",
                    least, most, kMostGauss));
  m.least = kGauss * least;
  m.most = kGauss * most;
  constexpr std::string_view kSums[] = {"vector", "magnitude"};
  m.magnitudes = choice(sensor, "sum", 0, kSums) == 1;
  m.sigma = kGauss * number(sensor, "noise", 0.0, 0.0, kMostGauss);
  return m;
}

}  // namespace sf::sensors
