#include "sensors/lightsensor.h"

#include <algorithm>
#include <cmath>

#include "base/box_tree.h"
#include "sensors/elements.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "world/wall_tree.h"

namespace sf::sensors {

namespace {

using world::Lamp;
using world::Segment;

base::BoxTree reaches_of(const world::World& world) {
  std::vector<base::Box> boxes;
  for (const Lamp& lamp : world.lamps) boxes.push_back(base::box_around({lamp.X_WL.x, lamp.X_WL.y}, range_of(lamp)));
  return base::BoxTree(boxes);
}

std::vector<Segment> opaque(const world::World& world) {
  std::vector<Segment> walls;
  if (world.lamps.empty()) return walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const Segment& wall) { return wall.seen_by_laser; });
  return walls;
}

/// Returns true when the straight line from `from` to `to` crosses the wall within its heights. A line along the wall
/// passes.
bool crosses(const glm::dvec3& from, const glm::dvec3& to, const Segment& wall) {
  const glm::dvec2 along = wall.b - wall.a, start{from.x, from.y}, end{to.x, to.y};
  const double turn = base::cross(end - start, along);
  if (turn == 0.0 || !world::segments_meet(start, end, wall.a, wall.b)) return false;
  const double part = std::clamp(base::cross(wall.a - start, along) / turn, 0.0, 1.0);
  const double height = from.z + part * (to.z - from.z);
  return wall.z_min <= height && height < wall.z_max;
}

class LightSensors : public HostBackend {
 public:
  LightSensors(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, lightsensor_type, sensors),
        settings_(sensors.settings_as<LightSensor>()),
        walls_(opaque(context.world)),
        reaches_(reaches_of(context.world)) {}

 private:
  void measure(std::span<const HostSample> samples) const override;
  double illuminance_at(const Pose& X_WE) const;

  const std::vector<LightSensor>& settings_;  ///< per row
  world::WallTree walls_;                     ///< those that lasers see
  base::BoxTree reaches_;                     ///< of the world's lamps
};

double LightSensors::illuminance_at(const Pose& X_WE) const {
  const glm::dvec3 p{X_WE.x, X_WE.y, X_WE.z};
  const glm::dvec2 normal = base::rotate(X_WE.yaw, {1.0, 0.0});
  double sum = world().ambient_light;
  reaches_.any(base::box_around({p.x, p.y}, 0.0), [&](std::uint32_t i) {
    const Lamp& lamp = world().lamps[i];
    const double light = illuminance_of(lamp, p, normal);
    const glm::dvec3 from{lamp.X_WL.x, lamp.X_WL.y, lamp.X_WL.z};
    const auto hides = [&](const Segment& wall) { return wall.model != lamp.model && crosses(from, p, wall); };
    if (light > 0.0 && !walls_.any(base::box_of({p.x, p.y}, {from.x, from.y}), hides)) sum += light;
    return false;
  });
  return sum;
}

void LightSensors::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const LightSensor& s = settings_[sample.row];
    for (std::size_t i = 0; i < s.X_SE.size(); ++i) {
      Pose X_WE = base::compose(sample.X_WS, s.X_SE[i]);
      X_WE.z = sample.X_WS.z + s.X_SE[i].z;
      const double light = illuminance_at(X_WE);
      sample.values[2 * i] = light;
      sample.values[2 * i + 1] = std::floor(s.dark * std::max(0.0, 1.0 - light / s.bright) + 0.5);
    }
  }
}

LightSensor read_light_sensor(const world::Sensor& sensor) {
  LightSensor s;
  s.X_SE = read_elements(sensor, kMostLightElements);
  s.dark = number(sensor, "dark", s.dark, 0.0, kMostLightValue);
  s.bright = number(sensor, "bright", s.bright, 1e-3, 1e9);
  return s;
}

ParsedSensors parse_light_sensors(const world::World& world) {
  std::vector<SensorSpec> rows;
  std::vector<LightSensor> settings;
  double reach = 0.0;
  for (const Lamp& lamp : world.lamps) reach = std::max(reach, range_of(lamp));
  for_each_sensor(world, lightsensor_type, [&](const MountedSensor& mounted) {
    settings.push_back(read_light_sensor(mounted.settings));
    SensorSpec& row = rows.emplace_back(mounted.row);
    row.X_MS.z += 0.5 * mounted.settings.height;
    row.elements = static_cast<std::uint32_t>(settings.back().X_SE.size());
    row.reach = reach;
  });
  return {std::move(rows), std::move(settings)};
}

constexpr std::string_view kKeys[] = {"scount", "spose[]", "spose3[]", "ssize", "dark", "bright"};
constexpr Column kColumns[] = {{"illuminance_lx"}, {"value", 1, true}};
constexpr PlainNumber kNumbers[] = {{1e-3, 0.0}, {1.0, 0.0, kMostLightValue}};
constexpr PlainForm kForm{kLightSensor, "lightsensor", kNumbers};

}  // namespace

double range_of(const Lamp& lamp) { return std::max(kNearestLamp, std::sqrt(lamp.intensity / kFaintest)); }

double illuminance_of(const Lamp& lamp, const glm::dvec3& p, glm::dvec2 normal) {
  const glm::dvec3 to{lamp.X_WL.x - p.x, lamp.X_WL.y - p.y, lamp.X_WL.z - p.z};
  const double distance = glm::length(to);
  if (distance > range_of(lamp)) return 0.0;
  const double bearing = base::wrap_angle(std::atan2(-to.y, -to.x) - lamp.X_WL.yaw);
  if (lamp.fov < 2.0 * M_PI && std::abs(bearing) > 0.5 * lamp.fov) return 0.0;
  const double cosine = distance > 0.0 ? (normal.x * to.x + normal.y * to.y) / distance : 1.0;
  const double far = std::max(distance, kNearestLamp);
  return std::max(0.0, cosine) * lamp.intensity / (far * far);
}

constinit const SensorType lightsensor_type = plain<kForm>({
    .word = {"lightsensor", kKeys},
    .base_port = 54000,
    .list = "elements",
    .columns = kColumns,
    .parse = parse_light_sensors,
    .make = make_backend<LightSensors>,
});

}  // namespace sf::sensors
