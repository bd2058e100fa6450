#include "apps/plot_readings.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "apps/text.h"
#include "record/reading_messages.h"
#include "viz/series_figure.h"

namespace sf::apps {

namespace {

constexpr double kPlottedGauss = 1e4;          ///< per tesla
constexpr std::size_t kMostMagnetometers = 4;  ///< panels of their own

/// Readings of one sensor, in order of time.
struct Channel {
  std::string name;  ///< its robot's; with the sensor's where the robot has several
  std::vector<const record::ReadingSample*> readings;
};

const record::SensorTypeInfo* find_sensor_type(const record::RunInfo& info, const std::string& name) {
  for (const record::SensorTypeInfo& type : info.sensor_types)
    if (type.name == name) return &type;
  return nullptr;
}

/// Every sensor of a type that said something.
std::vector<Channel> channels_of(const record::Recording& recording, const record::SensorTypeInfo& type) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Channel> rows;
  for (const record::ReadingSample& reading : recording.readings)
    if (reading.type == type.id) rows[{reading.mover, reading.sensor}].readings.push_back(&reading);
  std::vector<Channel> channels;
  for (auto& [key, channel] : rows) {
    channel.name = recording.info.movers[key.first].name;
    if (rows.count({key.first, 1}) > 0) channel.name += fmt::format(" sensor {}", key.second);
    channels.push_back(std::move(channel));
  }
  return channels;
}

/// `value(reading)` of every reading.
template <class Value>
viz::Series series_of(const std::string& name, const Channel& channel, Value&& value) {
  viz::Series series{name, {}, {}};
  for (const record::ReadingSample* reading : channel.readings) {
    series.times.push_back(1e-9 * static_cast<double>(reading->time));
    series.values.push_back(value(*reading));
  }
  return series;
}

viz::SeriesOptions lane_edges(const record::Recording& recording, const std::vector<Channel>& channels) {
  viz::Panel panel{"", "distance [m]", {}};
  std::size_t readings = 0, seen = 0;
  for (const Channel& channel : channels) {
    panel.series.push_back(series_of(channel.name, channel, [](const auto& r) { return r.values[0]; }));
    readings += channel.readings.size();
    for (const double distance : panel.series.back().values) seen += std::isfinite(distance);
  }
  return {"Distance to the lane edge",
          fmt::format("{}: {}, {}, an edge in {} of them", recording.info.world, counted(channels.size(), "sensor"),
                      counted(readings, "reading"), seen),
          {panel}};
}

/// |B| of each element of one sensor.
viz::Panel fields_of(const Channel& channel, std::size_t width) {
  viz::Panel panel{channel.name, "|B| [G]", {}};
  const std::size_t elements = channel.readings.front()->values.size() / width;
  for (std::size_t e = 0; e < elements; ++e)
    panel.series.push_back(series_of(fmt::format("element {}", e), channel, [=](const record::ReadingSample& r) {
      return e * width < r.values.size() ? kPlottedGauss * r.values[e * width] : NAN;
    }));
  return panel;
}

/// A reading's row is |B|, then the vector. Path followers steer by how much stronger the last element's field is than
/// the first's.
viz::SeriesOptions fields(const record::Recording& recording, const std::vector<Channel>& channels, std::size_t width) {
  viz::SeriesOptions figure{"Magnetic field", "", {}};
  viz::Panel difference{"last element less the first", "|B| [G]", {}};
  const std::size_t drawn = std::min(channels.size(), kMostMagnetometers);
  for (std::size_t i = 0; i < drawn; ++i) {
    figure.panels.push_back(fields_of(channels[i], width));
    difference.series.push_back(series_of(channels[i].name, channels[i], [=](const record::ReadingSample& r) {
      return r.values.size() > width ? kPlottedGauss * (r.values[r.values.size() - width] - r.values[0]) : NAN;
    }));
  }
  figure.panels.push_back(std::move(difference));
  figure.subtitle = fmt::format("{}: {}", recording.info.world, counted(channels.size(), "sensor"));
  if (drawn < channels.size()) figure.subtitle += fmt::format(", the first {} shown", drawn);
  return figure;
}

}  // namespace

std::vector<std::string> draw_readings(const record::Recording& recording, const std::string& folder) {
  std::vector<std::string> files;
  const auto draw = [&](const std::string& name, const char* file, auto&& plan_of) {
    const record::SensorTypeInfo* type = find_sensor_type(recording.info, name);
    if (type == nullptr) return;
    const std::vector<Channel> channels = channels_of(recording, *type);
    if (channels.empty()) return;
    files.push_back(folder + "/" + file);
    viz::draw_series(plan_of(channels, record::element_width(*type)), files.back());
  };
  draw("laneedge", "lane_edge.png", [&](const auto& channels, std::size_t) { return lane_edges(recording, channels); });
  draw("magnetometer", "magnetometer.png",
       [&](const auto& channels, std::size_t width) { return fields(recording, channels, width); });
  return files;
}

}  // namespace sf::apps
