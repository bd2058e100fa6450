#include "sensors/beam_table.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/number_text.h"
#include "sensors/lidar.h"
#include "sensors/lidar_beams.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kLongestScan = 3600.0;  ///< [s]

/// Columns of a table, by their place in a line.
struct TableColumns {
  std::optional<std::size_t> azimuth, elevation, zenith, time;
};

std::vector<std::string_view> fields_of(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t end = line.find(',');
    std::string_view field = line.substr(0, end);
    while (field.starts_with(' ')) field.remove_prefix(1);
    while (field.ends_with(' ')) field.remove_suffix(1);
    fields.push_back(field);
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

/// "Azimuth/deg" becomes "azimuth_deg".
std::string heading_of(std::string_view field) {
  std::string name(field);
  for (char& c : name) c = c == '/' ? '_' : static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return name;
}

TableColumns columns_of(const std::string& file, int line, const std::vector<std::string_view>& headings) {
  TableColumns columns;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const std::string name = heading_of(headings[i]);
    if (name == "azimuth_deg") columns.azimuth = i;
    if (name == "elevation_deg") columns.elevation = i;
    if (name == "zenith_deg") columns.zenith = i;
    if (name == "time_s") columns.time = i;
  }
  if (columns.azimuth && columns.elevation.has_value() != columns.zenith.has_value()) return columns;
  throw base::InputError(
      file, line,
      fmt::format("the columns are '{}'; expected azimuth_deg and either elevation_deg or zenith_deg, "
                  "and time_s for rolling scans",
                  fmt::join(headings, ",")));
}

class TableReader {
 public:
  TableReader(const std::string& file, int line, const std::vector<std::string_view>& fields)
      : file_(file), line_(line), fields_(fields) {}

  double number(std::size_t column, double least, double most) const {
    if (column >= fields_.size()) fail(fmt::format("has {} fields; expected {}", fields_.size(), column + 1));
    const std::string_view text = fields_[column];
    const double value = base::number_of<double>(text).value_or(NAN);
    if (!(value >= least && value <= most))
      fail(fmt::format("'{}' in field {}; expected a number from {:g} to {:g}", text, column + 1, least, most));
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw base::InputError(file_, line_, message); }
  const std::string& file_;
  int line_;
  const std::vector<std::string_view>& fields_;
};

BeamTable::Row row_of(const TableColumns& columns, const TableReader& reader) {
  BeamTable::Row row;
  row.azimuth = kDegree * reader.number(*columns.azimuth, -360.0, 360.0);
  row.elevation = columns.elevation ? kDegree * reader.number(*columns.elevation, -90.0, 90.0)
                                    : kDegree * (90.0 - reader.number(*columns.zenith, 0.0, 180.0));
  if (columns.time) row.time = reader.number(*columns.time, 0.0, kLongestScan);
  return row;
}

}  // namespace

BeamTable parse_beam_table(const std::string& file, std::string_view text) {
  BeamTable table;
  std::optional<TableColumns> columns;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const std::vector<std::string_view> fields = fields_of(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (fields.size() == 1 && fields[0].empty()) continue;
    if (!columns) {
      columns = columns_of(file, line, fields);
      table.timed = columns->time.has_value();
      continue;
    }
    if (table.rows.size() == kMostLidarBeams)
      throw base::InputError(file, line, fmt::format("has more than {} beams", kMostLidarBeams));
    table.rows.push_back(row_of(*columns, TableReader(file, line, fields)));
  }
  if (table.rows.empty())
    throw base::InputError(file, 0,
                           "has no beams; expected a heading and one line per beam, such as "
                           "\"azimuth_deg,elevation_deg,time_s\"");
  return table;
}

std::string beam_table_path(const world::Sensor& sensor, const world::Setting& directions) {
  std::string path = (std::filesystem::path(directions.file).parent_path() / directions.text).string();
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) refuse(sensor, directions.key, fmt::format("no such file: '{}'", path));
  return path;
}

std::map<std::string, std::uint64_t> beam_table_hashes(const world::World& world) {
  std::map<std::string, std::uint64_t> hashes;
  for (const world::Mover& mover : world.movers)
    for (const world::Sensor& sensor : mover.sensors) {
      const auto named = std::ranges::find(sensor.settings, "directions", &world::Setting::key);
      if (sensor.type != lidar_type.name || named == sensor.settings.end()) continue;
      const auto [file, is_new] = hashes.try_emplace(beam_table_path(sensor, *named));
      if (!is_new) continue;
      const std::string text = base::read_text(file->first);
      file->second = base::hash_bytes(text.data(), text.size());
    }
  return hashes;
}

BeamTable read_beam_table(const std::string& file) { return parse_beam_table(file, base::read_text(file)); }

}  // namespace sf::sensors
