#include "sensors/own_sensors.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <utility>

#include "base/error.h"
#include "base/files.h"
#include "sensors/own_backend.h"
#include "sensors/plain_packets.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kSpirvMagic = 0x07230203u;
constexpr std::size_t kMostSpirv = 16u << 20;  // [bytes]

/// An added type with the layout of its packets.
struct Added : OwnType {
  std::vector<PlainNumber> numbers;
  PlainForm form;
};

/// Added types by id, at a fixed address for the rest of the program.
std::array<std::unique_ptr<Added>, kLastOwnId + 1> added;

/// The user's objects have a state, so each backend creates its own.
ParsedSensors parse_own_sensors(const world::World& world, const OwnType& type) {
  std::vector<SensorSpec> rows;
  for (const OwnSensor& each : own_sensors(world, type)) rows.push_back(each.spec);
  return {std::move(rows), {}};
}

/// The functions of SensorType are plain pointers, so each id has its own set.
template <std::uint8_t kId>
SensorType functions_of() {
  SensorType type;
  type.parse = [](const world::World& world) { return parse_own_sensors(world, *added[kId]); };
  type.make = [](const SensorContext& context, const ParsedSensors&) { return make_own_backend(context, *added[kId]); };
  type.wire_problem = [](const SensorSpec& sensor, WireFormat wire) {
    return plain_wire_problem(added[kId]->form, sensor, wire);
  };
  type.parts = [](const SensorSpec&, WireFormat) -> std::uint32_t { return 1; };
  type.encode = [](const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat, std::uint32_t,
                   base::Bytes& out) { return encode_plain(added[kId]->form, sensor, reading, out); };
  type.decode = [](const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t packet,
                   WireFormat wire) { return decode_plain(added[kId]->form, sensor, payload, packet, wire); };
  type.read = [](const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t, WireFormat,
                 std::span<double> values) { read_plain(added[kId]->form, sensor, payload, values); };
  return type;
}

template <std::size_t... kIds>
SensorType functions_of(std::uint8_t id, std::index_sequence<kIds...>) {
  SensorType type;
  ((id == kFirstOwnId + kIds ? (type = functions_of<kFirstOwnId + kIds>(), true) : false) || ...);
  return type;
}

bool is_word(std::string_view name) {
  return !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos &&
         (name[0] < '0' || name[0] > '9');
}

std::vector<std::uint32_t> read_kernel(const std::string& file) {
  const std::string bytes = base::read_bytes(file, kMostSpirv);
  std::vector<std::uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), 4 * words.size());
  if (bytes.size() % 4 != 0 || words.size() < 5 || words[0] != kSpirvMagic)
    throw base::InputError(file, 0, "is not a SPIR-V module: compile the kernel with glslangValidator -V");
  return words;
}

}  // namespace

void check_own_type(const OwnTypeFacts& facts, const std::string& from) {
  const auto refuse = [&](const std::string& why) { throw base::InputError(from, 0, why); };
  if (!is_word(facts.name))
    refuse(fmt::format("a sensor type cannot be called '{}': expected small letters, digits and _", facts.name));
  if (facts.id < kFirstOwnId || facts.id > kLastOwnId)
    refuse(fmt::format("sensor type '{}' has id {}; expected {} to {}", facts.name, facts.id, kFirstOwnId, kLastOwnId));
  for (const SensorType* type : sensor_types())
    if (type->id == facts.id || type->name == facts.name || type->word.type == facts.name ||
        type->other_word.type == facts.name)
      refuse(fmt::format("sensor type '{}' with id {}: '{}' with id {} already exists; choose another", facts.name,
                         facts.id, type->name, type->id));
  if (facts.columns.empty()) refuse(fmt::format("sensor type '{}' has no column", facts.name));
  for (const sensorfarm::SensorColumn& column : facts.columns)
    if (!is_word(column.name) || !(column.unit > 0.0))
      refuse(fmt::format("sensor type '{}': column '{}' with unit {}; expected a word and a unit above 0", facts.name,
                         column.name, column.unit));
  if (!(facts.rate > 0.0 && facts.rate <= 1e6))
    refuse(
        fmt::format("sensor type '{}' has a rate of {} Hz; expected more than 0, at most 1e6", facts.name, facts.rate));
  if (!facts.has_make) refuse(fmt::format("sensor type '{}' has no function that creates sensors", facts.name));
}

void add_own_sensor(sensorfarm::SensorEntry entry, const std::string& from) {
  check_own_type({entry.name, entry.id, entry.columns, entry.rate, static_cast<bool>(entry.make)}, from);
  const std::uint8_t id = entry.id;
  auto type = std::make_unique<Added>();
  type->entry = std::move(entry);
  if (!type->entry.kernel.empty())
    type->spirv = read_kernel((std::filesystem::path(from).parent_path() / type->entry.kernel).string());
  for (const std::string& key : type->entry.keys) type->keys.emplace_back(key);
  for (const sensorfarm::SensorColumn& column : type->entry.columns) {
    type->columns.push_back({column.name});
    type->numbers.push_back({column.unit});
  }
  type->form = {id, type->entry.name, type->numbers};
  type->type = functions_of(id, std::make_index_sequence<kLastOwnId - kFirstOwnId + 1>());
  type->type.id = id;
  type->type.name = type->entry.name;
  type->type.word = {type->entry.name, type->keys};
  type->type.base_port = 20000 + 1000u * id;
  type->type.list = "rows";
  type->type.columns = type->columns;
  added[id] = std::move(type);
  add_sensor_type(&added[id]->type);
}

}  // namespace sf::sensors
