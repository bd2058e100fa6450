#include "record/reading_messages.h"

#include <algorithm>
#include <cctype>

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

/// Returns whether a message can hold that many elements: a number takes at least four bytes.
bool fits(const SensorTypeInfo& sensor_type, std::size_t elements, std::size_t message) {
  return elements <= message && element_width(sensor_type) * elements <= message / 4;
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
                    std::span<const double> values, base::Bytes& out) {
  const std::size_t width = element_width(sensor_type);
  const bool whole = width > 0 && values.size() % width == 0;
  SF_CHECK(whole && (!sensor_type.list.empty() || values.size() == width),
           std::to_string(values.size()) + " values in a reading of type " + sensor_type.name);

  CdrWriter cdr(out);
  put_header(cdr, time, frame);
  const std::size_t elements = values.size() / width;
  std::size_t first = 0;
  for (const ColumnInfo& column : sensor_type.columns) {
    if (!sensor_type.list.empty()) cdr.put_count(elements * column.width);
    for (std::size_t i = 0; i < elements; ++i)
      for (std::size_t k = 0; k < column.width; ++k) put_number(cdr, column, values[width * i + first + k]);
    first += column.width;
  }
}

bool decode_reading(const SensorTypeInfo& sensor_type, std::span<const std::uint8_t> message, std::int64_t& time,
                    std::vector<double>& values) {
  CdrReader cdr(message);
  get_header(cdr, time);

  const std::size_t width = element_width(sensor_type);
  std::size_t elements = 1;  // with a list: the length of its first array
  std::size_t first = 0;
  for (const ColumnInfo& column : sensor_type.columns) {
    const std::size_t numbers = sensor_type.list.empty() ? column.width : cdr.get_count(sizeof(std::uint32_t));
    if (first == 0 && column.width > 0) elements = numbers / column.width;
    if (column.width == 0 || numbers != elements * column.width || !fits(sensor_type, elements, message.size()))
      return false;
    values.resize(elements * width);
    for (std::size_t i = 0; i < elements; ++i)
      for (std::size_t k = 0; k < column.width; ++k)
        values[width * i + first + k] = column.whole ? cdr.get<std::uint32_t>() : cdr.get<double>();
    first += column.width;
  }
  return first > 0 && cdr.good();
}

}  // namespace sf::record
