#include "bridges/player/devices.h"

#include <algorithm>

#include "sensors/bumper.h"
#include "sensors/fiducial.h"
#include "sensors/gps.h"
#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/occupancy.h"
#include "sensors/sonar.h"

namespace sf::bridges::player {

namespace {

/// The interfaces to the readings of a sensor type, in the order of their devices.
struct Offer {
  std::uint8_t type;
  std::vector<Interface> interfaces;
};
const std::vector<Offer>& own_interfaces() {
  static const std::vector<Offer> kOwn{{sensors::kLaser, {Interface::laser, Interface::ranger}},
                                       {sensors::kSonar, {Interface::sonar, Interface::ranger}},
                                       {sensors::kInfrared, {Interface::ir, Interface::ranger}},
                                       {sensors::kBumper, {Interface::bumper}},
                                       {sensors::kGps, {Interface::gps}},
                                       {sensors::kFiducial, {Interface::fiducial}}};
  return kOwn;
}

/// Types without an interface of their own are opaque, except maps, which do not fit a message.
std::vector<Offer> offers(const sensors::SensorSet& sensor_set) {
  std::vector<Offer> all = own_interfaces();
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    const auto same = [&](const Offer& offer) { return offer.type == group.type->id; };
    if (group.type->id != sensors::kOccupancy && std::none_of(all.begin(), all.end(), same))
      all.push_back({group.type->id, {Interface::opaque}});
  }
  return all;
}

constexpr std::uint32_t kMostIndex = 65'535;  // 16 bits in clients

}  // namespace

Devices::Devices(const world::World& world, const sensors::SensorSet& sensor_set)
    : world_(world), sensor_set_(sensor_set) {
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    first_slot_[group.type->id] = static_cast<std::uint32_t>(slots_);
    slots_ += group.rows.size();
  }
  rows_.push_back({.interf = Interface::simulation, .name = "sensorfarm"});
  rows_.push_back({.interf = Interface::map, .name = "walls"});
  const SensorGeometry geometry(world, sensor_set);
  for (std::uint32_t mover = 0; mover < world.movers.size(); ++mover)
    if (!world.movers[mover].is_tag || sensor_set.count_of(mover) > 0) add_robot(mover, geometry);
}

std::uint32_t Devices::slot_of(std::uint8_t type, std::uint32_t mover, std::uint32_t sensor) const {
  const auto first = first_slot_.find(type);
  if (first == first_slot_.end()) return world::kNone;
  return first->second + sensor_set_.group(type)->first[mover] + sensor;
}

void Devices::add_robot(std::uint32_t mover, const SensorGeometry& geometry) {
  const world::Mover& robot = world_.movers[mover];
  robots_.push_back(mover);
  rows_.push_back(
      {.interf = Interface::position2d, .name = robot.name, .mover = mover, .geometry = body_geometry(robot)});
  for (const auto& [type, interfaces] : offers(sensor_set_))
    for (const sensors::SensorSpec& spec : sensor_set_.of(type, mover)) {
      if (spec.elements > kMostElements) continue;
      const std::uint32_t slot = slot_of(type, mover, spec.sensor);
      for (const Interface interf : interfaces) {
        const std::size_t row = slot - first_slot_.at(type);
        rows_.push_back({interf, robot.name + "." + spec.name, mover, &spec, type, slot,
                         geometry.geometry(interf, type, spec, row), geometry.config(interf, type, spec, row)});
      }
    }
}

Listing::Listing(const Devices& devices, std::optional<std::uint32_t> mover) {
  std::map<Interface, std::uint32_t> next;
  for (std::uint32_t row = 0; row < devices.rows().size(); ++row) {
    const Device& device = devices.rows()[row];
    const bool here = !mover || device.mover == *mover || device.mover == world::kNone;
    if (here && next[device.interf] <= kMostIndex) rows_[{device.interf, next[device.interf]++}] = row;
  }
}

}  // namespace sf::bridges::player
