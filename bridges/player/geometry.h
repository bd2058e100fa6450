#pragma once
// Payloads of the answers to GET_GEOM, POSE and GET_CONFIG, which do not change during a run. Device poses are in the
// robot frame. Sizes of sensors are not modelled and are 0.

#include <cstdint>
#include <vector>

#include "base/bytes.h"
#include "netio/player/protocol.h"
#include "netio/player/xdr.h"
#include "sensors/cones/cone_array.h"
#include "sensors/sensor_set.h"

namespace sf::bridges::player {

using namespace netio::player;

/// player_pose3d: x, y, z [m], roll, pitch, yaw [rad].
void put_pose(const base::Pose& pose, XdrWriter& xdr);

/// Returns the geometry of position2d: the centre and size of the parts of the body that collide.
base::Bytes body_geometry(const world::Mover& mover);

/// The geometry of a world's sensors.
class SensorGeometry {
 public:
  /// Both must outlive it.
  SensorGeometry(const world::World& world, const sensors::SensorSet& sensor_set)
      : world_(world), sensor_set_(sensor_set) {}

  /// @param type of the sensor @param row of its spec in `sensors::SensorSet::group(type)`
  /// @return empty if the interface has no such request
  base::Bytes geometry(Interface interf, std::uint8_t type, const sensors::SensorSpec& spec, std::size_t row) const;
  base::Bytes config(Interface interf, std::uint8_t type, const sensors::SensorSpec& spec, std::size_t row) const;

 private:
  const sensors::ConeArray& cones(std::uint8_t type, std::size_t row) const;

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
};

}  // namespace sf::bridges::player
