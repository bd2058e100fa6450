#include "scenarios/standard_topics.h"

#include <algorithm>

#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "sensors/host_backend.h"
#include "sensors/infrared.h"
#include "sensors/magnetometer.h"
#include "sensors/occupancy.h"
#include "sensors/sonar.h"

namespace sf::scenarios {

namespace {

using record::StandardTopic;
using Message = StandardTopic::Message;

/// The mover's sensor number `sensor` of a type.
record::SensorInfo& find(record::RunInfo& info, std::uint32_t mover, std::uint8_t type, std::uint32_t sensor) {
  auto& sensors = info.movers[mover].sensors;
  return *std::find_if(sensors.begin(), sensors.end(),
                       [&](const record::SensorInfo& s) { return s.type == type && sensor-- == 0; });
}

void add_ranges(const std::vector<sensors::ConeArray>& arrays, std::uint8_t type, record::RunInfo& info) {
  for (const sensors::ConeArray& array : arrays) {
    auto& topics = find(info, array.row.mover, type, array.row.sensor).standard;
    for (std::uint32_t i = 0; i < array.X_SC.size(); ++i)
      topics.push_back({.message = Message::range,
                        .element = i,
                        .X_SE = array.X_SC[i],
                        .infrared = type == sensors::kInfrared,
                        .fov = array.fov,
                        .range_min = array.range_min,
                        .range_max = array.range_max});
  }
}

void add_fields(const world::World& world, record::RunInfo& info) {
  sensors::for_each_sensor(world, sensors::magnetometer_type, [&](const sensors::MountedSensor& mounted) {
    const std::vector<base::Pose> elements = sensors::read_magnetometer(mounted.settings).X_SE;
    auto& topics = find(info, mounted.row.mover, sensors::kMagnetometer, mounted.row.sensor).standard;
    for (std::uint32_t i = 0; i < elements.size(); ++i)
      topics.push_back({.message = Message::magnetic_field, .element = i, .X_SE = elements[i]});
  });
}

}  // namespace

void add_standard_topics(const world::World& world, record::RunInfo& info) {
  add_ranges(sensors::cone_arrays_of(world, sensors::sonar_type.word.type, sensors::read_sonar), sensors::kSonar, info);
  add_ranges(sensors::cone_arrays_of(world, sensors::infrared_type.word.type, sensors::read_infrared),
             sensors::kInfrared, info);
  add_fields(world, info);
  for (const sensors::Occupancy& map : sensors::occupancies_of(world))
    find(info, map.row.mover, sensors::kOccupancy, map.row.sensor)
        .standard.push_back({.message = Message::map, .grid = map.settings.grid});
  for (record::MoverInfo& mover : info.movers)
    for (record::SensorInfo& sensor : mover.sensors) {
      if (sensor.type == sensors::kGps) sensor.standard.push_back({.message = Message::fix});
      if (sensor.type == sensors::kGyro) sensor.standard.push_back({.message = Message::imu});
    }
}

}  // namespace sf::scenarios
