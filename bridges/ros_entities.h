#pragma once
// Robots as entities of simulation_interfaces.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/report.h"
#include "record/cdr.h"
#include "record/run_info.h"

namespace sf::bridges {

/// Reads a `simulation_interfaces/EntityFilters`, and finds the rows of the movers that it names.
/// @param movers as of the last tick; absent ones are left out
/// @param rows out @return why it cannot be done; empty: it was done
std::string find_entities(record::CdrReader& cdr, const record::RunInfo& info, const std::vector<base::Report>& movers,
                          std::vector<std::size_t>& rows);

/// Appends a `simulation_interfaces/EntityState`. Velocities are in the world's frame. @param time [ns]
void put_entity_state(record::CdrWriter& cdr, std::int64_t time, const base::Report& state);

/// A wanted state.
struct EntityState {
  std::string frame;
  bool valid = false;  ///< finite, in bounds, and a turn about +z
  base::Pose X_WM;
  bool pose = true, twist = false, acceleration = false;  ///< that are to be set
};

/// Reads a `geometry_msgs/PoseStamped`.
EntityState get_stamped_pose(record::CdrReader& cdr, double z = 0.0);

/// Reads a `simulation_interfaces/EntityState` and, where bytes are left, the three flags behind it.
/// @param z [m] of the mover, which it keeps
EntityState get_entity_state(record::CdrReader& cdr, double z);

}  // namespace sf::bridges
