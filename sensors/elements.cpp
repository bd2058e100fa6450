#include "sensors/elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kFarthest = 1e6;  // [m] largest distance of an element from its sensor

Pose element_pose(const world::Sensor& sensor, const world::Setting& setting, bool has_height) {
  const std::size_t least = has_height ? 4 : 3;
  const auto p = *tuple(sensor, setting.key, least, has_height ? "[x y z yaw]" : "[x y yaw]");
  const double z = has_height ? sensor.metres_per_unit * p[2] : 0.0;
  const Pose pose{sensor.metres_per_unit * p[0], sensor.metres_per_unit * p[1], z,
                  sensor.radians_per_unit * p[least - 1]};
  if (std::max({std::abs(pose.x), std::abs(pose.y), std::abs(pose.z)}) <= kFarthest) return pose;
  refuse(sensor, setting.key, fmt::format("'{}' is more than {:g} m from its sensor", setting.key, kFarthest));
}

Pose element(const world::Sensor& sensor, std::uint32_t i, std::uint32_t count) {
  const world::Setting* flat = find(sensor, fmt::format("spose[{}]", i));
  const world::Setting* lifted = find(sensor, fmt::format("spose3[{}]", i));
  if (flat != nullptr && lifted != nullptr)
    refuse(sensor, lifted->key, fmt::format("element {0} has both spose[{0}] and spose3[{0}]; give one of them", i));
  if (flat != nullptr) return element_pose(sensor, *flat, false);
  if (lifted != nullptr) return element_pose(sensor, *lifted, true);
  refuse(sensor, "scount",
         fmt::format("'spose[{}]' is missing: 'scount {}' requires spose[0] to spose[{}], each once; number them, or "
                     "lower 'scount'",
                     i, count, count - 1));
}

}  // namespace

std::vector<Pose> read_elements(const world::Sensor& sensor, std::uint32_t most) {
  const std::uint32_t count = whole(sensor, "scount", 1, 1, most);
  refuse_beyond(sensor, "spose", "scount", count, most);
  const bool plain =
      find(sensor, "scount") == nullptr && find(sensor, "spose[0]") == nullptr && find(sensor, "spose3[0]") == nullptr;
  if (plain) return {Pose{}};
  std::vector<Pose> all;
  for (std::uint32_t i = 0; i < count; ++i) all.push_back(element(sensor, i, count));
  return all;
}

}  // namespace sf::sensors
