#pragma once

#include <optional>

#include "base/reading.h"
#include "base/rigid_transform.h"
#include "sensors/sensor_set.h"

namespace sf::apps {

/// Returns the pose in the world of a sensor whose scans are spatial, or of a laser that is not level; nullopt of
/// others.
std::optional<base::RigidTransform> spatial_pose(const sensors::SensorSet& sensor_set,
                                                 const base::ReadingBlock& reading);

}  // namespace sf::apps
