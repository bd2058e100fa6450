#include "scenarios/derive_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"
#include "sensors/sensor_type.h"
#include "world/append_robot.h"
#include "world/stage/build_world.h"
#include "world/toml_reader.h"

namespace sf::scenarios {

namespace {

using world::TomlNode;
using world::TomlReader;

constexpr std::array<std::string_view, 4> kFileKeys{"derived", "input", "origin", "clock"};
constexpr std::array<std::string_view, 6> kInputKeys{"robot", "as", "topic", "file", "time", "columns"};
constexpr std::size_t kMostFile = 4u << 20;  // [byte]

/// Returns a value as in world files, which have no escapes.
std::string world_value(const TomlReader& reader, const TomlNode& node) {
  switch (node.kind) {
    case TomlNode::Kind::flag:
      return node.flag ? "1" : "0";
    case TomlNode::Kind::number:
      if (!std::isfinite(node.number)) reader.fail(node, fmt::format("'{}' expects finite numbers", node.key));
      return fmt::format("{}", node.number);
    case TomlNode::Kind::text:
      if (std::ranges::any_of(node.text, [](unsigned char c) { return c < ' ' || c == '"' || c == '\\' || c > '~'; }))
        reader.fail(node, fmt::format("{} may not contain quotes or backslashes", world::shown_toml(node)));
      return '"' + node.text + '"';
    case TomlNode::Kind::list: {
      std::string values;
      for (const TomlNode& item : node.items) {
        if (item.kind == TomlNode::Kind::list) reader.fail(item, "a list in a list is no property of a sensor");
        values += (values.empty() ? "" : " ") + world_value(reader, item);
      }
      return '[' + values + ']';
    }
    default:
      reader.fail(node, fmt::format("'{}' expects a number, a text, or a list of one of them", node.key));
  }
}

/// @param own keys that are no properties of the sensor
SensorText sensor_text(const TomlReader& reader, const TomlNode& table, std::span<const std::string_view> own) {
  SensorText sensor{reader.text(table, "robot", ""), "", {}, table.line};
  if (sensor.robot.empty()) reader.fail(table, "expected robot = \"NAME\": the robot that has the sensor");
  for (const TomlNode& item : table.items) {
    if (std::ranges::find(own, item.key) != own.end()) continue;
    const auto is_usual = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '[' || c == ']'; };
    if (!std::ranges::all_of(item.key, is_usual)) reader.fail(item, "expected a property of a world file as the key");
    const bool numbered =
        item.kind == TomlNode::Kind::list && !item.items.empty() &&
        std::ranges::all_of(item.items, [](const TomlNode& in) { return in.kind == TomlNode::Kind::list; });
    if (!numbered) sensor.properties.emplace_back(item.key, world_value(reader, item));
    for (std::size_t k = 0; numbered && k < item.items.size(); ++k)  // link = [[...], [...]] is link[0], link[1]
      sensor.properties.emplace_back(fmt::format("{}[{}]", item.key, k), world_value(reader, item.items[k]));
  }
  return sensor;
}

SensorText derived_text(const TomlReader& reader, const TomlNode& table) {
  constexpr std::array<std::string_view, 1> kOwn{"robot"};
  SensorText sensor = sensor_text(reader, table, kOwn);
  sensor.word = "derived";
  for (const char* key : {"type", "name"})
    if (reader.text(table, key, "").empty()) reader.fail(table, fmt::format("expected {} = \"...\"", key));
  if (reader.text(table, "name", "").find('/') != std::string::npos)
    reader.fail(table, "a name may not contain '/': it is also that of a file");
  return sensor;
}

std::vector<std::pair<std::string, std::string>> columns_of(const TomlReader& reader, const TomlNode& table) {
  std::vector<std::pair<std::string, std::string>> columns;
  const TomlNode* const node = world::find(table, "columns");
  if (node == nullptr) return columns;
  const bool is_one = node->kind == TomlNode::Kind::list || node->kind == TomlNode::Kind::table;
  if (!is_one || node->items.empty())
    reader.fail(*node, "'columns' expects names [\"x_m\", ...], or { NAME = \"name in the source\", ... }");
  for (const TomlNode& item : node->items) {
    if (item.kind != TomlNode::Kind::text) reader.fail(item, "'columns' expects names in quotes");
    columns.emplace_back(item.key.empty() || node->kind == TomlNode::Kind::list ? item.text : item.key, item.text);
  }
  return columns;
}

ForeignInput foreign_input(const TomlReader& reader, const TomlNode& table) {
  ForeignInput input{sensor_text(reader, table, kInputKeys), reader.text(table, "topic", ""),
                     reader.text(table, "file", ""), reader.text(table, "time", "time_s"), columns_of(reader, table)};
  input.sensor.word = reader.text(table, "as", "");
  if (!world::is_robot_name(input.sensor.robot))
    reader.fail(table, fmt::format("robot \"{}\": {}", input.sensor.robot, world::kNameRule));
  if (!input.topic.empty() && !input.table.empty())
    reader.fail(table, "has a 'topic' and a 'file': expected one of them");
  if (input.topic.empty() && input.sensor.word.empty())
    reader.fail(table, "expected as = \"TYPE\": the sensor type of the table's rows, such as gyro, or a new word");
  return input;
}

std::string entity_of(const SensorText& sensor) {
  std::string text = sensor.word + "(";
  for (const auto& [key, value] : sensor.properties) text += fmt::format(" {} {}", key, value);
  return text + " )";
}

/// Reads the sensors with the reader of world files. Each is on its own line of the file, for messages.
std::vector<world::Sensor> read_sensors(const std::string& file, std::span<const SensorText> sensors) {
  if (sensors.empty()) return {};
  std::vector<const SensorText*> order;
  for (const SensorText& sensor : sensors) order.push_back(&sensor);
  std::ranges::stable_sort(order, {}, [](const SensorText* sensor) { return sensor->line; });
  std::string text;
  int line = 1;
  for (std::size_t k = 0; k < order.size(); ++k) {
    for (; line < order[k]->line; ++line) text += '\n';
    text += fmt::format("position( name \"{}\" pose [{} 0 0 0] {} ) ", k, k, entity_of(*order[k]));
  }
  world::World world = world::build_world(file, text, {.sensors = sensors::world_file_words()});
  for (const world::Warning& warning : world.warnings)
    if (warning.message.find("property") != std::string::npos)
      throw base::InputError(warning.file, warning.line, warning.message);
  std::vector<world::Sensor> read(sensors.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (world.movers.at(k).sensors.size() != 1)
      throw base::InputError(file, order[k]->line, fmt::format("'{}' is not a sensor type", order[k]->word));
    world::Sensor& sensor = read[static_cast<std::size_t>(order[k] - sensors.data())];
    sensor = std::move(world.movers[k].sensors[0]);
    // Models of one world have different names, but sensors of two robots may have the same one.
    if (const std::string name = order[k]->name(); !name.empty()) sensor.name = name;
  }
  return read;
}

std::vector<std::uint32_t> robots_of(const std::string& file, const SensorText& sensor, const world::World& world) {
  std::vector<std::uint32_t> rows;
  std::vector<std::string_view> names;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    if (world.movers[m].name == sensor.robot || (sensor.robot == "*" && !world.movers[m].is_tag)) rows.push_back(m);
    names.push_back(world.movers[m].name);
  }
  if (rows.empty())
    throw base::InputError(
        file, sensor.line,
        fmt::format("the recording has no robot '{}'{}", sensor.robot, base::expected_one_of(sensor.robot, names)));
  return rows;
}

}  // namespace

std::string SensorText::value(std::string_view key) const {
  const auto found = std::ranges::find(properties, key, &std::pair<std::string, std::string>::first);
  return found == properties.end() ? "" : found->second;
}

std::string SensorText::name() const {
  const std::string quoted = value("name");
  return quoted.size() < 2 ? "" : quoted.substr(1, quoted.size() - 2);
}

DeriveFile read_derive_file(const std::string& file) {
  const TomlNode root = world::parse_toml(file, base::read_text(file, kMostFile));
  const TomlReader reader(file);
  reader.require_known(root, kFileKeys);
  DeriveFile read{file, {}, {}, {}};
  for (const TomlNode* table : reader.tables(root, "derived")) read.derived.push_back(derived_text(reader, *table));
  for (const TomlNode* table : reader.tables(root, "input")) read.inputs.push_back(foreign_input(reader, *table));
  if (world::find(root, "origin") != nullptr) {
    std::array<double, 2> degrees{};
    reader.numbers(root, "origin", degrees, 180.0, "[latitude, longitude] in degrees");
    read.origin.emplace(degrees[0], degrees[1]);
  }
  constexpr std::array<std::string_view, 3> kClocks{"both", "stamp", "log"};
  const std::string clock = reader.text(root, "clock", "both");
  const auto found = std::ranges::find(kClocks, clock);
  if (found == kClocks.end())
    reader.fail(*world::find(root, "clock"),
                fmt::format("'clock' is \"{}\"{}", clock, base::expected_one_of(clock, kClocks)));
  read.clock = static_cast<ForeignClock>(found - kClocks.begin());
  return read;
}

std::vector<std::uint32_t> add_sensors(const std::string& file, std::span<const SensorText> sensors,
                                       world::World& world) {
  std::vector<std::uint32_t> rows;
  const std::vector<world::Sensor> read = read_sensors(file, sensors);
  for (std::size_t k = 0; k < read.size(); ++k)
    for (const std::uint32_t row : robots_of(file, sensors[k], world)) {
      std::vector<world::Sensor>& mounted = world.movers[row].sensors;
      if (std::ranges::any_of(mounted, [&](const world::Sensor& other) { return other.name == read[k].name; }))
        throw base::InputError(file, sensors[k].line,
                               fmt::format("'{}' already has a sensor called '{}': choose another name",
                                           world.movers[row].name, read[k].name));
      mounted.push_back(read[k]);
      rows.push_back(row);
    }
  world::update_extent_and_hash(world);
  return rows;
}

}  // namespace sf::scenarios
