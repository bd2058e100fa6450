#include "sensors/derived/own_derived.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

#include "base/error.h"
#include "sensors/derived/derived_type.h"
#include "sensors/derived/public_types.h"
#include "sensors/own_sensors.h"
#include "sensors/plain_packets.h"

namespace sf::sensors {

namespace {

/// An added type. Views in its tables refer to its own strings.
struct AddedDerived {
  sensorfarm::DerivedEntry entry;
  std::deque<std::vector<std::string_view>> port_columns;
  std::vector<DerivedPort> ports;
  std::vector<std::string_view> keys;
  std::deque<std::string> names;
  std::vector<Column> columns;
  std::vector<PlainNumber> numbers;
  PlainForm packets;
  DerivedForm derived;
  SensorType type;
};

/// Added types by id, at a fixed address for the rest of the program.
std::array<std::unique_ptr<AddedDerived>, kLastOwnId + 1> added_derived;

/// The functions of SensorType and DerivedForm are plain pointers, so each id has its own set.
template <std::uint8_t kId>
void set_functions(AddedDerived& added) {
  added.derived.make = [](const DerivedContext& context) {
    return added_derived[kId]->entry.make(context.site, PublicSensorSettings(context.settings));
  };
  SensorType& type = added.type;
  type.parse = [](const world::World& world) {
    const AddedDerived& own = *added_derived[kId];
    return parse_derived(world, own.type, own.entry.rows, own.entry.rate);
  };
  type.make = no_backend;
  type.wire_problem = [](const SensorSpec& sensor, WireFormat wire) {
    return plain_wire_problem(added_derived[kId]->packets, sensor, wire);
  };
  type.parts = [](const SensorSpec&, WireFormat) -> std::uint32_t { return 1; };
  type.encode = [](const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat, std::uint32_t,
                   base::Bytes& out) { return encode_plain(added_derived[kId]->packets, sensor, reading, out); };
  type.decode = [](const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t packet,
                   WireFormat wire) {
    return decode_plain(added_derived[kId]->packets, sensor, payload, packet, wire);
  };
  type.read = [](const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t, WireFormat,
                 std::span<double> values) { read_plain(added_derived[kId]->packets, sensor, payload, values); };
}

template <std::size_t... kIds>
void set_functions(std::uint8_t id, AddedDerived& added, std::index_sequence<kIds...>) {
  ((id == kFirstOwnId + kIds ? set_functions<kFirstOwnId + kIds>(added) : void()), ...);
}

void add_column(AddedDerived& added, std::string name, const PlainNumber& number, bool whole = false) {
  added.columns.push_back({added.names.emplace_back(std::move(name)), 1, whole});
  added.numbers.push_back(number);
}

/// The quantities, `valid`, and the covariance.
void add_columns(AddedDerived& added) {
  const auto& quantities = added.entry.columns;
  for (const sensorfarm::SensorColumn& column : quantities) add_column(added, column.name, {column.unit});
  add_column(added, "valid", {1.0, 0.0, 1.0}, true);
  for (std::size_t i = 0; added.entry.covariance && i < quantities.size(); ++i)
    for (std::size_t j = i; j < quantities.size(); ++j)
      add_column(added, fmt::format("cov_{}_{}", quantities[i].name, quantities[j].name), {.real = true});
}

void add_ports(AddedDerived& added) {
  for (const sensorfarm::InputPort& port : added.entry.ports) {
    auto& columns = added.port_columns.emplace_back(port.columns.begin(), port.columns.end());
    added.ports.push_back({port.name, columns, port.least, port.most});
  }
}

}  // namespace

void add_own_derived(sensorfarm::DerivedEntry entry, const std::string& from) {
  check_own_type({entry.name, entry.id, entry.columns, entry.rate, static_cast<bool>(entry.make)}, from);
  if (entry.ports.empty())
    throw base::InputError(from, 0, fmt::format("derived sensor type '{}' has no port for inputs", entry.name));
  const std::uint8_t id = entry.id;
  auto made = std::make_unique<AddedDerived>();
  AddedDerived& added = *made;
  added.entry = std::move(entry);
  added.entry.rows = std::clamp(added.entry.rows, 1u, 1u << 20);
  added.keys.assign(std::begin(kDerivedKeys), std::end(kDerivedKeys));
  for (const std::string& key : added.entry.keys) added.keys.emplace_back(key);
  add_columns(added);
  add_ports(added);
  added.packets = {id, added.entry.name, added.numbers};
  added.derived.ports = added.ports;
  added.derived.quantities = static_cast<std::uint32_t>(added.entry.columns.size());
  added.derived.covariance = added.entry.covariance;
  set_functions(id, added, std::make_index_sequence<kLastOwnId - kFirstOwnId + 1>());
  added.type.id = id;
  added.type.name = added.entry.name;
  added.type.word = {added.entry.name, added.keys, {}, true};
  added.type.base_port = 20000 + 1000u * id;
  added.type.list = added.entry.rows > 1 ? "rows" : "";
  added.type.columns = added.columns;
  added.type.derived = &added.derived;
  added_derived[id] = std::move(made);
  add_sensor_type(&added.type);
}

}  // namespace sf::sensors
