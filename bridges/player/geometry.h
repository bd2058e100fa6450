#pragma once
// Payloads of the answers to GET_GEOM, POSE and GET_CONFIG, which do not change during a run. Poses of devices are in
// the robot's frame. Sizes of sensors are not modelled, and 0.

#include <cstdint>
#include <vector>

#include "base/bytes.h"
#include "bridges/player/protocol.h"
#include "bridges/player/xdr.h"
#include "sensors/cones/cone_array.h"
#include "world/world.h"

namespace sf::bridges::player {

/// player_pose3d: x, y, z [m], roll, pitch, yaw [rad].
void put_pose(const base::Pose& pose, XdrWriter& xdr);

/// Of position2d: the middle and the size of the parts of the body that touch others.
base::Bytes body_geometry(const world::Mover& mover);

/// The geometry of a world's sensors.
class SensorGeometry {
 public:
  explicit SensorGeometry(const world::World& world);

  /// @param type of the sensor  @param row of its spec in `sensors::SensorSet::group(type)`
  /// @return empty where the interface has no such request
  base::Bytes geometry(Interface interf, std::uint8_t type, const sensors::SensorSpec& spec, std::size_t row) const;
  base::Bytes config(Interface interf, std::uint8_t type, const sensors::SensorSpec& spec, std::size_t row) const;

 private:
  const sensors::ConeArray& cones(std::uint8_t type, std::size_t row) const;

  const world::World& world_;
  std::vector<sensors::ConeArray> sonars_, infrareds_;
  std::vector<std::vector<std::uint32_t>> bumpers_;  ///< sectors of each switch
};

}  // namespace sf::bridges::player
