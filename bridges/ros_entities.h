#pragma once
// Robots as entities of simulation_interfaces.

#include <cstdint>
#include <string>
#include <vector>

#include "base/report.h"
#include "record/cdr.h"
#include "record/run_info.h"

namespace sf::bridges {

/// Reads a `simulation_interfaces/EntityFilters` and finds the rows of matching movers.
/// @param movers as of the last tick; absent movers are skipped @param rows out
/// @return the error; empty: success
std::string find_entities(record::CdrReader& cdr, const record::RunInfo& info, const std::vector<base::Report>& movers,
                          std::vector<std::size_t>& rows);

/// Appends a `simulation_interfaces/EntityState`. Velocities are in the world frame.
/// @param time [ns]
void put_entity_state(record::CdrWriter& cdr, std::int64_t time, const base::Report& state);

/// A requested state.
struct EntityState {
  std::string frame;
  bool valid = false;  ///< finite, within bounds, and rotated by a unit quaternion
  base::Pose X_WM;
  base::Tilt tilt;
  bool pose = true, twist = false, acceleration = false;  ///< members to set
};

/// Reads a `geometry_msgs/PoseStamped`.
EntityState get_stamped_pose(record::CdrReader& cdr, double z = 0.0);

/// Reads a `simulation_interfaces/EntityState` and, if bytes remain, the three flags after it.
/// @param z [m] of the mover, which remains unchanged
EntityState get_entity_state(record::CdrReader& cdr, double z);

}  // namespace sf::bridges
