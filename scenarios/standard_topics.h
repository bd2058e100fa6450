#pragma once
// Selects the readings that are also published as standard ROS messages: elements of sonars and infrared sensors as
// ranges, of magnetometers as magnetic fields, GPS fixes, gyros as IMUs, occupancy maps.

#include "record/run_info.h"
#include "sensors/sensor_set.h"

namespace sf::scenarios {

/// Sets `SensorInfo::standard` of all sensors. @param images of cameras
/// @pre `info` has the same sensors
void add_standard_topics(const sensors::SensorSet& sensor_set, record::ImageMessages images, record::RunInfo& info);

}  // namespace sf::scenarios
