#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/magnetometer.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kFarthest = 1e6;  // [m] of an element from its sensor
constexpr double kMostGauss = 1e9;
constexpr double kSensitivity = 214748.3647;  // [Gauss] what 32 bits of 1e-4 hold, both ways

Pose element_pose(const world::Sensor& sensor, const world::Setting& setting, bool has_height) {
  const std::size_t least = has_height ? 4 : 3;
  const auto p = *tuple(sensor, setting.key, least, has_height ? "[x y z yaw]" : "[x y yaw]");
  const double z = has_height ? sensor.metres * p[2] : 0.0;
  const Pose pose{sensor.metres * p[0], sensor.metres * p[1], z, sensor.radians * p[least - 1]};
  if (std::max({std::abs(pose.x), std::abs(pose.y), std::abs(pose.z)}) <= kFarthest) return pose;
  refuse(sensor, setting.key, fmt::format("'{}' is farther than {:g} m from its sensor", setting.key, kFarthest));
}

Pose element(const world::Sensor& sensor, std::uint32_t i, std::uint32_t count) {
  const world::Setting* flat = find(sensor, fmt::format("spose[{}]", i));
  const world::Setting* lifted = find(sensor, fmt::format("spose3[{}]", i));
  if (flat != nullptr && lifted != nullptr)
    refuse(sensor, lifted->key, fmt::format("element {0} has both spose[{0}] and spose3[{0}]; give one of them", i));
  if (flat != nullptr) return element_pose(sensor, *flat, false);
  if (lifted != nullptr) return element_pose(sensor, *lifted, true);
  refuse(sensor, "scount",
         fmt::format("'spose[{}]' is missing: 'scount {}' promises spose[0] to spose[{}], each once; number them, or "
                     "lower 'scount'",
                     i, count, count - 1));
}

/// Elements that are written but not counted.
void refuse_more(const world::Sensor& sensor, std::uint32_t count) {
  for (const world::Setting& setting : sensor.settings) {
    if (!setting.key.starts_with("spose") || setting.key.find('[') == std::string::npos) continue;
    const auto index = std::strtoull(setting.key.c_str() + setting.key.find('[') + 1, nullptr, 10);
    if (index >= count)
      refuse(sensor, setting.key,
             fmt::format("'{}' is beyond 'scount {}', which counts from 0; raise 'scount' (at most {}) or leave it out",
                         setting.key, count, kMostElements));
  }
}

std::vector<Pose> elements(const world::Sensor& sensor) {
  const std::uint32_t count = whole(sensor, "scount", 1, 1, kMostElements);
  refuse_more(sensor, count);
  const bool plain =
      find(sensor, "scount") == nullptr && find(sensor, "spose[0]") == nullptr && find(sensor, "spose3[0]") == nullptr;
  if (plain) return {Pose{}};
  std::vector<Pose> all;
  for (std::uint32_t i = 0; i < count; ++i) all.push_back(element(sensor, i, count));
  return all;
}

}  // namespace

Magnetometer read_magnetometer(const world::Sensor& sensor) {
  Magnetometer m;
  m.X_SE = elements(sensor);
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
