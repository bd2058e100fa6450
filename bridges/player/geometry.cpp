#include "bridges/player/geometry.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "base/elementary.h"
#include "base/report.h"
#include "sensors/bumper.h"
#include "sensors/infrared.h"
#include "sensors/sonar.h"

namespace sf::bridges::player {

namespace {

/// player_bbox3d: width, length, height [m].
void put_size(double width, double length, double height, XdrWriter& xdr) { xdr.put_all({width, length, height}); }

base::Bytes scanner_geometry(const sensors::SensorSpec& spec) {
  base::Bytes out;
  XdrWriter xdr(out);
  put_pose(spec.X_MS, xdr);
  put_size(0.0, 0.0, 0.0, xdr);
  return out;
}

/// A laser is one element with all its beams; an array has one element per transducer.
base::Bytes ranger_geometry(const sensors::SensorSpec& spec, std::span<const base::Pose> elements) {
  base::Bytes out = scanner_geometry(spec);
  XdrWriter xdr(out);
  xdr.put_count(elements.size());
  for (const base::Pose& element : elements) put_pose(element, xdr);
  xdr.put_count(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) put_size(0.0, 0.0, 0.0, xdr);
  return out;
}

base::Bytes array_geometry(const sensors::ConeArray& array) {
  base::Bytes out;
  XdrWriter xdr(out);
  xdr.put_count(array.X_SC.size());
  for (const base::Pose& X_SC : array.X_SC) put_pose(base::compose(array.row.X_MS, X_SC), xdr);
  return out;
}

/// Each switch is the arc of its sectors on the circle around the parts of the body that collide.
base::Bytes bumper_geometry(const std::vector<std::uint32_t>& switches, const world::Mover& mover) {
  double radius = 0.0;
  for (const world::Segment& side : mover.body)
    if (side.stops_robots) radius = std::max({radius, glm::length(side.a), glm::length(side.b)});
  constexpr double kSector = 2.0 * M_PI / base::kContactSectors;
  base::Bytes out;
  XdrWriter xdr(out);
  xdr.put_count(switches.size());
  for (const std::uint32_t sectors : switches) {
    const int count = std::popcount(sectors);
    const std::uint32_t starts = sectors & ~std::rotl(sectors, 1);
    const double middle = base::wrap_angle(kSector * (std::countr_zero(starts) % 32 + 0.5 * count));
    put_pose({radius * base::cos(middle), radius * base::sin(middle), 0.0, middle}, xdr);
    xdr.put_all({static_cast<float>(kSector * count * radius), static_cast<float>(radius)});
  }
  return out;
}

bool is_array(std::uint8_t type) { return type == sensors::kSonar || type == sensors::kInfrared; }

double resolution_of(const sensors::SensorSpec& laser) {
  return laser.elements > 1 ? laser.fov / (laser.elements - 1) : 0.0;
}

/// Ranges are not quantised, so the resolution is 0.
base::Bytes laser_config(const sensors::SensorSpec& laser) {
  base::Bytes out;
  XdrWriter xdr(out);
  for (const double value : {sensors::bearing_of(laser, 0), sensors::bearing_of(laser, laser.elements - 1),
                             resolution_of(laser), laser.limit, 0.0})
    xdr.put(static_cast<float>(value));
  xdr.put(0u);  // no intensities
  xdr.put(static_cast<float>(laser.rate));
  return out;
}

/// Clients compute the bearing of range i of an element as its minimum angle plus i times the resolution. An element
/// with one range has 0 for both.
/// @param resolution [rad] of arrays: the aperture of a cone
base::Bytes ranger_config(const sensors::SensorSpec& spec, double least, double most, double resolution) {
  base::Bytes out;
  XdrWriter xdr(out);
  xdr.put_all({least, most, resolution, spec.range_min, spec.limit, 0.0, spec.rate});
  return out;
}

}  // namespace

void put_pose(const base::Pose& pose, XdrWriter& xdr) { xdr.put_all({pose.x, pose.y, pose.z, 0.0, 0.0, pose.yaw}); }

base::Bytes body_geometry(const world::Mover& mover) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  glm::dvec3 least(kInf), most(-kInf);
  for (const world::Segment& side : mover.body) {
    if (!side.stops_robots) continue;
    least = glm::min(least, glm::dvec3(glm::min(side.a, side.b), side.z_min));
    most = glm::max(most, glm::dvec3(glm::max(side.a, side.b), side.z_max));
  }
  if (least.x > most.x) least = most = glm::dvec3(0.0);
  base::Bytes out;
  XdrWriter xdr(out);
  const glm::dvec3 middle = 0.5 * (least + most), size = most - least;
  put_pose({middle.x, middle.y, middle.z, 0.0}, xdr);
  put_size(size.y, size.x, size.z, xdr);
  return out;
}

const sensors::ConeArray& SensorGeometry::cones(std::uint8_t type, std::size_t row) const {
  return sensor_set_.settings_of<sensors::ConeArray>(type)[row];
}

base::Bytes SensorGeometry::geometry(Interface interf, std::uint8_t type, const sensors::SensorSpec& spec,
                                     std::size_t row) const {
  if (interf == Interface::laser) return scanner_geometry(spec);
  if (interf == Interface::bumper)
    return bumper_geometry(sensor_set_.settings_of<sensors::BumperSwitches>(sensors::kBumper)[row],
                           world_.movers[spec.mover]);
  if (interf == Interface::sonar || interf == Interface::ir) return array_geometry(cones(type, row));
  if (interf != Interface::ranger) return {};
  const base::Pose one;
  return ranger_geometry(spec,
                         is_array(type) ? std::span<const base::Pose>(cones(type, row).X_SC) : std::span(&one, 1));
}

base::Bytes SensorGeometry::config(Interface interf, std::uint8_t type, const sensors::SensorSpec& spec,
                                   std::size_t row) const {
  if (interf == Interface::laser) return laser_config(spec);
  if (interf != Interface::ranger) return {};
  if (is_array(type)) return ranger_config(spec, 0.0, 0.0, cones(type, row).fov);
  return ranger_config(spec, sensors::bearing_of(spec, 0), sensors::bearing_of(spec, spec.elements - 1),
                       resolution_of(spec));
}

}  // namespace sf::bridges::player
