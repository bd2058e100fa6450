#include "apps/reports/recording_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "apps/processes/stop_signals.h"
#include "apps/reports/csv_text.h"
#include "base/bearing.h"
#include "base/error.h"
#include "base/number_name.h"
#include "base/tilted_pose.h"
#include "record/reading_messages.h"
#include "scenarios/recorded_states.h"
#include "world/lights.h"
#include "world/world.h"

namespace sf::apps {

/// A CSV file that gets its name once it is complete; until `close`, its name is FILE.new.
class CsvFile {
 public:
  explicit CsvFile(const std::string& path) : path_(path), file_(fresh(), std::ios::trunc) {}
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;
  ~CsvFile() {
    std::error_code ignored;
    if (!whole_) std::filesystem::remove(fresh(), ignored);
  }
  /// @throws base::InputError if a row could not be written
  void close() {
    file_.close();
    std::error_code error;
    if (file_) std::filesystem::rename(fresh(), path_, error);
    whole_ = file_ && !error;
    if (!whole_) throw base::InputError(path_, 0, "cannot be written; name a folder that can be written and has room");
  }
  /// @throws Incomplete when a stop was requested
  void row(const std::string& text) {
    heed_stop();
    file_ << text << '\n';
  }

 private:
  std::string fresh() const { return path_ + ".new"; }
  std::string path_;
  std::ofstream file_;
  bool whole_ = false;
};

namespace {

std::string seconds(std::int64_t time) { return csv_number(1e-9 * static_cast<double>(time)); }

std::string twist_fields(const base::Twist& v) {
  return csv_number(v.forward) + "," + csv_number(v.left) + "," + csv_number(v.turn);
}

/// "range_m", "vector_T_x". @param type a record::SensorTypeInfo or a sensors::SensorType
std::string column_names(const auto& type) {
  std::string text;
  for (const auto& column : type.columns)
    for (std::uint32_t k = 0; k < column.width; ++k) text += "," + csv_field(base::number_name(column, k));
  return text;
}

const record::SensorInfo* sensor_of(const record::MoverInfo& mover, const record::ReadingSample& reading) {
  std::uint32_t k = 0;
  for (const record::SensorInfo& sensor : mover.sensors)
    if (sensor.type == reading.type && k++ == reading.sensor) return &sensor;
  return nullptr;
}

void write_reading(CsvFile& file, const record::RunInfo& info, const record::SensorTypeInfo& type,
                   const record::ReadingSample& reading) {
  const record::MoverInfo& mover = info.movers[reading.mover];
  const record::SensorInfo* sensor = sensor_of(mover, reading);
  const std::string begin =
      fmt::format("{},{},{},{},{},", seconds(reading.time), seconds(reading.delivered), csv_field(mover.name),
                  csv_field(sensor != nullptr ? sensor->name : ""), reading.sequence);
  const std::size_t width = reading.width, elements = reading.values.size() / width;
  const std::string missing(record::element_width(type) - width, ',');
  for (std::size_t e = 0; e < elements; ++e) {
    std::string row = begin + std::to_string(e);
    if (type.is_scan)
      row += "," + csv_number(sensor == nullptr ? NAN
                                                : base::bearing_of(sensor->fov, static_cast<std::uint32_t>(elements),
                                                                   static_cast<std::uint32_t>(e)));
    for (std::size_t k = 0; k < width; ++k) row += "," + csv_number(reading.values[e * width + k]);
    file.row(row + missing);
  }
}

}  // namespace

/// Roll and pitch have columns only in recordings in which a robot is tilted.
std::string write_trajectories_csv(const RecordingPart& part, const std::string& folder) {
  const std::string path = folder + "/trajectories.csv";
  const auto is_tilted = [](const record::StateSample& s) { return !base::is_level(s.tilt); };
  const bool tilted = std::ranges::any_of(part.recording.states,
                                          [&](const auto& states) { return std::ranges::any_of(states, is_tilted); });
  CsvFile file(path);
  file.row(std::string("time_s,robot,x_m,y_m,z_m,yaw_rad,forward_m_s,left_m_s,turn_rad_s,command_forward_m_s,"
                       "command_left_m_s,command_turn_rad_s,contact") +
           (tilted ? ",roll_rad,pitch_rad" : ""));
  for (std::size_t m = 0; m < part.recording.states.size(); ++m) {
    if (part.chosen[m] == 0) continue;
    const std::string name = csv_field(part.recording.info.movers[m].name);
    for (const record::StateSample& s : part.recording.states[m])
      file.row(fmt::format("{},{},{},{},{},{},{},{},{:d}", seconds(s.time), name, csv_number(s.X_WM.x),
                           csv_number(s.X_WM.y), csv_number(s.X_WM.z), csv_number(s.X_WM.yaw), twist_fields(s.velocity),
                           twist_fields(s.command), s.contact) +
               (tilted ? fmt::format(",{},{}", csv_number(s.tilt.roll), csv_number(s.tilt.pitch)) : ""));
  }
  file.close();
  return path;
}

std::string write_lights_csv(const RecordingPart& part, const std::string& folder) {
  const std::string path = folder + "/lights.csv";
  const world::World world = scenarios::recorded_world(part.recording);
  CsvFile file(path);
  file.row("time_s,light,state,seconds_to_change");
  for (const record::LightsSample& sample : part.recording.lights)
    for (std::size_t k = 0; k < std::min(world.lights.size(), sample.lights.size()); ++k)
      file.row(fmt::format("{},{},{},{}", seconds(sample.time), csv_field(world.lights[k].name),
                           world::light_state_name(static_cast<world::LightState>(sample.lights[k].state)),
                           csv_number(sample.lights[k].left)));
  file.close();
  return path;
}

std::vector<std::string> write_readings_csv(const RecordingPart& part, const std::string& folder) {
  const record::Recording& recording = part.recording;
  std::vector<std::string> files;
  for (const record::SensorTypeInfo& type : recording.info.sensor_types) {
    const auto is_one = [&](const record::ReadingSample& r) { return r.type == type.id; };
    if (std::none_of(recording.readings.begin(), recording.readings.end(), is_one)) continue;
    files.push_back(folder + "/" + type.name + ".csv");
    CsvFile file(files.back());
    file.row("time_s,delivered_s,robot,sensor,sequence,element" + std::string(type.is_scan ? ",bearing_rad" : "") +
             column_names(type));
    for (const record::ReadingSample& reading : recording.readings)
      if (is_one(reading)) write_reading(file, recording.info, type, reading);
    file.close();
  }
  return files;
}

DerivedCsv::DerivedCsv(const world::World& world, const sensors::SensorSet& sensor_set, const std::string& folder) {
  std::map<std::string, int> count;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows) count[row.name] += group.type->derived != nullptr;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    if (group.type->derived == nullptr) continue;
    for (const sensors::SensorSpec& row : group.rows) {
      std::string name = count[row.name] > 1 ? world.movers[row.mover].name + "_" + row.name : row.name;
      std::ranges::replace(name, '/', '_');
      Table table{folder + "/" + name + ".csv", sensors::element_width(*group.type), nullptr};
      table.file = std::make_unique<CsvFile>(table.path);
      table.file->row("time_s" + column_names(*group.type));
      tables_.emplace(std::tuple(group.type->id, row.mover, row.sensor), std::move(table));
    }
  }
}

DerivedCsv::~DerivedCsv() = default;

void DerivedCsv::add(const base::ReadingBlock& reading) {
  const auto found = tables_.find({reading.type, reading.mover, reading.sensor});
  if (found == tables_.end()) return;
  const std::string time = seconds(reading.time);
  for (std::size_t first = 0; first < reading.values.size(); first += found->second.width) {
    std::string row = time;
    for (const double value : reading.values.subspan(first, found->second.width)) row += "," + csv_number(value);
    found->second.file->row(row);
  }
}

std::vector<std::string> DerivedCsv::close() {
  std::vector<std::string> files;
  for (auto& [sensor, table] : tables_) {
    table.file->close();
    files.push_back(table.path);
  }
  return files;
}

}  // namespace sf::apps
