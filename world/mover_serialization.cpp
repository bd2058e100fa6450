// Bytes of movers, and of their lasers, sensors and magnets.

#include "world/serialization.h"

namespace sf::world {

using base::ByteReader;
using base::ByteWriter;

namespace {

constexpr std::size_t kSegmentBytes = 6 * 8 + 4 + 1;
constexpr std::size_t kLaserBytes = 112;
constexpr std::size_t kSensorBytes = 64;   // at least
constexpr std::size_t kSettingBytes = 12;  // at least

void put_laser(ByteWriter& out, const Laser& laser, RowFields fields) {
  out.put_string(laser.name);
  put(out, laser.X_MS);
  for (const double value : {laser.fov, laser.range_min, laser.range_max, laser.rate, laser.phase, laser.latency,
                             laser.noise.range_sigma, laser.noise.range_proportional, laser.noise.angle_sigma}) {
    out.put(value);
  }
  out.put(laser.samples);
  out.put(laser.resolution);
  if (fields == RowFields::all) out.put(laser.color);
  put(out, laser.accuracy, fields);
}

Laser get_laser(ByteReader& in) {
  Laser laser;
  laser.name = in.get_string();
  laser.X_MS = get_pose(in);
  for (double* value : {&laser.fov, &laser.range_min, &laser.range_max, &laser.rate, &laser.phase, &laser.latency,
                        &laser.noise.range_sigma, &laser.noise.range_proportional, &laser.noise.angle_sigma}) {
    *value = in.get<double>();
  }
  laser.samples = in.get<std::uint32_t>();
  laser.resolution = in.get<std::uint32_t>();
  laser.color = in.get<std::uint32_t>();
  laser.accuracy = get_accuracy(in);
  return laser;
}

// Readings do not depend on the place in the file.
void put_setting(ByteWriter& out, const Setting& setting, RowFields fields) {
  out.put_string(setting.key);
  out.put(static_cast<std::uint32_t>(setting.numbers.size()));
  for (const double value : setting.numbers) out.put(value);
  out.put_string(setting.text);
  if (fields == RowFields::physics) return;
  out.put(static_cast<std::int32_t>(setting.line));
  out.put_string(setting.file);
}

Setting get_setting(ByteReader& in) {
  Setting setting;
  setting.key = in.get_string();
  setting.numbers.resize(get_count(in, sizeof(double)));
  for (double& value : setting.numbers) value = in.get<double>();
  setting.text = in.get_string();
  setting.line = in.get<std::int32_t>();
  setting.file = in.get_string();
  return setting;
}

void put_sensor(ByteWriter& out, const Sensor& sensor, RowFields fields) {
  out.put_string(sensor.type);
  out.put_string(sensor.name);
  put(out, sensor.X_MS);
  for (const double value : {sensor.height, sensor.metres_per_unit, sensor.radians_per_unit}) out.put(value);
  out.put(static_cast<std::uint32_t>(sensor.settings.size()));
  for (const Setting& setting : sensor.settings) put_setting(out, setting, fields);
  if (fields == RowFields::physics) return;
  out.put(static_cast<std::int32_t>(sensor.line));
  out.put_string(sensor.file);
}

Sensor get_sensor(ByteReader& in) {
  Sensor sensor;
  sensor.type = in.get_string();
  sensor.name = in.get_string();
  sensor.X_MS = get_pose(in);
  for (double* value : {&sensor.height, &sensor.metres_per_unit, &sensor.radians_per_unit}) *value = in.get<double>();
  sensor.settings.resize(get_count(in, kSettingBytes));
  for (Setting& setting : sensor.settings) setting = get_setting(in);
  sensor.line = in.get<std::int32_t>();
  sensor.file = in.get_string();
  return sensor;
}

}  // namespace

void put(ByteWriter& out, const Mover& mover, RowFields fields) {
  out.put_string(mover.name);
  out.put(mover.model);
  out.put(mover.id);
  out.put(static_cast<std::uint8_t>(mover.is_tag ? 1 : 0));
  out.put(static_cast<std::uint8_t>(mover.drive));
  put(out, mover.X_WM);
  out.put(static_cast<std::uint8_t>(mover.driver_model));
  for (const double value : {mover.radius, mover.max_forward, mover.max_turn, mover.max_acceleration,
                             mover.max_turn_acceleration, mover.wheelbase, mover.track})
    out.put(value);
  out.put(static_cast<std::uint32_t>(mover.body.size()));
  for (const Segment& segment : mover.body) put(out, segment);
  out.put(static_cast<std::uint32_t>(mover.lasers.size()));
  for (const Laser& laser : mover.lasers) put_laser(out, laser, fields);
  out.put(static_cast<std::uint32_t>(mover.sensors.size()));
  for (const Sensor& sensor : mover.sensors) put_sensor(out, sensor, fields);
  out.put(static_cast<std::uint32_t>(mover.magnets.size()));
  for (const Magnet& magnet : mover.magnets) put(out, magnet);
}

Mover get_mover(ByteReader& in) {
  Mover mover;
  mover.name = in.get_string();
  mover.model = in.get<std::uint32_t>();
  mover.id = in.get<std::uint32_t>();
  mover.is_tag = in.get<std::uint8_t>() != 0;
  mover.drive = get_enum(in, Drive::skid, "drive");
  mover.X_WM = get_pose(in);
  mover.driver_model = get_enum(in, DriverModel::player_create, "command law");
  for (double* value : {&mover.radius, &mover.max_forward, &mover.max_turn, &mover.max_acceleration,
                        &mover.max_turn_acceleration, &mover.wheelbase, &mover.track})
    *value = in.get<double>();
  mover.body.resize(get_count(in, kSegmentBytes));
  for (Segment& segment : mover.body) segment = get_segment(in);
  mover.lasers.resize(get_count(in, kLaserBytes));
  for (Laser& laser : mover.lasers) laser = get_laser(in);
  mover.sensors.resize(get_count(in, kSensorBytes));
  for (Sensor& sensor : mover.sensors) sensor = get_sensor(in);
  mover.magnets.resize(get_count(in, kMagnetBytes));
  for (Magnet& magnet : mover.magnets) magnet = get_magnet(in);
  return mover;
}

}  // namespace sf::world
