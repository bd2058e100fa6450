#include "apps/commands/plot_allan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include "apps/reports/text.h"
#include "base/error.h"
#include "base/number_text.h"
#include "sensors/allan.h"
#include "sensors/gyro.h"
#include "sensors/imu.h"
#include "sensors/mover_trail.h"
#include "sensors/sensor_set.h"
#include "world/table_record.h"

namespace sf::apps {

namespace {

constexpr std::size_t kMostPanels = 16;

/// Prints which columns or sensors are neither drawn nor written.
void note_left_out(const std::string& why, const std::vector<std::string>& names) {
  if (!names.empty()) print_message("warning: --allan leaves out, {}: {}", why, fmt::join(names, ", "));
}
const std::string kNoPanel = fmt::format("beyond {} panels", kMostPanels);

/// One quantity of a sensor.
struct Measured {
  std::string name;
  std::size_t first = 0, axes = 1;       ///< numbers of a reading
  std::function<double(double)> stated;  ///< square of the Allan deviation at a time [s]
};

/// One sensor with its readings by time.
struct AllanSensor {
  std::string name;
  double interval = 0.0;  ///< [s] between readings
  std::vector<Measured> quantities;
  std::vector<const record::ReadingSample*> readings;
};

std::vector<Measured> quantities_of(const sensors::SensorSet& sensor_set, const record::ReadingSample& reading) {
  if (reading.type == sensors::kGyro) {
    const double noise = sensor_set.settings_of<sensors::Gyro>(reading.type, reading.mover)[reading.sensor].noise;
    const double interval = 1.0 / sensor_set.of(reading.type, reading.mover)[reading.sensor].rate;
    return {{"angular rate [rad/s]", 0, 1, [=](double time) { return noise * noise * interval / time; }}};
  }
  const sensors::Imu imu = sensor_set.settings_of<sensors::Imu>(reading.type, reading.mover)[reading.sensor];
  const auto stated = [](const sensors::TriadErrors& errors) {
    return [errors](double time) { return sensors::allan_variance(errors, time); };
  };
  return {{"angular rate [rad/s]", 0, 3, stated(imu.gyro)}, {"specific force [m/s²]", 3, 3, stated(imu.accel)}};
}

std::vector<AllanSensor> sensors_of(const record::Recording& recording, const world::World& world) {
  const sensors::SensorSet sensor_set(world);
  std::map<std::tuple<std::uint32_t, std::uint8_t, std::uint32_t>, AllanSensor> sensors;
  for (const record::ReadingSample& reading : recording.readings) {
    if (reading.type != sensors::kImu && reading.type != sensors::kGyro) continue;
    AllanSensor& sensor = sensors[{reading.mover, reading.type, reading.sensor}];
    if (sensor.readings.empty()) {
      const sensors::SensorSpec& row = sensor_set.of(reading.type, reading.mover)[reading.sensor];
      sensor = {
          world.movers[reading.mover].name + " " + row.name, 1.0 / row.rate, quantities_of(sensor_set, reading), {}};
    }
    sensor.readings.push_back(&reading);
  }
  std::vector<AllanSensor> all;
  for (auto& [key, sensor] : sensors) all.push_back(std::move(sensor));
  return all;
}

void check_interval(const record::Recording& recording, const AllanSensor& sensor) {
  for (std::size_t i = 1; i < sensor.readings.size(); ++i) {
    const double time = 1e-9 * static_cast<double>(sensor.readings[i]->time - sensor.readings[i - 1]->time);
    if (std::abs(time - sensor.interval) > 0.5 * sensor.interval)
      throw base::InputError(
          recording.file, 0,
          fmt::format("--allan: the readings of '{}' at {:g} s are {:g} s apart, not {:g} s; expected readings without "
                      "gaps",
                      sensor.name, 1e-9 * static_cast<double>(sensor.readings[i]->time), time, sensor.interval));
  }
}

void warn_of_motion(const record::Recording& recording, const world::World& world) {
  for (std::uint32_t mover = 0; mover < recording.states.size(); ++mover) {
    const auto& states = recording.states[mover];
    const auto reads = [&](const record::ReadingSample& reading) {
      return reading.mover == mover && (reading.type == sensors::kImu || reading.type == sensors::kGyro);
    };
    const auto moves = [&](const record::StateSample& state) {
      return !sensors::is_same_place(record::report_of(state, mover), record::report_of(states.front(), mover));
    };
    if (std::ranges::any_of(states, moves) && std::ranges::any_of(recording.readings, reads))
      print_message("warning: '{}' moves in this recording, and --allan takes motion for noise",
                    world.movers[mover].name);
  }
}

viz::Panel panel_of(const AllanSensor& sensor, const Measured& quantity) {
  viz::Panel panel{sensor.name, "Allan deviation, " + quantity.name, {}};
  std::vector<double> samples(sensor.readings.size());
  for (std::size_t axis = 0; axis < quantity.axes; ++axis) {
    viz::Series& series = panel.series.emplace_back();
    series.name = quantity.axes == 1 ? "measured" : fmt::format("{}", "xyz"[axis]);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = sensor.readings[i]->values[quantity.first + axis];
    for (const sensors::AllanPoint& point : sensors::allan_deviation(samples, sensor.interval))
      series.times.push_back(point.time), series.values.push_back(point.deviation);
  }
  viz::Series stated{"stated", panel.series[0].times, {}};
  for (const double time : stated.times) stated.values.push_back(std::sqrt(quantity.stated(time)));
  panel.series.push_back(std::move(stated));
  return panel;
}

/// A column of a table.
struct TableColumn {
  std::string name;
  std::size_t place = 0;  ///< field of a row
  std::vector<double> samples;
};

/// Returns the times first, then the columns whose first field is a number. Prints the names of the others.
std::vector<TableColumn> columns_of(const std::string& file) {
  constexpr std::string_view kTime = "time_s";
  world::TableRecord record(file);
  std::vector<TableColumn> columns;
  std::vector<std::string> headings;
  for (bool first = true; record.next();) {
    record.split(',', false);
    if (headings.empty()) {
      for (std::size_t i = 0; i < record.size(); ++i) headings.emplace_back(record.field(i));
      const auto time = std::ranges::find(headings, kTime);
      if (time == headings.end())
        throw base::InputError(file, record.first_line(),
                               fmt::format("--allan: the columns are '{}'; expected one named {} and one per axis",
                                           fmt::join(headings, ","), kTime));
      columns.push_back({std::string(kTime), static_cast<std::size_t>(time - headings.begin()), {}});
      continue;
    }
    std::vector<std::string> texts;
    for (std::size_t i = 0; first && i < headings.size(); ++i)
      if (!base::finite_number(record.field(i)))
        texts.push_back(headings[i]);
      else if (i != columns[0].place)
        columns.push_back({headings[i], i, {}});
    note_left_out("since they do not begin with a number", texts);
    first = false;
    for (TableColumn& column : columns) {
      const std::optional<double> value = base::finite_number(record.field(column.place));
      if (!value)
        throw base::InputError(
            file, record.first_line(),
            fmt::format("--allan: '{}' in column {}; expected a number", record.field(column.place), column.name));
      column.samples.push_back(*value);
    }
  }
  return columns;
}

/// Returns the interval of the times [s].
double interval_of(const std::string& file, const std::vector<double>& times) {
  const double interval = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t i = 1; i < times.size(); ++i)
    if (!(interval > 0.0 && std::abs(times[i] - times[i - 1] - interval) <= 0.5 * interval))
      throw base::InputError(file, 0,
                             fmt::format("--allan: the rows at {:g} s and {:g} s are {:g} s apart, {:g} s in the mean; "
                                         "expected one sensor's readings without gaps, by time",
                                         times[i - 1], times[i], times[i] - times[i - 1], interval));
  return interval;
}

}  // namespace

viz::SeriesOptions allan_figure_of_table(const std::string& file) {
  const std::vector<TableColumn> columns = columns_of(file);
  if (columns.size() < 2 || columns[0].samples.size() < 4)
    throw base::InputError(file, 0, "--allan: expected a heading, and at least four rows of numbers");
  const double interval = interval_of(file, columns[0].samples);
  viz::SeriesOptions figure{"Allan deviation", "", {}, "time of the means [s]"};
  figure.logarithmic = true;
  for (std::size_t i = 1; i < columns.size() && i <= kMostPanels; ++i) {
    viz::Panel& panel = figure.panels.emplace_back(viz::Panel{"", "Allan deviation, " + columns[i].name, {}});
    viz::Series& series = panel.series.emplace_back();
    series.name = "measured";
    for (const sensors::AllanPoint& point : sensors::allan_deviation(columns[i].samples, interval))
      series.times.push_back(point.time), series.values.push_back(point.deviation);
  }
  figure.subtitle =
      fmt::format("{}: {}", std::filesystem::path(file).filename().string(), counted(columns[0].samples.size(), "row"));
  std::vector<std::string> beyond;
  for (std::size_t i = kMostPanels + 1; i < columns.size(); ++i) beyond.push_back(columns[i].name);
  note_left_out(kNoPanel, beyond);
  if (!beyond.empty()) figure.subtitle += fmt::format(", the first {} columns shown", kMostPanels);
  return figure;
}

viz::SeriesOptions allan_figure(const record::Recording& recording, const world::World& world) {
  viz::SeriesOptions figure{"Allan deviation", "", {}, "time of the means [s]"};
  figure.logarithmic = true;
  const std::vector<AllanSensor> sensors = sensors_of(recording, world);
  if (sensors.empty())
    throw base::InputError(recording.file, 0,
                           "--allan: there are no readings of an imu or a gyro; record them with `run "
                           "--record-readings`");
  warn_of_motion(recording, world);
  std::size_t drawn = 0;
  for (const AllanSensor& sensor : sensors) {
    if (figure.panels.size() + sensor.quantities.size() > kMostPanels) break;
    check_interval(recording, sensor);
    if (sensor.readings.size() < 4)
      throw base::InputError(recording.file, 0,
                             fmt::format("--allan: '{}' has {}; expected at least 4", sensor.name,
                                         counted(sensor.readings.size(), "reading")));
    for (const Measured& quantity : sensor.quantities) figure.panels.push_back(panel_of(sensor, quantity));
    ++drawn;
  }
  figure.subtitle = fmt::format("{}: {}", recording.info.world, counted(sensors.size(), "sensor"));
  std::vector<std::string> beyond;
  for (std::size_t i = drawn; i < sensors.size(); ++i) beyond.push_back(sensors[i].name);
  note_left_out(kNoPanel, beyond);
  if (drawn < sensors.size()) figure.subtitle += fmt::format(", the first {} shown", drawn);
  return figure;
}

}  // namespace sf::apps
