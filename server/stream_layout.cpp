#include "server/stream_layout.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"

namespace sf::server {

namespace {

constexpr std::uint32_t kUsualStride = 8;
constexpr std::size_t kMostNotes = 20;  ///< about omitted sensors

std::string port_option(const sensors::SensorType& type) { return "--" + std::string(type.name) + "-port"; }

/// Returns one line for each sensor that the wire format cannot carry.
std::vector<std::string> left_out(const world::World& world, const sensors::SensorSet& sensor_set,
                                  const StreamLayout& layout) {
  std::vector<std::string> lines;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows)
      if (const std::string why = group.type->wire_problem(row, layout.wire); !why.empty())
        lines.push_back(world.movers[row.mover].name + "." + row.name + ": " + why);
  return lines;
}

/// Adds notes on omitted sensors.
/// @throws base::InputError if no sensor is sent, or if a sensor is omitted from the farm's own format
void note_left_out(const sensors::SensorSet& sensor_set, const std::vector<std::string>& lines, StreamLayout& layout) {
  if (lines.empty()) return;
  if (layout.wire != sensors::WireFormat::thesis || lines.size() >= sensor_set.count())
    throw base::InputError(lines.front());
  for (std::size_t i = 0; i < std::min(lines.size(), kMostNotes); ++i) layout.notes.push_back("left out: " + lines[i]);
  if (lines.size() > kMostNotes)
    layout.notes.push_back(fmt::format("left out: {} more sensors", lines.size() - kMostNotes));
}

std::vector<netio::SensorPorts> uses_of(const world::World& world, const sensors::SensorSet& sensor_set,
                                        const StreamLayout& layout) {
  std::vector<netio::SensorPorts> uses;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
      const auto rows = sensor_set.of(group.type->id, m);
      if (rows.empty()) continue;
      uses.push_back({world.movers[m].id, static_cast<std::uint32_t>(rows.size()), layout.ports(*group.type),
                      world.movers[m].name, 0, std::string(group.type->name), port_option(*group.type)});
    }
  return uses;
}

}  // namespace

bool StreamLayout::sends_any(const sensors::SensorSet::Group& group) const {
  return std::any_of(group.rows.begin(), group.rows.end(),
                     [&](const sensors::SensorSpec& row) { return sends(*group.type, row); });
}

StreamLayout stream_layout(const world::World& world, const sensors::SensorSet& sensor_set,
                           const LayoutOptions& options) {
  StreamLayout layout{options.base_ports, options.ports_per_robot, options.wire, {}};
  const bool chosen = layout.stride != 0;
  if (!chosen) layout.stride = netio::smallest_stride(uses_of(world, sensor_set, layout), kUsualStride);
  note_left_out(sensor_set, left_out(world, sensor_set, layout), layout);
  std::string bases;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    bases += (bases.empty() ? "" : ", ") + port_option(*group.type);
  try {
    netio::require_ports(uses_of(world, sensor_set, layout));
  } catch (const base::InputError& error) {
    throw base::InputError(std::string(error.what()) + " (base: " + bases + "; stride: --ports-per-robot)");
  }
  if (!chosen && layout.stride != kUsualStride)
    layout.notes.push_back(fmt::format("ports per robot: {}, the minimum for this world's sensors", layout.stride));
  return layout;
}

}  // namespace sf::server
