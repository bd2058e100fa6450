#include "scenarios/replay.h"

#include <algorithm>

#include "base/error.h"
#include "record/reading_messages.h"

namespace sf::scenarios {

namespace {

bool same_columns(const record::SensorTypeInfo& a, const record::SensorTypeInfo& b) {
  const auto equal = [](const record::ColumnInfo& x, const record::ColumnInfo& y) {
    return x.name == y.name && x.width == y.width;
  };
  // Later versions may have appended columns to a list.
  const auto end = b.list.empty() || b.columns.size() < a.columns.size() ? b.columns.end()
                                                                         : b.columns.begin() + std::ssize(a.columns);
  return a.list == b.list && a.is_scan == b.is_scan &&
         std::equal(a.columns.begin(), a.columns.end(), b.columns.begin(), end, equal);
}

/// Returns the numbers per element of a sensor, as in `info`.
std::size_t width_of(const record::SensorTypeInfo& type, const record::SensorInfo& sensor) {
  return sensor.width != 0 ? sensor.width : record::element_width(type);
}

/// Returns whether `info` has the sensor of a reading, with values of the same form.
bool is_known(const record::ReadingSample& reading, const record::RunInfo& recorded, const record::RunInfo& info) {
  const record::SensorTypeInfo* const then = record::find_sensor_type(recorded, reading.type);
  const record::SensorTypeInfo* const now = record::find_sensor_type(info, reading.type);
  if (then == nullptr || now == nullptr || !same_columns(*then, *now)) return false;
  std::uint32_t before = 0;  // sensors of the same type before it
  for (const record::SensorInfo& sensor : info.movers[reading.mover].sensors) {
    if (sensor.type != reading.type || before++ != reading.sensor) continue;
    const std::size_t width = width_of(*now, sensor), size = reading.values.size();
    return now->list.empty() ? size == width : size % width == 0;
  }
  return false;
}

/// Returns X_MS of the sensor of a reading.
base::Pose mount_of(const record::RunInfo& info, const record::ReadingSample& reading) {
  std::uint32_t before = 0;  // sensors of the same type before it
  for (const record::SensorInfo& sensor : info.movers[reading.mover].sensors)
    if (sensor.type == reading.type && before++ == reading.sensor) return sensor.X_MS;
  return {};
}

}  // namespace

Replay::Replay(const record::Recording& recording, const record::RunInfo& info)
    : recording_(recording), lights_(info.lights.size()) {
  if (recording.states.size() != info.movers.size() || recording.states.empty())
    throw base::InputError(recording.file, 0, "has other robots than its world");
  if (ticks() == 0) throw base::InputError(recording.file, 0, "has no ticks");
  for (std::size_t row = 0; row < recording.readings.size(); ++row) {
    if (is_known(recording.readings[row], recording.info, info))
      rows_.push_back(row);
    else
      ++left_out_;
  }
  std::stable_sort(rows_.begin(), rows_.end(), [&](std::size_t a, std::size_t b) {
    return recording.readings[a].delivered < recording.readings[b].delivered;
  });
  for (const std::size_t row : rows_) {
    const record::ReadingSample& reading = recording.readings[row];
    sensors_[{reading.mover, reading.type, reading.sensor}].push_back(row);
  }
}

std::size_t Replay::tick_at(std::int64_t time) const {
  const auto& states = recording_.states.front();
  const auto after = std::upper_bound(states.begin(), states.end(), time,
                                      [](std::int64_t t, const record::StateSample& state) { return t < state.time; });
  return after == states.begin() ? 0 : static_cast<std::size_t>(after - states.begin()) - 1;
}

base::TickRecord Replay::tick(std::size_t number, std::optional<std::size_t> shown) {
  add_states(number);
  readings_.clear();
  const auto is_later = [&](std::int64_t time, std::size_t row) { return time < recording_.readings[row].delivered; };
  const std::int64_t now = time_of(number);
  if (shown && *shown <= number) {
    const auto begin = std::upper_bound(rows_.begin(), rows_.end(), time_of(*shown), is_later);
    const auto end = std::upper_bound(begin, rows_.end(), now, is_later);
    for (auto row = begin; row != end; ++row) add_reading(*row);
  } else {
    for (const auto& [sensor, rows] : sensors_) {
      const auto after = std::upper_bound(rows.begin(), rows.end(), now, is_later);
      if (after != rows.begin()) add_reading(*(after - 1));
    }
  }
  base::TickRecord record;
  record.tick = recording_.states.front()[number].tick;
  record.time = now;
  record.reports = reports_;
  record.commands = commands_;
  record.contacts = contacts_;
  record.readings = readings_;
  const auto lights =
      std::upper_bound(recording_.lights.begin(), recording_.lights.end(), now,
                       [](std::int64_t time, const record::LightsSample& sample) { return time < sample.time; });
  if (lights != recording_.lights.begin() && (lights - 1)->lights.size() == lights_)
    record.lights = (lights - 1)->lights;
  return record;
}

/// Omits movers without a state in a damaged tick; viewers keep their last pose.
void Replay::add_states(std::size_t number) {
  reports_.clear();
  commands_.clear();
  contacts_.clear();
  for (std::uint32_t mover = 0; mover < recording_.states.size(); ++mover) {
    const auto& states = recording_.states[mover];
    if (number >= states.size()) continue;
    const record::StateSample& state = states[number];
    reports_.push_back(record::report_of(state, mover));
    commands_.push_back(state.command);
    contacts_.push_back(state.contact ? 1 : 0);
  }
}

/// Interpolates between ticks, because sensors also measure between ticks.
base::TiltedPose Replay::pose_at(std::uint32_t mover, std::int64_t time) const {
  const auto& states = recording_.states[mover];
  const auto after = std::upper_bound(states.begin(), states.end(), time,
                                      [](std::int64_t t, const record::StateSample& state) { return t < state.time; });
  if (after == states.begin() || after == states.end()) {
    const record::StateSample& end = after == states.begin() ? *after : after[-1];
    return {end.X_WM, end.tilt};
  }
  const base::Pose &from = after[-1].X_WM, &to = after->X_WM;
  const double part = static_cast<double>(time - after[-1].time) / static_cast<double>(after->time - after[-1].time);
  if (!base::is_level(after[-1].tilt) || !base::is_level(after->tilt))
    return base::screw_between({from, after[-1].tilt}, {to, after->tilt}, part);
  return {{from.x + part * (to.x - from.x), from.y + part * (to.y - from.y), from.z + part * (to.z - from.z),
           from.yaw + part * base::wrap_angle(to.yaw - from.yaw)}};
}

void Replay::add_reading(std::size_t row) {
  const record::ReadingSample& reading = recording_.readings[row];
  base::ReadingBlock& block = readings_.emplace_back();
  block.mover = reading.mover;
  block.sensor = reading.sensor;
  block.type = reading.type;
  block.sequence = reading.sequence;
  block.time = reading.time;
  block.values = reading.values;
  const base::TiltedPose pose = pose_at(reading.mover, reading.time);
  block.X_WM = pose.X, block.tilt = pose.tilt;
  block.X_WS = compose(block.X_WM, mount_of(recording_.info, reading));
}

}  // namespace sf::scenarios
