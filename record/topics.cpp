#include "record/topics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/marked_values.h"
#include "record/faults_message.h"
#include "record/fleet_message.h"
#include "record/lights_message.h"
#include "record/reading_messages.h"
#include "record/schemas.h"
#include "record/shapes_message.h"
#include "record/standard_readings.h"
#include "record/world_messages.h"

namespace sf::record {

namespace {

enum Row : std::uint32_t { kRun, kFleetRow, kClockRow, kWalls, kLightsRow };

Scan header_of(const SensorInfo& sensor) {
  return {.frame = sensor.frame,
          .fov = static_cast<float>(sensor.fov),
          .scan_time = static_cast<float>(1.0 / sensor.rate),
          .time_increment = static_cast<float>(sensor.sweep / std::max(1u, sensor.samples)),
          .range_min = sensor.range_min,
          .range_max = sensor.range_max};
}

}  // namespace

/// Destination of the messages of one tick.
struct TickMessages::Output {
  const base::TickRecord& record;
  const Emit& emit;
  const std::vector<bool>& wanted;
  base::Bytes& bytes;

  bool wants(std::uint32_t topic) const { return wanted.empty() || wanted[topic]; }
  /// @param encode appends the message to the bytes passed to it
  template <class Encode>
  void send(std::uint32_t topic, std::uint32_t sequence, std::int64_t time, Encode&& encode) const {
    if (!wants(topic)) return;
    bytes.clear();
    encode(bytes);
    emit({topic, sequence, record.time, time, bytes});
  }
};

TickMessages::TickMessages(const RunInfo& info)
    : info_(info),
      naming_(naming_of(info)),
      odometry_(info.record_readings ? naming_.odometry : OdometrySource::truth),
      root_(naming_.style == TopicStyle::sensor ? "world" : "map"),
      marks_too_near_(option_of(info, kTooNear) != "min") {
  add("/run", kRunInfo, true);
  add("/fleet", kFleet);
  add("/clock", kClock);
  add("/walls", kMarkers, true);
  if (!info.lights.empty()) add("/lights", kLights);
  if (!option_of(info, kFaultsOption).empty()) faults_ = add("/faults", kFaults);
  if (naming_.style != TopicStyle::nav2) add_tree("", 0, info.movers.size());
  for (std::size_t row = 0; row < info.movers.size(); ++row) {
    if (naming_.style == TopicStyle::nav2) add_tree(info.movers[row].space, row, row + 1);
    add_mover(info.movers[row]);
  }
  first_reading_ = topics_.size();
  if (info.record_readings)
    for (std::size_t row = 0; row < info.movers.size(); ++row) add_readings(row);
}

bool TickMessages::add_tilts() {
  if (tilts_ != 0) return false;
  tilts_ = add("/tilts", kTilts);
  return true;
}

bool TickMessages::add_wheels() {
  if (wheels_ != 0) return false;
  wheels_ = add("/wheels", kWheels);
  return true;
}

bool TickMessages::add_shapes() {
  if (shapes_ != 0) return false;
  shapes_ = add("/shapes", kShapes);
  return true;
}

/// @param prefix of its topics
void TickMessages::add_tree(const std::string& prefix, std::size_t first, std::size_t end) {
  Tree& tree = trees_.emplace_back();
  tree.first = first, tree.end = end;
  tree.transforms = add(prefix + "/tf", kTransforms);
  tree.fixed = add(prefix + "/tf_static", kTransforms, true);
  if (!naming_.mapper) tree.map = add(prefix + "/map", kOccupancyGrid, true);
  tree.bodies = add(prefix + "/bodies", kMarkers, true);
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
  MoverTopics& row = movers_.emplace_back(MoverTopics{.odometer = Odometer(mover, odometry_)});
  const std::string& base = mover.base_frame;
  if (naming_.style != TopicStyle::sensor) row.footprint = base.substr(0, base.rfind('/') + 1) + "base_footprint";
  if (info_.odometry_rate > 0.0) {
    row.odometry = add(mover.space + "/odom", kOdometry);
    if (has_truth()) row.truth = add(mover.space + "/ground_truth/odom", kOdometry);
    row.command = add(mover.space + "/cmd_vel", kTwistStamped);
  }
  if (info_.estimated) row.quality = add(mover.space + "/state_quality", kStateQuality);
  for (const SensorInfo& sensor : mover.sensors)
    row.sensors.push_back({find_sensor_type(info_, sensor.type), &sensor, 0, header_of(sensor)});
}

/// Recordings without readings contain the truth in /fleet; services do not have it.
bool TickMessages::has_truth() const {
  return info_.record_readings && !info_.estimated && naming_.style != TopicStyle::sensor;
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
  for (std::size_t topic = first_reading_; topic < wanted.size(); ++topic)
    wanted[topic] = topic != shapes_ && topic != tilts_ && topic != wheels_;
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
  for (MoverTopics& mover : movers_) mover.odometer.begin();
  for (const Tree& tree : trees_) send_tree(tree, out);
  if (!info_.shape.walls.empty()) out.send(kWalls, 0, 0, [&](base::Bytes& bytes) { encode_walls(info_.shape, bytes); });
}

void TickMessages::go_on(const TickMessages& before, std::int64_t time, const Emit& emit) {
  next_odometry_ = before.next_odometry_;
  ticks_ = before.ticks_;
  odometries_ = before.odometries_;
  for (MoverTopics& mover : movers_) mover.odometer.begin();
  for (std::size_t row = 0; row < before.movers_.size(); ++row) movers_[row].odometer = before.movers_[row].odometer;
  base::TickRecord last;
  last.time = time;
  const std::vector<bool> all;
  const Output out{last, emit, all, message_};
  out.send(kRun, 0, time, [&](base::Bytes& bytes) { encode_run_info(info_, bytes); });
  for (const Tree& tree : trees_) send_tree(tree, out);
}

/// Sends the static frames, the map and the bodies.
void TickMessages::send_tree(const Tree& tree, const Output& out) {
  transforms_.clear();
  // Walls, /fleet and services use the frame `world`. A mapper's map is at another place.
  if (naming_.style != TopicStyle::sensor && !naming_.mapper) transforms_.push_back({0, root_, "world", {}});
  for (std::size_t row = tree.first; row < tree.end; ++row) add_fixed(info_.movers[row], movers_[row]);
  out.send(tree.fixed, 0, out.record.time, [&](base::Bytes& bytes) { encode_transforms(transforms_, bytes); });
  if (info_.shape.columns > 0 && !naming_.mapper)
    out.send(tree.map, 0, out.record.time, [&](base::Bytes& bytes) { encode_map(info_.shape, root_, bytes); });
  const auto movers = std::span(info_.movers).subspan(tree.first, tree.end - tree.first);
  out.send(tree.bodies, 0, out.record.time, [&](base::Bytes& bytes) { encode_bodies(movers, bytes); });
}

/// Adds the frames of a mover's sensors and their elements, its footprint, and true odometry.
void TickMessages::add_fixed(const MoverInfo& mover, const MoverTopics& topics) {
  if (places_odometry(mover) && odometry_ == OdometrySource::truth)
    transforms_.push_back({0, root_, mover.odom_frame, {}});
  if (!topics.footprint.empty()) transforms_.push_back({0, mover.base_frame, topics.footprint, {}});
  for (const SensorTopics& each : topics.sensors) {
    transforms_.push_back({0, mover.base_frame, each.header.frame, each.sensor->X_MS, each.sensor->tilt});
    for (const StandardTopic& element : each.sensor->standard)
      if (element.message != StandardTopic::Message::map && element.frame != each.header.frame &&
          element.frame != transforms_.back().child)
        transforms_.push_back({0, each.header.frame, element.frame, element.X_SE, element.tilt});
  }
}

void TickMessages::encode(const base::TickRecord& record, const Emit& emit, const std::vector<bool>& wanted) {
  for (const base::Report& report : record.reports)
    SF_CHECK(report.mover < movers_.size(), "mover " + std::to_string(report.mover));
  const Output out{record, emit, wanted, message_};
  find_odometry(record);
  out.send(kFleetRow, ticks_, record.time, [&](base::Bytes& bytes) { encode_fleet(record, bytes); });
  if (tilts_ != 0 && any_tilted(record))
    out.send(tilts_, ticks_, record.time, [&](base::Bytes& bytes) { encode_tilts(record, bytes); });
  if (wheels_ != 0 && any_wheels(record))
    out.send(wheels_, ticks_, record.time, [&](base::Bytes& bytes) { encode_wheels(record, bytes); });
  send_transforms(out);
  out.send(kClockRow, ticks_, record.time, [&](base::Bytes& bytes) { encode_clock(record.time, bytes); });
  if (!record.lights.empty())
    out.send(kLightsRow, ticks_, record.time,
             [&](base::Bytes& bytes) { encode_lights(record.time, info_.lights, record.lights, bytes); });
  if (faults_ != 0 && !record.faults.empty())
    out.send(faults_, ticks_, record.time,
             [&](base::Bytes& bytes) { encode_faults(record.time, record.faults, bytes); });
  if (shapes_ != 0 && !record.shapes.empty())
    out.send(shapes_, ticks_, record.time,
             [&](base::Bytes& bytes) { encode_shapes(record.time, record.shapes, bytes); });
  if (info_.odometry_rate > 0.0 && record.time >= next_odometry_) {
    send_odometry(out);
    send_truth(out);
    ++odometries_;
    const auto period = std::max<std::int64_t>(1, std::llround(1e9 / info_.odometry_rate));
    next_odometry_ = (record.time / period + 1) * period;
  }
  if (info_.estimated) send_qualities(out);
  if (info_.record_readings)
    for (const base::ReadingBlock& reading : record.readings) send_reading(reading, out);
  ++ticks_;
}

/// Finds odometry of encoders at the times of their readings, and of other movers at the time of the tick.
void TickMessages::find_odometry(const base::TickRecord& record) {
  news_.clear();
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    const base::Report& report = record.reports[i];
    Odometer& odometer = movers_[report.mover].odometer;
    if (base::is_absent(report.X_WM)) odometer.leave();
    if (odometer.has_encoders() || base::is_absent(report.X_WM)) continue;
    const auto quality = record.qualities.empty() ? base::StateQuality{} : record.qualities[i];
    odometer.move(record.time, report.X_WM, report.velocity, quality, report.tilt);
    news_.push_back({report.mover, odometer.state()});
  }
  for (const base::ReadingBlock& reading : record.readings) {
    SF_CHECK(reading.mover < movers_.size(), "mover " + std::to_string(reading.mover));
    Odometer& odometer = movers_[reading.mover].odometer;
    if (odometer.reads(reading) && odometer.roll(reading)) news_.push_back({reading.mover, odometer.state()});
  }
}

void TickMessages::send_transforms(const Output& out) {
  const auto send = [&](const Tree& tree) {
    out.send(tree.transforms, ticks_, out.record.time,
             [&](base::Bytes& bytes) { encode_transforms(transforms_, bytes); });
    transforms_.clear();
  };
  transforms_.clear();
  const bool is_shared = naming_.style != TopicStyle::nav2;
  for (const Odometry& odometry : news_) {
    add_transforms(odometry);
    if (!is_shared && !transforms_.empty()) send(trees_[odometry.mover]);
  }
  if (is_shared) send(trees_[0]);
}

/// The farm publishes its own map -> odom. A mapper's map is at another place than the farm's.
bool TickMessages::places_odometry(const MoverInfo& mover) const {
  return naming_.style != TopicStyle::sensor && !naming_.mapper && (!naming_.localizer || mover.tag);
}

/// Adds the transforms of map -> odom -> base_link that no external node publishes.
void TickMessages::add_transforms(const Odometry& odometry) {
  const MoverInfo& mover = info_.movers[odometry.mover];
  const OdometryState& state = odometry.state;
  if (places_odometry(mover) && odometry_ != OdometrySource::truth)
    transforms_.push_back({state.time, root_, mover.odom_frame, state.X_WO});
  if (!naming_.filter || mover.tag)
    transforms_.push_back({state.time, mover.odom_frame, mover.base_frame, state.X_OM, state.tilt});
}

void TickMessages::send_qualities(const Output& out) const {
  const base::TickRecord& record = out.record;
  SF_CHECK(record.qualities.size() == record.reports.size(), std::to_string(record.qualities.size()));
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    const std::uint32_t mover = record.reports[i].mover;
    if (record.qualities[i].stated && record.qualities[i].age != base::kNoStateYet)
      out.send(movers_[mover].quality, ticks_, record.time, [&](base::Bytes& bytes) {
        encode_state_quality(record.time, info_.movers[mover].base_frame, record.qualities[i], bytes);
      });
  }
}

void TickMessages::send_odometry(const Output& out) {
  for (const auto& [row, state] : news_) {
    const MoverInfo& mover = info_.movers[row];
    out.send(movers_[row].odometry, odometries_, state.time, [&, &state = state](base::Bytes& bytes) {
      encode_odometry({state.time, mover.odom_frame, mover.base_frame, state.X_OM, state.tilt}, state.velocity,
                      state.covariance, bytes);
    });
  }
}

/// Sends true poses and commands.
void TickMessages::send_truth(const Output& out) {
  const base::TickRecord& record = out.record;
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    const base::Report& report = record.reports[i];
    if (base::is_absent(report.X_WM)) continue;
    const MoverTopics& topics = movers_[report.mover];
    const std::string& frame = info_.movers[report.mover].base_frame;
    if (has_truth())
      out.send(topics.truth, odometries_, record.time, [&](base::Bytes& bytes) {
        encode_odometry({record.time, "world", frame, report.X_WM, report.tilt}, report.velocity, {}, bytes);
      });
    if (!record.commands.empty())
      out.send(topics.command, odometries_, record.time,
               [&](base::Bytes& bytes) { encode_twist(record.time, frame, record.commands[i], bytes); });
  }
}

void TickMessages::send_reading(const base::ReadingBlock& reading, const Output& out) {
  SF_CHECK(reading.mover < movers_.size(), "mover " + std::to_string(reading.mover));
  std::uint32_t before = 0;  // number of sensors of the same type before this one
  for (SensorTopics& each : movers_[reading.mover].sensors) {
    if (each.type->id != reading.type || before++ < reading.sensor) continue;
    each.header.time = reading.time;
    const auto values = marks_too_near_ ? base::marked_values(reading, marked_) : reading.values;
    out.send(each.topic, reading.sequence, reading.time, [&](base::Bytes& bytes) {
      each.type->is_scan
          ? encode_scan(each.header, values, bytes)
          : encode_reading(*each.type, reading.time, each.header.frame, values, bytes, each.sensor->width);
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
