#include "record/tick_messages.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/marked_values.h"
#include "record/fleet_message.h"
#include "record/lights_message.h"
#include "record/reading_messages.h"
#include "record/schemas.h"
#include "record/standard_readings.h"
#include "record/world_messages.h"

namespace sf::record {

namespace {

enum Row : std::uint32_t { kRun, kFleetRow, kTf, kTfStatic, kClockRow, kMap, kWalls, kBodies, kLightsRow };

Scan header_of(const SensorInfo& sensor) {
  return {.frame = frame_of(sensor),
          .fov = static_cast<float>(sensor.fov),
          .scan_time = static_cast<float>(1.0 / sensor.rate),
          .range_min = sensor.range_min,
          .range_max = sensor.range_max};
}

}  // namespace

/// Messages of one tick on their way.
struct TickMessages::Output {
  const base::TickRecord& record;
  const Emit& emit;
  const std::vector<bool>& wanted;
  base::Bytes& bytes;

  bool wants(std::uint32_t topic) const { return wanted.empty() || wanted[topic]; }
  /// @param encode appends the message to the bytes that it is given
  template <class Encode>
  void send(std::uint32_t topic, std::uint32_t sequence, std::int64_t time, Encode&& encode) const {
    if (!wants(topic)) return;
    bytes.clear();
    encode(bytes);
    emit({topic, sequence, record.time, time, bytes});
  }
};

TickMessages::TickMessages(const RunInfo& info) : info_(info), marks_too_near_(option_of(info, kTooNear) != "min") {
  add("/run", kRunInfo, true);
  add("/fleet", kFleet);
  add("/tf", kTransforms);
  add("/tf_static", kTransforms, true);
  add("/clock", kClock);
  add("/map", kOccupancyGrid, true);
  add("/walls", kMarkers, true);
  add("/bodies", kMarkers, true);
  if (!info.lights.empty()) add("/lights", kLights);
  for (const MoverInfo& mover : info.movers) add_mover(mover);
  first_reading_ = topics_.size();
  if (info.record_readings)
    for (std::size_t row = 0; row < info.movers.size(); ++row) add_readings(row);
}

std::uint32_t TickMessages::add(std::string name, std::string_view type, bool latched) {
  auto known = schemas_.find(type);
  if (known == schemas_.end()) known = schemas_.emplace(type, schema_text(type)).first;
  topics_.push_back({std::move(name), known->first, known->second, latched});
  return static_cast<std::uint32_t>(topics_.size() - 1);
}

std::uint32_t TickMessages::add(std::string name, const SensorTypeInfo& type) {
  if (!type.is_scan) schemas_.try_emplace(record::type_of(type), schema_text(type));
  return add(std::move(name), record::type_of(type));
}

void TickMessages::add_mover(const MoverInfo& mover) {
  MoverTopics& row = movers_.emplace_back();
  const std::string topic = "/" + mover.frame;
  if (info_.odometry_rate > 0.0) {
    row.odometry = add(topic + "/odom", kOdometry);
    row.command = add(topic + "/cmd_vel", kTwistStamped);
  }
  if (info_.estimated) row.quality = add(topic + "/state_quality", kStateQuality);
  for (const SensorInfo& sensor : mover.sensors)
    row.sensors.push_back({find_sensor_type(info_, sensor.type), &sensor, 0, header_of(sensor)});
}

void TickMessages::add_readings(std::size_t row) {
  for (SensorTopics& each : movers_[row].sensors) {
    each.topic = add(each.sensor->topic, *each.type);
    each.standard = static_cast<std::uint32_t>(topics_.size());
    for (const StandardTopic& standard : each.sensor->standard) add(standard.topic, type_of(standard.message));
  }
}

std::vector<bool> TickMessages::readings_and_clock() const {
  std::vector<bool> wanted(topics_.size());
  for (std::size_t topic = first_reading_; topic < wanted.size(); ++topic) wanted[topic] = true;
  wanted[kClockRow] = true;
  return wanted;
}

void TickMessages::begin(const Emit& emit) {
  next_odometry_ = 0;
  ticks_ = odometries_ = 0;
  const base::TickRecord start;
  const std::vector<bool> all;
  const Output out{start, emit, all, message_};
  out.send(kRun, 0, 0, [&](base::Bytes& bytes) { encode_run_info(info_, bytes); });
  send_frames(out);
  const WorldShape& shape = info_.shape;
  if (shape.columns > 0) out.send(kMap, 0, 0, [&](base::Bytes& bytes) { encode_map(shape, bytes); });
  if (!shape.walls.empty()) out.send(kWalls, 0, 0, [&](base::Bytes& bytes) { encode_walls(shape, bytes); });
  out.send(kBodies, 0, 0, [&](base::Bytes& bytes) { encode_bodies(info_.movers, bytes); });
}

void TickMessages::go_on(const TickMessages& before, std::int64_t time, const Emit& emit) {
  next_odometry_ = before.next_odometry_;
  ticks_ = before.ticks_;
  odometries_ = before.odometries_;
  base::TickRecord last;
  last.time = time;
  const std::vector<bool> all;
  const Output out{last, emit, all, message_};
  out.send(kRun, 0, time, [&](base::Bytes& bytes) { encode_run_info(info_, bytes); });
  send_frames(out);
  out.send(kBodies, 0, time, [&](base::Bytes& bytes) { encode_bodies(info_.movers, bytes); });
}

/// Of sensors and of their elements.
void TickMessages::send_frames(const Output& out) {
  transforms_.clear();
  for (std::size_t row = 0; row < movers_.size(); ++row)
    for (const SensorTopics& each : movers_[row].sensors) {
      transforms_.push_back({0, info_.movers[row].frame, each.header.frame, each.sensor->X_MS});
      for (const StandardTopic& element : each.sensor->standard)
        if (element.frame != each.header.frame)
          transforms_.push_back({0, each.header.frame, element.frame, element.X_SE});
    }
  out.send(kTfStatic, 0, 0, [&](base::Bytes& bytes) { encode_transforms(transforms_, bytes); });
}

void TickMessages::encode(const base::TickRecord& record, const Emit& emit, const std::vector<bool>& wanted) {
  for (const base::Report& report : record.reports)
    SF_CHECK(report.mover < movers_.size(), "mover " + std::to_string(report.mover));
  const Output out{record, emit, wanted, message_};
  out.send(kFleetRow, ticks_, record.time, [&](base::Bytes& bytes) { encode_fleet(record, bytes); });
  send_transforms(out);
  out.send(kClockRow, ticks_, record.time, [&](base::Bytes& bytes) { encode_clock(record.time, bytes); });
  if (!record.lights.empty())
    out.send(kLightsRow, ticks_, record.time,
             [&](base::Bytes& bytes) { encode_lights(record.time, info_.lights, record.lights, bytes); });
  if (info_.odometry_rate > 0.0 && record.time >= next_odometry_) send_odometry(out);
  if (info_.estimated) send_qualities(out);
  if (info_.record_readings)
    for (const base::ReadingBlock& reading : record.readings) send_reading(reading, out);
  ++ticks_;
}

void TickMessages::send_transforms(const Output& out) {
  if (!out.wants(kTf)) return;
  const base::TickRecord& record = out.record;
  transforms_.clear();
  for (const base::Report& report : record.reports) {
    if (base::is_absent(report.X_WM)) continue;
    transforms_.push_back({record.time, "world", info_.movers[report.mover].frame, report.X_WM});
  }
  out.send(kTf, ticks_, record.time, [&](base::Bytes& bytes) { encode_transforms(transforms_, bytes); });
}

void TickMessages::send_qualities(const Output& out) const {
  const base::TickRecord& record = out.record;
  SF_CHECK(record.qualities.size() == record.reports.size(), std::to_string(record.qualities.size()));
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    const std::uint32_t mover = record.reports[i].mover;
    if (record.qualities[i].stated && record.qualities[i].age != base::kNoStateYet)
      out.send(movers_[mover].quality, ticks_, record.time, [&](base::Bytes& bytes) {
        encode_state_quality(record.time, info_.movers[mover].frame, record.qualities[i], bytes);
      });
  }
}

void TickMessages::send_odometry(const Output& out) {
  const base::TickRecord& record = out.record;
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    const base::Report& report = record.reports[i];
    if (base::is_absent(report.X_WM)) continue;
    const std::string& frame = info_.movers[report.mover].frame;
    out.send(movers_[report.mover].odometry, odometries_, record.time, [&](base::Bytes& bytes) {
      encode_odometry({record.time, "world", frame, report.X_WM}, report.velocity, bytes);
    });
    if (record.commands.empty()) continue;
    out.send(movers_[report.mover].command, odometries_, record.time,
             [&](base::Bytes& bytes) { encode_twist(record.time, frame, record.commands[i], bytes); });
  }
  ++odometries_;
  const auto period = std::max<std::int64_t>(1, std::llround(1e9 / info_.odometry_rate));
  next_odometry_ = (record.time / period + 1) * period;
}

void TickMessages::send_reading(const base::ReadingBlock& reading, const Output& out) {
  SF_CHECK(reading.mover < movers_.size(), "mover " + std::to_string(reading.mover));
  std::uint32_t before = 0;  // sensors of the same type before this one
  for (SensorTopics& each : movers_[reading.mover].sensors) {
    if (each.type->id != reading.type || before++ < reading.sensor) continue;
    each.header.time = reading.time;
    const auto values = marks_too_near_ ? base::marked_values(reading, marked_) : reading.values;
    out.send(each.topic, reading.sequence, reading.time, [&](base::Bytes& bytes) {
      each.type->is_scan ? encode_scan(each.header, values, bytes)
                         : encode_reading(*each.type, reading.time, each.header.frame, values, bytes);
    });
    std::uint32_t topic = each.standard;
    for (const StandardTopic& standard : each.sensor->standard)
      out.send(topic++, reading.sequence, reading.time,
               [&](base::Bytes& bytes) { encode_standard(standard, reading.time, values, bytes); });
    return;
  }
  SF_CHECK(false, "mover " + std::to_string(reading.mover) + " type " + std::to_string(reading.type) + " sensor " +
                      std::to_string(reading.sensor));
}

}  // namespace sf::record
