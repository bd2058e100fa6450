#include "apps/commands/plot_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apps/options/reading_elements.h"
#include "apps/reports/csv_text.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "record/reading_messages.h"
#include "scenarios/experiment.h"
#include "sensors/occupancy.h"

namespace sf::apps {

namespace {

constexpr double kPlottedGauss = 1e4;          ///< per tesla
constexpr std::size_t kMostMagnetometers = 4;  ///< that get panels of their own
constexpr std::size_t kMostReadingPanels = 16;
constexpr std::size_t kMostCurves = 32;  ///< per panel, for sensors with few elements
constexpr std::size_t kNamedCurves = 7;  ///< sensors with more elements are drawn as heat maps
constexpr std::size_t kMostHeatMaps = 4;
constexpr std::size_t kMostRows = 240;  ///< of a heat map; with more elements, every second, third, ... is drawn

/// Readings of one sensor, sorted by time.
struct Channel {
  std::string name;  ///< robot's name, followed by the sensor's if the robot has several
  std::uint32_t mover = 0, sensor = 0;
  std::vector<const record::ReadingSample*> readings;
};

/// Every sensor of a type that has readings.
std::vector<Channel> channels_of(const record::Recording& recording, const record::SensorTypeInfo& type) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Channel> rows;
  for (const record::ReadingSample& reading : recording.readings)
    if (reading.type == type.id) rows[{reading.mover, reading.sensor}].readings.push_back(&reading);
  std::vector<Channel> channels;
  for (auto& [key, channel] : rows) {
    channel.name = recording.info.movers[key.first].name;
    if (rows.count({key.first, 1}) > 0) channel.name += fmt::format(" sensor {}", key.second);
    channel.mover = key.first;
    channel.sensor = key.second;
    channels.push_back(std::move(channel));
  }
  return channels;
}

/// Evaluates `value(reading)` for every reading.
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

/// Numbers per element of its readings.
std::size_t width_of(const Channel& channel) { return channel.readings.front()->width; }

std::size_t element_count(const Channel& channel) {
  return std::max<std::size_t>(1, channel.readings.front()->values.size() / width_of(channel));
}

std::size_t widest(const std::vector<Channel>& channels) {
  std::size_t most = 0;
  for (const Channel& channel : channels) most = std::max(most, width_of(channel));
  return most;
}

/// Returns the elements to draw for a sensor with `count` elements.
std::vector<std::size_t> chosen_elements(std::size_t count, const PlotOptions& options) {
  std::vector<std::size_t> chosen;
  for (std::size_t e = 0; e < count; ++e)
    if (options.elements.empty() ||
        std::find(options.elements.begin(), options.elements.end(), e) != options.elements.end())
      chosen.push_back(e);
  return chosen;
}

bool as_heat_map(std::size_t elements, const PlotOptions& options) {
  return elements > kNamedCurves && options.elements.empty() && !options.curves;
}

/// [s] Longest time for which a reading is shown until the next one: 1.5 times the usual interval.
double longest_hold(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < times.size(); ++i) intervals.push_back(times[i + 1] - times[i]);
  if (intervals.empty()) return HUGE_VAL;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return 1.5 * *middle + 1e-9;
}

/// One number per element: a column, or one component of a vector column.
struct ElementColumn {
  std::size_t offset = 0;  ///< index within the element
  std::string name;        ///< with its unit
  bool whole = false, range = false;
  double scale = 1.0;
};

viz::Panel heat_panel(const Channel& channel, const SensorElements& elements, const ElementColumn& column) {
  const std::size_t width = width_of(channel), count = element_count(channel),
                    every = (count + kMostRows - 1) / kMostRows;
  viz::HeatMap map{.value_name = column.name, .whole = column.whole};
  const bool has_bearings = elements.bearings.size() == count;
  map.elements = element_rows(elements, count, every);
  for (const std::size_t e : map.elements) {
    map.short_rows.push_back(bearing_name(elements, e));
    map.rows.push_back(has_bearings ? fmt::format("{} ({})", map.short_rows.back(), e) : map.short_rows.back());
  }
  for (const record::ReadingSample* reading : channel.readings) {
    map.times.push_back(1e-9 * static_cast<double>(reading->time));
    std::vector<double>& row = map.readings.emplace_back();
    for (const std::size_t e : map.elements) {
      const std::size_t at = e * width + column.offset;
      row.push_back(at < reading->values.size() ? column.scale * reading->values[at] : NAN);
    }
  }
  map.longest_hold = longest_hold(map.times);
  if (column.range) map.limit = elements.range_max;
  map.too_near = fmt::format("too near (< {:g} m)", elements.range_min);
  map.no_return =
      std::isfinite(elements.range_max) ? fmt::format("no return (≥ {:g} m)", elements.range_max) : "no return";
  const std::string part = every == 1 ? "" : fmt::format(", 1 of {}", every);
  map.short_name = (has_bearings ? "bearing" : "element") + part;
  return {channel.name, (has_bearings ? "bearing (element)" : "element") + part, {}, false, false, std::move(map)};
}

/// |B| of each element of one sensor.
viz::Panel fields_of(const Channel& channel, const PlotOptions& options) {
  const std::size_t width = width_of(channel), elements = element_count(channel);
  if (as_heat_map(elements, options)) return heat_panel(channel, {}, {0, "|B| [G]", false, false, kPlottedGauss});
  viz::Panel panel{channel.name, "|B| [G]", {}};
  for (const std::size_t e : chosen_elements(elements, options))
    panel.series.push_back(series_of(fmt::format("element {}", e), channel, [=](const record::ReadingSample& r) {
      return e * width < r.values.size() ? kPlottedGauss * r.values[e * width] : NAN;
    }));
  return panel;
}

/// A reading has |B| first, then the vector. Path followers steer by the difference between the magnitudes at the last
/// and the first element.
viz::SeriesOptions fields(const record::Recording& recording, const std::vector<Channel>& channels,
                          const PlotOptions& options) {
  viz::SeriesOptions figure{"Magnetic field", "", {}};
  // Signed, since a difference of magnitudes may be negative.
  viz::Panel difference{"last element minus first", "difference of |B| [G]", {}};
  const std::size_t drawn = std::min(channels.size(), kMostMagnetometers);
  for (std::size_t i = 0; i < drawn; ++i) {
    figure.panels.push_back(fields_of(channels[i], options));
    difference.series.push_back(series_of(channels[i].name, channels[i], [](const record::ReadingSample& r) {
      return r.values.size() > r.width ? kPlottedGauss * (r.values[r.values.size() - r.width] - r.values[0]) : NAN;
    }));
  }
  if (options.elements.empty()) figure.panels.push_back(std::move(difference));
  figure.subtitle = fmt::format("{}: {}", recording.info.world, counted(channels.size(), "sensor"));
  if (drawn < channels.size()) figure.subtitle += fmt::format(", the first {} shown", drawn);
  return figure;
}

/// "left counts" as "left [counts]", "x_m" as "x [m]".
std::string axis_name(const std::string& column) {
  constexpr std::pair<std::string_view, std::string_view> kUnitsOfEndings[] = {
      {"_rad_s", "rad/s"},   {"_m_s2", "m/s²"}, {"_m_s", "m/s"}, {"_deg", "deg"}, {"_rad", "rad"},
      {"_counts", "counts"}, {"_m", "m"},       {"_s", "s"},     {"_T", "T"},     {"_V", "V"}};
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

/// "robot1", "robot1 3 x": robot, element of a list, component of a vector.
std::string part_name(const Channel& channel, std::size_t element, std::size_t elements, std::uint32_t part,
                      std::uint32_t width) {
  std::string name = channel.name;
  if (elements > 1) name += fmt::format(" {}", element);
  if (width > 1) name += width <= 3 ? fmt::format(" {}", "xyz"[part]) : fmt::format(" {}", part);
  return name;
}

bool is_whole(const record::ColumnInfo& column) { return column.whole || column.name.ends_with("_counts"); }

/// @param panels number of panels for all columns of those sensors
std::string subtitle_of(const record::Recording& recording, std::size_t sensors, std::size_t drawn,
                        std::size_t panels) {
  std::string text = fmt::format("{}: {}", recording.info.world, counted(sensors, "sensor"));
  if (drawn < sensors) text += fmt::format(", the first {} shown", drawn);
  if (panels > kMostReadingPanels) text += fmt::format(", {} of {} quantities shown", kMostReadingPanels, panels);
  return text;
}

/// One panel per column and sensor, for the first few sensors.
viz::SeriesOptions heat_maps_of(const record::Recording& recording, const world::World& world,
                                const record::SensorTypeInfo& type, const std::vector<Channel>& channels) {
  viz::SeriesOptions figure{"Readings of " + type.name, "", {}};
  const std::size_t width = widest(channels);
  const sensors::SensorSet sensor_set(world);
  const std::size_t drawn =
      std::min({channels.size(), kMostHeatMaps, std::max<std::size_t>(1, kMostReadingPanels / width)});
  for (std::size_t i = 0; i < drawn; ++i) {
    const SensorElements elements = elements_of(sensor_set, type.id, channels[i].mover, channels[i].sensor);
    std::size_t offset = 0;
    for (const record::ColumnInfo& column : type.columns)
      for (std::uint32_t k = 0;
           k < column.width && offset < width_of(channels[i]) && figure.panels.size() < kMostReadingPanels; ++k)
        figure.panels.push_back(
            heat_panel(channels[i], elements,
                       {offset++, axis_name(column.name) + (column.width > 1 ? fmt::format(" {}", "xyz"[k % 3]) : ""),
                        is_whole(column), column.name == "range_m" || type.is_scan}));
  }
  figure.subtitle = subtitle_of(recording, channels.size(), drawn, drawn * width);
  return figure;
}

/// Handles any sensor type: one panel per column, one curve per sensor, element and vector component.
viz::SeriesOptions columns_of(const record::Recording& recording, const record::SensorTypeInfo& type,
                              const std::vector<Channel>& channels, const PlotOptions& options) {
  viz::SeriesOptions figure{"Readings of " + type.name, "", {}};
  std::size_t drawn = 0, offset = 0;
  for (const record::ColumnInfo& column : type.columns) {
    if (figure.panels.size() == kMostReadingPanels || offset >= widest(channels)) break;
    viz::Panel panel{"", axis_name(column.name), {}, false, is_whole(column)};
    drawn = 0;
    for (const Channel& channel : channels) {
      const std::size_t elements = element_count(channel), width = width_of(channel);
      const std::vector<std::size_t> chosen = chosen_elements(elements, options);
      if (drawn > 0 && panel.series.size() + chosen.size() * column.width > kMostCurves) break;
      for (const std::size_t e : chosen)
        for (std::uint32_t k = 0; k < column.width; ++k)
          panel.series.push_back(
              series_of(part_name(channel, e, elements, k, column.width), channel,
                        [at = offset < width ? e * width + offset + k : SIZE_MAX](const record::ReadingSample& r) {
                          return at < r.values.size() ? r.values[at] : NAN;
                        }));
      ++drawn;
    }
    offset += column.width;
    figure.panels.push_back(std::move(panel));
  }
  figure.subtitle = subtitle_of(recording, channels.size(), drawn, type.columns.size());
  return figure;
}

/// Returns nullopt if there is nothing to draw for the sensor type.
std::optional<viz::SeriesOptions> figure_of(const record::Recording& recording, const world::World& world,
                                            const record::SensorTypeInfo& type, const PlotOptions& options) {
  const std::vector<Channel> channels = channels_of(recording, type);
  if (channels.empty() || type.id == sensors::kOccupancy) return std::nullopt;  // maps have separate figures
  std::size_t most = 0;
  for (const Channel& channel : channels) most = std::max(most, element_count(channel));
  if (!options.elements.empty() && chosen_elements(most, options).empty()) return std::nullopt;
  if (type.name == "laneedge") return lane_edges(recording, channels);
  if (type.name == "magnetometer") return fields(recording, channels, options);
  if (as_heat_map(most, options)) return heat_maps_of(recording, world, type, channels);
  if (type.is_scan && options.elements.empty() && !options.curves)
    return std::nullopt;  // scans with few beams are drawn on the map
  return columns_of(recording, type, channels, options);
}

/// @throws base::InputError for an element that no recorded sensor has
void check_elements(const record::Recording& recording, const PlotOptions& options) {
  std::size_t most = 0;
  for (const record::SensorTypeInfo& type : recording.info.sensor_types)
    if (type.id != sensors::kOccupancy)
      for (const Channel& channel : channels_of(recording, type)) most = std::max(most, element_count(channel));
  for (const std::uint32_t element : options.elements)
    if (element >= most)
      throw base::InputError(
          recording.file, 0,
          most == 0
              ? "has no readings for --elements; record them with `run --record-readings`"
              : fmt::format("has no sensor with an element {}; elements are numbered from 0 to {}", element, most - 1));
}

}  // namespace

std::string csv_of(const viz::SeriesOptions& figure) {
  std::string text = "panel,curve,time_s,value\n";
  for (const viz::Panel& panel : figure.panels) {
    const std::string& y_name = panel.map ? panel.map->value_name : panel.y_name;
    const std::string name = csv_field(panel.title.empty() || panel.map ? y_name : panel.title + ": " + y_name);
    for (const viz::Series& series : panel.series)
      for (std::size_t i = 0; i < series.times.size(); ++i)
        text += fmt::format("{},{},{},{}\n", name, csv_field(series.name), csv_number(series.times[i]),
                            csv_number(series.values[i]));
    for (std::size_t row = 0; panel.map && row < panel.map->rows.size(); ++row) {
      const std::string curve = csv_field(fmt::format("{} {}", panel.title, panel.map->elements[row]));
      for (std::size_t i = 0; i < panel.map->times.size(); ++i)
        text += fmt::format("{},{},{},{}\n", name, curve, csv_number(panel.map->times[i]),
                            csv_number(panel.map->readings[i][row]));
    }
  }
  return text;
}

std::vector<std::string> draw_readings(const record::Recording& recording, const world::World& world,
                                       const PlotOptions& options, const std::string& folder) {
  if (!options.elements.empty()) check_elements(recording, options);
  std::vector<std::string> files;
  for (const record::SensorTypeInfo& type : recording.info.sensor_types) {
    const std::optional<viz::SeriesOptions> figure = figure_of(recording, world, type, options);
    if (!figure) continue;
    const std::string path = folder + "/" + (type.name == "laneedge" ? "lane_edge" : type.name) + ".";
    files.push_back(path + options.format);
    viz::draw_series(*figure, files.back(), options.page);
    if (!options.csv) continue;
    files.push_back(path + "csv");
    scenarios::write_text(files.back(), csv_of(*figure));
  }
  return files;
}

}  // namespace sf::apps
