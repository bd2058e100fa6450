#include "netio/ports.h"

#include <algorithm>
#include <vector>

#include "base/error.h"

namespace sf::netio {

namespace {

constexpr std::uint64_t kLastPort = 65535;

struct AssignedPort {
  std::uint64_t port = 0;
  std::size_t use = 0;
  std::uint32_t sensor = 0;
};

std::string describe(const SensorPorts& use, std::uint32_t sensor) {
  const std::string name = use.name.empty() ? "robot" : "robot '" + use.name + "'";
  return name + " (id " + std::to_string(use.robot) + ") " + use.type + " " + std::to_string(sensor);
}

std::string describe(const PortRule& rule) {
  return "base " + std::to_string(rule.base) + " + id * " + std::to_string(rule.stride) + " + sensor";
}

[[noreturn]] void refuse_range(const SensorPorts& use, std::uint32_t sensor) {
  throw base::InputError(describe(use, sensor) + " needs port " + std::to_string(port(use.rule, use.robot, sensor)) +
                         " (" + describe(use.rule) +
                         "), but ports are 1 to 65535 and ids at most 65535: use a lower base port, or lower ids");
}

/// Returns the name of the base port for messages: its option, if known.
std::string base_of(const SensorPorts& use) { return use.option.empty() ? "the base port of " + use.type : use.option; }

std::string advice_for(const SensorPorts& a, const SensorPorts& b) {
  const bool same_type = a.type == b.type, same_base = a.rule.base == b.rule.base;
  if (a.robot == b.robot && same_type && same_base) return "give each robot its own id";
  if (!same_type && same_base) return "change " + base_of(a) + " or " + base_of(b) + ", so that each type has its own";
  if (!same_type) return "move " + base_of(a) + " and " + base_of(b) + " apart";
  return "raise the stride to at least " + std::to_string(std::max(a.sensors, b.sensors));
}

[[noreturn]] void refuse_shared(const SensorPorts& a, std::uint32_t sensor_a, const SensorPorts& b,
                                std::uint32_t sensor_b) {
  throw base::InputError(describe(a, sensor_a) + " and " + describe(b, sensor_b) + " share port " +
                         std::to_string(port(a.rule, a.robot, sensor_a)) + " (" + describe(a.rule) +
                         "): " + advice_for(a, b));
}

/// Checks that the ports are distinct and valid with this stride; `ports` is scratch memory.
bool fits(std::span<const SensorPorts> uses, std::uint32_t stride, std::vector<std::uint64_t>& ports) {
  ports.clear();
  for (const SensorPorts& use : uses) {
    const PortRule rule{use.rule.base, stride};
    for (std::uint32_t i = 0; i < use.sensors; ++i) ports.push_back(port(rule, use.robot, use.first + i));
  }
  std::sort(ports.begin(), ports.end());
  return std::adjacent_find(ports.begin(), ports.end()) == ports.end() && (ports.empty() || ports.back() <= kLastPort);
}

}  // namespace

std::uint32_t smallest_stride(std::span<const SensorPorts> uses, std::uint32_t usual) {
  std::vector<std::uint64_t> ports;
  if (fits(uses, usual, ports)) return usual;
  std::uint64_t last_id = 0;
  for (const SensorPorts& use : uses) last_id = std::max<std::uint64_t>(last_id, use.robot);
  for (std::uint32_t stride = 1; stride * last_id <= kLastPort && stride <= kLastPort; ++stride)
    if (fits(uses, stride, ports)) return stride;
  return usual;
}

void require_ports(std::span<const SensorPorts> uses) {
  std::vector<AssignedPort> assigned;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    for (std::uint32_t sensor = uses[i].first; sensor - uses[i].first < uses[i].sensors; ++sensor) {
      const std::uint64_t at = port(uses[i].rule, uses[i].robot, sensor);
      if (at == 0 || at > kLastPort || uses[i].robot > kLastPort) refuse_range(uses[i], sensor);
      assigned.push_back({at, i, sensor});
    }
  }

  std::stable_sort(assigned.begin(), assigned.end(),
                   [](const AssignedPort& a, const AssignedPort& b) { return a.port < b.port; });
  for (std::size_t i = 1; i < assigned.size(); ++i) {
    if (assigned[i].port != assigned[i - 1].port) continue;
    refuse_shared(uses[assigned[i - 1].use], assigned[i - 1].sensor, uses[assigned[i].use], assigned[i].sensor);
  }
}

}  // namespace sf::netio
