#include "scenarios/standard_topics.h"

#include <algorithm>
#include <cmath>

#include "sensors/encoder.h"
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

/// Returns the mover's sensor number `sensor` of a type.
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

/// Adds the first encoders of each robot, from which its odometry is computed.
void add_encoders(const world::World& world, record::RunInfo& info) {
  sensors::for_each_sensor(world, sensors::encoder_type, [&](const sensors::MountedSensor& mounted) {
    if (mounted.row.sensor > 0) return;
    const sensors::Encoder e = sensors::read_encoder(mounted.settings, world.movers[mounted.row.mover]);
    info.movers[mounted.row.mover].encoder = {sensors::kEncoder, e.per_count, e.slip, e.track};
  });
}

}  // namespace

void add_standard_topics(const world::World& world, record::RunInfo& info) {
  add_ranges(sensors::cone_arrays_of(world, sensors::sonar_type.word.type, sensors::read_sonar), sensors::kSonar, info);
  add_ranges(sensors::cone_arrays_of(world, sensors::infrared_type.word.type, sensors::read_infrared),
             sensors::kInfrared, info);
  add_fields(world, info);
  add_encoders(world, info);
  for (const sensors::Occupancy& map : sensors::occupancies_of(world))
    find(info, map.row.mover, sensors::kOccupancy, map.row.sensor)
        .standard.push_back({.message = Message::map, .grid = map.settings.grid});
  sensors::for_each_sensor(world, sensors::gps_type, [&](const sensors::MountedSensor& mounted) {
    const double sigma = sensors::read_gps(mounted.settings).noise;
    find(info, mounted.row.mover, sensors::kGps, mounted.row.sensor)
        .standard.push_back({.message = Message::fix, .sigma = sigma});
  });
  sensors::for_each_sensor(world, sensors::gyro_type, [&](const sensors::MountedSensor& mounted) {
    const sensors::Gyro gyro = sensors::read_gyro(mounted.settings);
    find(info, mounted.row.mover, sensors::kGyro, mounted.row.sensor)
        .standard.push_back({.message = Message::imu, .sigma = std::hypot(gyro.noise, gyro.bias)});
  });
}

}  // namespace sf::scenarios
