// `explain`: prints which structures the farm builds for a world, what it does with them, and their cost on this
// machine.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "apps/commands/commands.h"
#include "apps/options/default_robot.h"
#include "apps/options/open_device.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "scenarios/explanation.h"
#include "sensors/derived/wiring.h"
#include "viz/wiring_figure.h"

namespace sf::apps {

namespace {

std::string bytes_text(std::size_t bytes) {
  if (bytes >= 1u << 20) return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
  return bytes >= 1u << 10 ? fmt::format("{:.1f} KiB", static_cast<double>(bytes) / (1 << 10))
                           : fmt::format("{} B", bytes);
}

std::string rates_of(const scenarios::SensorTypeCost& k) {
  return k.least_rate == k.most_rate ? fmt::format("{:g} Hz", k.most_rate)
                                     : fmt::format("{:g} to {:g} Hz", k.least_rate, k.most_rate);
}

std::string work_of(const scenarios::SensorTypeCost& k, double ticks) {
  const auto each = [&](std::uint64_t count) { return static_cast<double>(count) / ticks; };
  std::string text = fmt::format("{:.4g} readings", k.readings);
  if (k.reused > 0.0) text += fmt::format(", {:.4g} of them reused because nothing moved", k.reused);
  if (k.work.rays > 0)
    text += fmt::format(", {:.4g} rays, {:.3g} lists rebuilt", each(k.work.rays), each(k.work.cells_built));
  if (k.work.uncertain > 0)
    text += fmt::format(", {:.2g} % of beams tested in 64 bits against all surfaces",
                        100.0 * static_cast<double>(k.work.uncertain) / static_cast<double>(k.work.rays));
  if (k.work.movers_in_range > 0)
    text += fmt::format(
        ", {:.4g} movers nearby, {:.0f} % of them hidden or out of view", each(k.work.movers_in_range),
        100.0 - 100.0 * static_cast<double>(k.work.movers_visible) / static_cast<double>(k.work.movers_in_range));
  if (k.work.host_scans > 0) text += fmt::format(", {:.4g} scans cast on the host", each(k.work.host_scans));
  if (k.work.dipoles > 0) text += fmt::format(", {:.4g} magnets summed", each(k.work.dipoles));
  return text;
}

std::string costs_of(const scenarios::SensorTypeCost& k, const scenarios::Explanation& e) {
  std::string text =
      fmt::format("{}: {} on {}, {}\n", k.type, counted(k.sensors, "sensor"), counted(k.robots, "robot"), rates_of(k));
  text += row("per tick", "{:.3f} ms subscribed {}, {:.3f} ms more than without subscribers", 1e3 * k.tick,
              !k.inputs.empty()  ? fmt::format("alone, which measures its inputs ({})", fmt::join(k.inputs, ", "))
              : k.source.empty() ? "alone"
                                 : fmt::format("with the {}s", k.source),
              1e3 * (k.tick - e.silent));
  text += row("", work_of(k, static_cast<double>(e.ticks)));
  std::string_view label = "accuracy";
  for (const sensors::AccuracyStatement& s : e.statements)
    if (s.type->name == k.type) text += row(std::exchange(label, ""), apps::accuracy_statement_text(s));
  text +=
      row("kernels", k.kernels.empty() ? "none: computed on the host" : fmt::format("{}", fmt::join(k.kernels, ", ")));
  if (k.tables.empty()) return text;
  std::string tables;
  for (const gpu::DeviceAllocation& h : k.tables)
    tables += fmt::format("{}{} {}", tables.empty() ? "" : ", ", h.name, bytes_text(h.bytes));
  return text + row("tables", "{}: {}", bytes_text(k.bytes), tables);
}

}  // namespace

std::string explanation_text(const scenarios::Explanation& e) {
  std::string text;
  for (const scenarios::SensorTypeCost& cost : e.types) text += costs_of(cost, e);
  text += "together\n";
  text += row("per tick", "{:.3f} ms with all subscribed, {:.4f} ms without subscribers", 1e3 * e.all, 1e3 * e.silent);
  text += row("caster", e.caster);
  text += row("start-up", "{:.0f} ms to build, {:.0f} ms the first tick", 1e3 * e.build, 1e3 * e.first);
  if (e.resident > 0)
    text += row("memory", bytes_text(e.resident) + " resident, including the driver and this measurement");
  for (const scenarios::WallSlice& s : e.slices)
    text += row("slice", "z = {:g} m: {} of {} wall segments can be hit by {}", s.z, s.walls, e.walls,
                counted(s.sensors, "laser"));
  if (!e.absent.empty()) text += row("not built", "{}: none in the world", fmt::join(e.absent, ", "));
  return text;
}

/// The graph of the first kMostBoxes sensors that are derived or inputs.
int draw_graph(const world::World& world, const ExplainOptions& options) {
  constexpr std::size_t kMostBoxes = 100;
  const sensors::SensorSet sensor_set(world);
  const auto nodes = sensors::wire(world, sensor_set);
  if (nodes.empty()) throw base::InputError(options.world, 0, "has no derived sensor; see docs/derived.md");
  using Key = std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>;
  std::map<Key, std::size_t> box_of;
  std::vector<viz::WiringBox> boxes;
  const auto add = [&](const Key& key, std::uint32_t column) {
    const auto [type, mover, number] = key;
    const auto [place, is_new] = box_of.try_emplace(key, boxes.size());
    const sensors::SensorType& form = sensors::input_type(type);
    const sensors::SensorSpec spec = sensors::is_received(type) ? sensors::SensorSpec{.name = std::string(form.name)}
                                                                : sensor_set.of(type, mover)[number];
    if (is_new)
      boxes.push_back({fmt::format("{} '{}' of {}", form.name, spec.name, world.movers[mover].name),
                       fmt::format("{:g} Hz, {}", spec.rate, form.columns[0].name),
                       column,
                       {}});
    return place->second;
  };
  std::vector<const sensors::DerivedNode*> in_order;
  for (const sensors::DerivedNode& node : nodes) in_order.push_back(&node);
  std::ranges::stable_sort(in_order, {}, &sensors::DerivedNode::level);
  std::size_t left_out = 0;
  for (const sensors::DerivedNode* node : in_order) {
    if (boxes.size() + node->inputs.size() >= kMostBoxes) {
      ++left_out;
      continue;
    }
    std::vector<std::size_t> inputs;
    for (const sensors::WiredInput& input : node->inputs) {
      const Key key{input.type, input.mover, input.sensor};
      const bool is_derived = sensors::input_type(input.type).derived != nullptr;
      if (!is_derived || box_of.contains(key)) inputs.push_back(add(key, 0));
    }
    boxes[add({node->type->id, node->spec.mover, node->spec.sensor}, node->level + 1)].inputs = inputs;
  }
  const std::string more = left_out > 0 ? fmt::format("; {} more are not drawn", left_out) : "";
  viz::draw_wiring(boxes, fmt::format("{}: {}{}", options.world, counted(nodes.size(), "derived sensor"), more),
                   options.graph, {});
  print(row("graph", "{}{}", options.graph, more));
  return 0;
}

int explain(const ExplainOptions& options) {
  const world::World world = load_with_robots(options, options);
  if (!options.graph.empty()) return draw_graph(world, options);
  gpu::Device device = open_device(options);
  scenarios::Explanation explanation;
  {
    Progress progress("measuring");
    explanation =
        scenarios::explain(world, device, options.seed, options.threads, [&](double part) { progress.show(part); });
  }
  print(options.json ? with_warnings(explanation_json(explanation), world.warnings) : explanation_text(explanation));
  return 0;
}

}  // namespace sf::apps
