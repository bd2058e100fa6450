#include "world/rows.h"

#include "base/error.h"

namespace sf::world {

using base::ByteReader;
using base::ByteWriter;

namespace {

constexpr std::size_t kSegmentBytes = 6 * 8 + 4 + 1;
constexpr std::size_t kLaserBytes = 100;
constexpr std::size_t kSensorBytes = 64;   // at least
constexpr std::size_t kSettingBytes = 12;  // at least

void put_vec(ByteWriter& out, Vec2 p) {
  out.put(p.x);
  out.put(p.y);
}

Vec2 get_vec(ByteReader& in) {
  const double x = in.get<double>();
  return {x, in.get<double>()};
}

void put_laser(ByteWriter& out, const Laser& laser, Rows rows) {
  out.put_string(laser.name);
  put(out, laser.X_MS);
  for (const double value : {laser.fov, laser.range_min, laser.range_max, laser.rate, laser.phase, laser.latency,
                             laser.noise.range_sigma, laser.noise.range_proportional, laser.noise.angle_sigma}) {
    out.put(value);
  }
  out.put(laser.samples);
  out.put(laser.resolution);
  if (rows == Rows::all) out.put(laser.color);
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
  return laser;
}

// Where it was written says nothing about what is measured.
void put_setting(ByteWriter& out, const Setting& setting, Rows rows) {
  out.put_string(setting.key);
  out.put(static_cast<std::uint32_t>(setting.numbers.size()));
  for (const double value : setting.numbers) out.put(value);
  out.put_string(setting.text);
  if (rows == Rows::physics) return;
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

void put_sensor(ByteWriter& out, const Sensor& sensor, Rows rows) {
  out.put_string(sensor.type);
  out.put_string(sensor.name);
  put(out, sensor.X_MS);
  for (const double value : {sensor.height, sensor.metres, sensor.radians}) out.put(value);
  out.put(static_cast<std::uint32_t>(sensor.settings.size()));
  for (const Setting& setting : sensor.settings) put_setting(out, setting, rows);
  if (rows == Rows::physics) return;
  out.put(static_cast<std::int32_t>(sensor.line));
  out.put_string(sensor.file);
}

Sensor get_sensor(ByteReader& in) {
  Sensor sensor;
  sensor.type = in.get_string();
  sensor.name = in.get_string();
  sensor.X_MS = get_pose(in);
  for (double* value : {&sensor.height, &sensor.metres, &sensor.radians}) *value = in.get<double>();
  sensor.settings.resize(get_count(in, kSettingBytes));
  for (Setting& setting : sensor.settings) setting = get_setting(in);
  sensor.line = in.get<std::int32_t>();
  sensor.file = in.get_string();
  return sensor;
}

}  // namespace

void put(ByteWriter& out, const Pose& pose) {
  out.put(pose.x);
  out.put(pose.y);
  out.put(pose.z);
  out.put(pose.yaw);
}

Pose get_pose(ByteReader& in) {
  Pose pose;
  for (double* value : {&pose.x, &pose.y, &pose.z, &pose.yaw}) *value = in.get<double>();
  return pose;
}

void put(ByteWriter& out, const Segment& segment) {
  put_vec(out, segment.a);
  put_vec(out, segment.b);
  out.put(segment.z_min);
  out.put(segment.z_max);
  out.put(segment.model);
  const int flags = (segment.solid_left ? 1 : 0) | (segment.seen_by_laser ? 2 : 0) | (segment.stops_robots ? 4 : 0) |
                    (segment.seen_by_laneedge ? 8 : 0);
  out.put(static_cast<std::uint8_t>(flags));
}

Segment get_segment(ByteReader& in) {
  Segment segment;
  segment.a = get_vec(in);
  segment.b = get_vec(in);
  segment.z_min = in.get<double>();
  segment.z_max = in.get<double>();
  segment.model = in.get<std::uint32_t>();
  const auto flags = in.get<std::uint8_t>();
  segment.solid_left = (flags & 1) != 0;
  segment.seen_by_laser = (flags & 2) != 0;
  segment.stops_robots = (flags & 4) != 0;
  segment.seen_by_laneedge = (flags & 8) != 0;
  return segment;
}

void put(ByteWriter& out, const Stripe& stripe, Rows rows) {
  out.put(static_cast<std::uint32_t>(stripe.line.size()));
  for (const Vec2 p : stripe.line) put_vec(out, p);
  out.put(stripe.width);
  if (rows == Rows::all) out.put(stripe.color);
}

Stripe get_stripe(ByteReader& in) {
  Stripe stripe;
  stripe.line.resize(get_count(in, 2 * sizeof(double)));
  for (Vec2& p : stripe.line) p = get_vec(in);
  stripe.width = in.get<double>();
  stripe.color = in.get<std::uint32_t>();
  return stripe;
}

void put(ByteWriter& out, const Magnet& magnet) {
  put_vec(out, magnet.p);
  for (const double value : {magnet.z, magnet.moment, magnet.radius}) out.put(value);
  out.put(magnet.model);
}

Magnet get_magnet(ByteReader& in) {
  Magnet magnet;
  magnet.p = get_vec(in);
  for (double* value : {&magnet.z, &magnet.moment, &magnet.radius}) *value = in.get<double>();
  magnet.model = in.get<std::uint32_t>();
  return magnet;
}

void put(ByteWriter& out, const Model& model, Rows rows) {
  out.put_string(model.name);
  out.put_string(model.type);
  out.put(model.parent);
  out.put(model.mover);
  put(out, model.X_WM);
  put_vec(out, model.size);
  if (rows == Rows::all) out.put(model.color);
  out.put(static_cast<std::uint8_t>(model.is_bitmap ? 1 : 0));
  out.put(model.pixel);
}

Model get_model(ByteReader& in) {
  Model model;
  model.name = in.get_string();
  model.type = in.get_string();
  model.parent = in.get<std::uint32_t>();
  model.mover = in.get<std::uint32_t>();
  model.X_WM = get_pose(in);
  model.size = get_vec(in);
  model.color = in.get<std::uint32_t>();
  model.is_bitmap = in.get<std::uint8_t>() != 0;
  model.pixel = in.get<double>();
  return model;
}

void put(ByteWriter& out, const Mover& mover, Rows rows) {
  out.put_string(mover.name);
  out.put(mover.model);
  out.put(mover.id);
  out.put(static_cast<std::uint8_t>(mover.is_tag ? 1 : 0));
  out.put(static_cast<std::uint8_t>(mover.drive));
  put(out, mover.X_WM);
  for (const double value : {mover.radius, mover.max_forward, mover.max_turn, mover.wheelbase}) out.put(value);
  out.put(static_cast<std::uint32_t>(mover.body.size()));
  for (const Segment& segment : mover.body) put(out, segment);
  out.put(static_cast<std::uint32_t>(mover.lasers.size()));
  for (const Laser& laser : mover.lasers) put_laser(out, laser, rows);
  out.put(static_cast<std::uint32_t>(mover.sensors.size()));
  for (const Sensor& sensor : mover.sensors) put_sensor(out, sensor, rows);
  out.put(static_cast<std::uint32_t>(mover.magnets.size()));
  for (const Magnet& magnet : mover.magnets) put(out, magnet);
}

Mover get_mover(ByteReader& in) {
  Mover mover;
  mover.name = in.get_string();
  mover.model = in.get<std::uint32_t>();
  mover.id = in.get<std::uint32_t>();
  mover.is_tag = in.get<std::uint8_t>() != 0;
  const auto drive = in.get<std::uint8_t>();
  if (drive > static_cast<std::uint8_t>(Drive::car)) throw base::InputError("broken world snapshot: unknown drive");
  mover.drive = static_cast<Drive>(drive);
  mover.X_WM = get_pose(in);
  for (double* value : {&mover.radius, &mover.max_forward, &mover.max_turn, &mover.wheelbase})
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

std::uint32_t get_count(ByteReader& in, std::size_t row_size) {
  const auto count = in.get<std::uint32_t>();
  if (!in.good() || count > in.left() / row_size) throw base::InputError("broken world snapshot: cut short");
  return count;
}

}  // namespace sf::world
