#include "sensors/irreceiver.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/box_tree.h"
#include "base/elementary.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "world/wall_tree.h"

namespace sf::sensors {

namespace {

using world::Emitter;
using world::Segment;

constexpr double kOverlap = 0.25;  // fraction of each buoy's beam that overlaps the other beam

/// Returns true when a bearing from the emitter is in a beam of width `fov` around `axis` [rad].
bool within(double bearing, double axis, double fov) { return std::abs(base::wrap_angle(bearing - axis)) <= 0.5 * fov; }

base::BoxTree reaches_of(const world::World& world) {
  std::vector<base::Box> boxes;
  for (const Emitter& e : world.emitters)
    boxes.push_back(base::box_around({e.X_WE.x, e.X_WE.y}, std::max(e.range, e.halo)));
  return base::BoxTree(boxes);
}

std::vector<Segment> opaque(const world::World& world) {
  std::vector<Segment> walls;
  for (const Segment& wall : world.walls)
    if (wall.seen_by_laser) walls.push_back(wall);
  return walls;
}

class IrReceivers : public HostBackend {
 public:
  IrReceivers(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, irreceiver_type, sensors),
        walls_(opaque(context.world)),
        reaches_(reaches_of(context.world)) {}

 private:
  void measure(std::span<const HostSample> samples) const override;
  bool hidden(const Emitter& emitter, glm::dvec2 p, double z) const;

  world::WallTree walls_;
  base::BoxTree reaches_;  ///< reaches of the world's emitters
};

ParsedSensors parse_ir_receivers(const world::World& world) {
  std::vector<SensorSpec> rows;
  double reach = 0.0;
  for (const Emitter& e : world.emitters) reach = std::max({reach, e.range, e.halo});
  for_each_sensor(world, irreceiver_type, [&](const MountedSensor& mounted) {
    rows.push_back(mounted.row);
    rows.back().X_MS.z += 0.5 * mounted.settings.height;
    rows.back().reach = reach;
  });
  return {std::move(rows), {}};
}

bool IrReceivers::hidden(const Emitter& emitter, glm::dvec2 p, double z) const {
  const glm::dvec2 e{emitter.X_WE.x, emitter.X_WE.y};
  return walls_.any(base::box_of(p, e), [&](const Segment& wall) {
    return wall.model != emitter.model && wall.z_min <= z && z < wall.z_max &&
           world::segments_meet(e, p, wall.a, wall.b);
  });
}

void IrReceivers::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const glm::dvec2 p{sample.X_WS.x, sample.X_WS.y};
    std::uint32_t walls = 0, docks = 0;
    reaches_.any(base::box_around(p, 0.0), [&](std::uint32_t i) {
      const Emitter& emitter = world().emitters[i];
      const std::uint32_t light = light_of(emitter, p);
      if (light != 0 && !hidden(emitter, p, sample.X_WS.z))
        (emitter.kind == Emitter::Kind::virtual_wall ? walls : docks) |= light;
      return false;
    });
    sample.values[0] = walls;
    sample.values[1] = docks == 0 ? kNoIrByte : kDockByte + docks;
  }
}

constexpr Column kColumns[] = {{"virtual_wall", 1, true}, {"ir_byte", 1, true}};
constexpr PlainNumber kNumbers[] = {{1.0, 0.0, 1.0}, {1.0, 0.0, 255.0}};
constexpr PlainForm kForm{kIrReceiver, "irreceiver", kNumbers};

}  // namespace

std::uint32_t light_of(const Emitter& emitter, glm::dvec2 p) {
  const glm::dvec2 from{p.x - emitter.X_WE.x, p.y - emitter.X_WE.y};
  const double distance = glm::length(from);
  const bool reached = distance <= emitter.range;
  const bool near = emitter.halo > 0.0 && distance <= emitter.halo;
  const double bearing = base::atan2(from.y, from.x) - emitter.X_WE.yaw;
  if (emitter.kind == Emitter::Kind::virtual_wall)
    return near || (reached && within(bearing, 0.0, emitter.fov)) ? 1 : 0;
  const double aside = 0.5 * (1.0 - kOverlap) * emitter.fov;
  std::uint32_t light = near ? kForceField : 0;
  if (reached && within(bearing, aside, emitter.fov)) light |= kRedBuoy;
  if (reached && within(bearing, -aside, emitter.fov)) light |= kGreenBuoy;
  return light;
}

constinit const SensorType irreceiver_type = plain<kForm>({
    .word = {"irreceiver", {}},
    .base_port = 50000,
    .list = "",
    .columns = kColumns,
    .parse = parse_ir_receivers,
    .make = make_backend<IrReceivers>,
});

}  // namespace sf::sensors
