#include "apps/stream_layout.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "apps/option_parsers.h"
#include "base/error.h"

namespace sf::apps {

namespace {

constexpr std::uint32_t kUsualStride = 8;
constexpr std::size_t kMostLines = 20;  ///< about sensors that are left out

std::string port_option(const sensors::SensorType& kind) { return "--" + std::string(kind.name) + "-port"; }

/// One line for each sensor that the wire cannot carry.
std::vector<std::string> left_out(const world::World& world, const sensors::SensorSet& sensor_set,
                                  const StreamLayout& plan) {
  std::vector<std::string> lines;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows)
      if (const std::string why = group.kind->wire_problem(row, plan.wire); !why.empty())
        lines.push_back(world.movers[row.mover].name + "." + row.name + ": " + why);
  return lines;
}

void require_some(const sensors::SensorSet& sensor_set, const std::vector<std::string>& lines,
                  const StreamLayout& plan) {
  if (lines.empty() || (plan.wire == sensors::WireFormat::thesis && lines.size() < sensor_set.count())) {
    for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i)
      std::fprintf(stderr, "sensorfarm: left out: %s\n", lines[i].c_str());
    if (lines.size() > kMostLines)
      std::fprintf(stderr, "sensorfarm: left out: %zu more sensors\n", lines.size() - kMostLines);
    return;
  }
  throw base::InputError(lines.front());
}

std::vector<netio::SensorPorts> uses_of(const world::World& world, const sensors::SensorSet& sensor_set,
                                        const StreamLayout& plan) {
  std::vector<netio::SensorPorts> uses;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
      const auto rows = sensor_set.of(group.kind->id, m);
      if (rows.empty()) continue;
      uses.push_back({world.movers[m].id, static_cast<std::uint32_t>(rows.size()), plan.ports(*group.kind),
                      world.movers[m].name, 0, std::string(group.kind->name), port_option(*group.kind)});
    }
  return uses;
}

}  // namespace

bool StreamLayout::sends_any(const sensors::SensorSet::Group& group) const {
  return std::any_of(group.rows.begin(), group.rows.end(),
                     [&](const sensors::SensorSpec& row) { return sends(*group.kind, row); });
}

StreamLayout stream_layout(const world::World& world, const sensors::SensorSet& sensor_set, const Options& options) {
  StreamLayout plan{options.base_ports, options.ports_per_robot, options.wire};
  const bool chosen = plan.stride != 0;
  if (!chosen) plan.stride = netio::smallest_stride(uses_of(world, sensor_set, plan), kUsualStride);
  require_some(sensor_set, left_out(world, sensor_set, plan), plan);
  std::string bases;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    bases += (bases.empty() ? "" : ", ") + port_option(*group.kind);
  try {
    netio::require_ports(uses_of(world, sensor_set, plan));
  } catch (const base::InputError& error) {
    throw base::InputError(std::string(error.what()) + " (base: " + bases + "; stride: --ports-per-robot)");
  }
  if (!chosen && plan.stride != kUsualStride)
    std::fprintf(stderr, "sensorfarm: %s per robot, the least that keeps this world's sensors apart\n",
                 counted(plan.stride, "port").c_str());
  return plan;
}

}  // namespace sf::apps
