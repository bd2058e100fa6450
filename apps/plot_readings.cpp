#include "apps/plot_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/csv_text.h"
#include "apps/text.h"
#include "record/reading_messages.h"
#include "scenarios/experiment.h"
#include "sensors/occupancy.h"
#include "viz/series_figure.h"

namespace sf::apps {

namespace {

constexpr double kPlottedGauss = 1e4;          ///< per tesla
constexpr std::size_t kMostMagnetometers = 4;  ///< panels of their own
constexpr std::size_t kMostPanels = 16;
constexpr std::size_t kMostCurves = 32;  ///< in a panel, where a sensor has fewer

/// Readings of one sensor, in order of time.
struct Channel {
  std::string name;  ///< its robot's; with the sensor's where the robot has several
  std::vector<const record::ReadingSample*> readings;
};

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

/// "left counts" as "left [counts]", "x_m" as "x [m]".
std::string axis_name(const std::string& column) {
  constexpr std::pair<std::string_view, std::string_view> kUnitsOfEndings[] = {
      {"_rad_s", "rad/s"},   {"_m_s2", "m/s^2"}, {"_m_s", "m/s"}, {"_deg", "deg"}, {"_rad", "rad"},
      {"_counts", "counts"}, {"_m", "m"},        {"_s", "s"},     {"_T", "T"},     {"_V", "V"}};
  std::string name = column;
  std::string unit;
  for (const auto& [ending, text] : kUnitsOfEndings) {
    if (!column.ends_with(ending)) continue;
    name.resize(column.size() - ending.size());
    unit = fmt::format(" [{}]", text);
    break;
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + unit;
}

/// "robot1", "robot1 3 x": the element of a list, and the part of a vector.
std::string part_name(const Channel& channel, std::size_t element, std::size_t elements, std::uint32_t part,
                      std::uint32_t width) {
  std::string name = channel.name;
  if (elements > 1) name += fmt::format(" {}", element);
  if (width > 1) name += width <= 3 ? fmt::format(" {}", "xyz"[part]) : fmt::format(" {}", part);
  return name;
}

/// Any sensor type: a panel per column, a curve per sensor, element and part of a vector.
viz::SeriesOptions columns_of(const record::Recording& recording, const record::SensorTypeInfo& type,
                              const std::vector<Channel>& channels, std::size_t width) {
  viz::SeriesOptions figure{"Readings of " + type.name, "", {}};
  std::size_t drawn = 0, offset = 0;
  for (const record::ColumnInfo& column : type.columns) {
    if (figure.panels.size() == kMostPanels) break;
    viz::Panel panel{"", axis_name(column.name), {}};
    drawn = 0;
    for (const Channel& channel : channels) {
      const std::size_t elements = std::max<std::size_t>(1, channel.readings.front()->values.size() / width);
      if (drawn > 0 && panel.series.size() + elements * column.width > kMostCurves) break;
      for (std::size_t e = 0; e < elements; ++e)
        for (std::uint32_t k = 0; k < column.width; ++k)
          panel.series.push_back(series_of(part_name(channel, e, elements, k, column.width), channel,
                                           [at = e * width + offset + k](const record::ReadingSample& r) {
                                             return at < r.values.size() ? r.values[at] : NAN;
                                           }));
      ++drawn;
    }
    offset += column.width;
    figure.panels.push_back(std::move(panel));
  }
  figure.subtitle = fmt::format("{}: {}", recording.info.world, counted(channels.size(), "sensor"));
  if (drawn < channels.size()) figure.subtitle += fmt::format(", the first {} shown", drawn);
  return figure;
}

std::string csv_of(const viz::SeriesOptions& figure) {
  std::string text = "panel,curve,time_s,value\n";
  for (const viz::Panel& panel : figure.panels) {
    const std::string name = csv_field(panel.title.empty() ? panel.y_name : panel.title + ": " + panel.y_name);
    for (const viz::Series& series : panel.series)
      for (std::size_t i = 0; i < series.times.size(); ++i)
        text += fmt::format("{},{},{},{}\n", name, csv_field(series.name), csv_number(series.times[i]),
                            csv_number(series.values[i]));
  }
  return text;
}

}  // namespace

std::vector<std::string> draw_readings(const record::Recording& recording, const PlotOptions& options,
                                       const std::string& folder) {
  std::vector<std::string> files;
  for (const record::SensorTypeInfo& type : recording.info.sensor_types) {
    // Scans and maps have figures of their own.
    const std::vector<Channel> channels = channels_of(recording, type);
    if (channels.empty() || type.is_scan || type.id == sensors::kOccupancy) continue;
    const std::size_t width = record::element_width(type);
    const viz::SeriesOptions figure = type.name == "laneedge"       ? lane_edges(recording, channels)
                                      : type.name == "magnetometer" ? fields(recording, channels, width)
                                                                    : columns_of(recording, type, channels, width);
    const std::string path = folder + "/" + (type.name == "laneedge" ? "lane_edge" : type.name) + ".";
    files.push_back(path + options.format);
    viz::draw_series(figure, files.back(), options.page);
    if (!options.csv) continue;
    files.push_back(path + "csv");
    scenarios::write_text(files.back(), csv_of(figure));
  }
  return files;
}

}  // namespace sf::apps
