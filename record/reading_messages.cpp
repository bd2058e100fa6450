#include "record/reading_messages.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "record/cdr.h"
#include "record/ros_messages.h"
#include "record/schemas.h"

namespace sf::record {

namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::string field_of(const SensorTypeInfo& sensor_type, const ColumnInfo& column) {
  std::string name = column.name;
  std::transform(name.begin(), name.end(), name.begin(), lower);
  std::string type = column.whole ? "uint32" : "float64";
  if (!sensor_type.list.empty()) {
    type += "[]";
  } else if (column.width > 1) {
    type += "[" + std::to_string(column.width) + "]";
  }
  return type + " " + name + "\n";
}

std::uint32_t whole_number(double value) {
  return value > 0.0 ? static_cast<std::uint32_t>(std::min(value, 4294967295.0)) : 0u;  // NaN becomes 0
}

void put_number(CdrWriter& cdr, const ColumnInfo& column, double value) {
  if (column.whole) {
    cdr.put(whole_number(value));
  } else {
    cdr.put(value);
  }
}

/// Returns whether a message can hold that many numbers: each takes at least four bytes.
bool fits(std::size_t numbers, std::span<const std::uint8_t> message) { return numbers <= message.size() / 4; }

/// Orders numbers by elements instead of by columns.
/// @param widths numbers per element of each column
std::vector<double> by_elements(const std::vector<double>& columns, std::size_t elements,
                                const std::vector<std::size_t>& widths) {
  std::vector<double> values(columns.size());
  const std::size_t width = std::accumulate(widths.begin(), widths.end(), std::size_t{0});
  auto from = columns.begin();
  std::size_t first = 0;
  for (const std::size_t own : widths) {
    for (std::size_t i = 0; i < elements; ++i, from += static_cast<std::ptrdiff_t>(own))
      std::copy_n(from, own, values.begin() + static_cast<std::ptrdiff_t>(i * width + first));
    first += own;
  }
  return values;
}

}  // namespace

std::string type_of(const SensorTypeInfo& sensor_type) {
  if (sensor_type.is_scan) return std::string(kLaserScan);
  std::string name = sensor_type.name;
  if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return "sensorfarm_msgs/msg/" + name;
}

std::string schema_text(const SensorTypeInfo& sensor_type) {
  std::string fields = "std_msgs/Header header\n";
  for (const ColumnInfo& column : sensor_type.columns) fields += field_of(sensor_type, column);
  return with_dependencies(fields);
}

std::size_t element_width(const SensorTypeInfo& sensor_type) {
  std::size_t width = 0;
  for (const ColumnInfo& column : sensor_type.columns) width += column.width;
  return width;
}

void encode_reading(const SensorTypeInfo& sensor_type, std::int64_t time, std::string_view frame,
                    std::span<const double> values, base::Bytes& out, std::size_t width) {
  if (width == 0) width = element_width(sensor_type);
  const bool whole = width > 0 && values.size() % width == 0;
  SF_CHECK(whole && (!sensor_type.list.empty() || values.size() == width),
           std::to_string(values.size()) + " values in a reading of type " + sensor_type.name);

  CdrWriter cdr(out);
  put_header(cdr, time, frame);
  const std::size_t elements = values.size() / width;
  std::size_t first = 0;
  for (const ColumnInfo& column : sensor_type.columns) {
    const std::size_t rows = first < width ? elements : 0;
    if (!sensor_type.list.empty()) cdr.put_count(rows * column.width);
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t k = 0; k < column.width; ++k) put_number(cdr, column, values[width * i + first + k]);
    first += column.width;
  }
}

bool decode_reading(const SensorTypeInfo& sensor_type, std::span<const std::uint8_t> message, std::int64_t& time,
                    std::vector<double>& values, std::size_t* width_out) {
  CdrReader cdr(message);
  get_header(cdr, time);

  std::size_t elements = 1;  // with a list: the length of its first array
  std::size_t width = 0;     // of the columns so far
  bool complete = true;      // none of them is empty
  std::vector<double> columns;
  std::vector<std::size_t> widths;
  for (const ColumnInfo& column : sensor_type.columns) {
    const std::size_t numbers = sensor_type.list.empty() ? column.width : cdr.get_count(sizeof(std::uint32_t));
    if (width == 0 && column.width > 0) elements = numbers / column.width;
    const bool left_out = width > 0 && elements > 0 && numbers == 0;
    complete = complete && !left_out;
    if (left_out) continue;
    if (column.width == 0 || !complete || numbers != elements * column.width ||
        !fits(columns.size() + numbers, message))
      return false;
    for (std::size_t i = 0; i < numbers; ++i)
      columns.push_back(column.whole ? static_cast<double>(cdr.get<std::uint32_t>()) : cdr.get<double>());
    widths.push_back(column.width);
    width += column.width;
  }
  values = widths.size() > 1 ? by_elements(columns, elements, widths) : std::move(columns);
  if (width_out != nullptr) *width_out = width;
  return width > 0 && cdr.good();
}

}  // namespace sf::record
