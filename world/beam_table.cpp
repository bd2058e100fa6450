#include "world/beam_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/files.h"
#include "base/number_text.h"

namespace sf::world {

namespace {

constexpr double kDegree = M_PI / 180.0;

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

BeamDirection row_of(const TableColumns& columns, const TableReader& reader) {
  BeamDirection row;
  row.azimuth = kDegree * reader.number(*columns.azimuth, -360.0, 360.0);
  row.elevation = columns.elevation ? kDegree * reader.number(*columns.elevation, -90.0, 90.0)
                                    : kDegree * (90.0 - reader.number(*columns.zenith, 0.0, 180.0));
  if (columns.time) row.time = reader.number(*columns.time, 0.0, kLongestTable);
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
    if (table.rows.size() == kMostTableBeams)
      throw base::InputError(file, line, fmt::format("has more than {} beams", kMostTableBeams));
    table.rows.push_back(row_of(*columns, TableReader(file, line, fields)));
  }
  if (table.rows.empty())
    throw base::InputError(file, 0,
                           "has no beams; expected a heading and one line per beam, such as "
                           "\"azimuth_deg,elevation_deg,time_s\"");
  return table;
}

const BeamTable* find_beam_table(const World& world, const Setting& setting) {
  const auto found = std::ranges::find_if(world.beam_tables, [&](const BeamTable& table) {
    return table.world_file == setting.file && table.name == setting.text;
  });
  return found == world.beam_tables.end() ? nullptr : &*found;
}

void add_beam_table(World& world, const Setting& setting) {
  if (find_beam_table(world, setting) != nullptr) return;
  const std::string path = (std::filesystem::path(setting.file).parent_path() / setting.text).string();
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw base::InputError(setting.file, setting.line, fmt::format("no such file: '{}'", path));
  BeamTable table = parse_beam_table(path, base::read_text(path));
  table.world_file = setting.file, table.name = setting.text;
  world.beam_tables.push_back(std::move(table));
}

}  // namespace sf::world
