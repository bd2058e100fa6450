#include "scenarios/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/error.h"
#include "scenarios/runner.h"

namespace sf::scenarios {

namespace {

using world::TomlNode;
using Rows = std::vector<std::size_t>;

/// Returns the item named by `part` in a table, or in a list by its name (robots) or its number from 0 (events).
/// Creates it if missing.
TomlNode& item_of(TomlNode& node, const std::string& part, bool robots) {
  for (TomlNode& item : node.items) {
    const TomlNode* const name = world::find(item, "name");
    if (node.kind == TomlNode::Kind::table ? item.key == part : name != nullptr && name->text == part) return item;
  }
  std::size_t row = 0;
  if (const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), row);
      node.kind == TomlNode::Kind::list && error == std::errc() && end == part.data() + part.size() &&
      row < node.items.size())
    return node.items[row];
  if (node.kind == TomlNode::Kind::list && !robots)
    throw base::InputError(fmt::format("'{}' has no item {}; expected its number, from 0 to {}", node.key, part,
                                       node.items.empty() ? 0 : node.items.size() - 1));
  TomlNode& item = node.items.emplace_back();
  if (node.kind == TomlNode::Kind::table) {
    item.key = part;
    if (part == "robot") item.kind = TomlNode::Kind::list;
  } else {
    TomlNode& name = item.items.emplace_back();
    name.kind = TomlNode::Kind::text;
    name.key = "name";
    name.text = part;
  }
  return item;
}

void set_value(TomlNode& root, const std::string& path, const TomlNode& value) {
  TomlNode* node = &root;
  for (std::size_t at = 0; at <= path.size();) {
    const std::size_t end = std::min(path.find('.', at), path.size());
    if (node->kind != TomlNode::Kind::table && node->kind != TomlNode::Kind::list)
      throw base::InputError(fmt::format("'{}' is a value and has no subkeys", node->key));
    node = &item_of(*node, path.substr(at, end - at), path.starts_with("robot."));
    at = end + 1;
  }
  const std::string key = node->key;
  *node = value;
  node->key = key;
  node->line = 0;
}

Scenario scenario_at(const Sweep& sweep, const Rows& rows, std::size_t parameters) {
  TomlNode root = sweep.settings;
  for (std::size_t i = 0; i < parameters; ++i)
    set_value(root, sweep.parameters[i].name, sweep.parameters[i].values[rows[i]]);
  return parse_scenario(sweep.scenario, root);
}

/// The warnings of a scenario, or its error.
struct TriedScenario {
  std::string error;
  std::vector<world::Warning> warnings;
};
TriedScenario try_scenario(const Sweep& sweep, const Rows& rows, std::size_t parameters) {
  try {
    return {"", check_scenario(scenario_at(sweep, rows, parameters))};
  } catch (const base::InputError& error) {
    return {error.what(), {}};
  }
}

[[noreturn]] void refuse_value(const Sweep& sweep, const Rows& rows, std::size_t parameter, const std::string& error) {
  const SweepParameter& p = sweep.parameters[parameter];
  throw base::InputError(sweep.file, p.line,
                         fmt::format("{} = {}: {}", p.name, parameter_value_text(p.values[rows[parameter]]), error));
}

/// Returns the minimum and maximum of numbers, and all other values, except for the first.
Rows rows_to_try(const SweepParameter& parameter) {
  const auto& values = parameter.values;
  const bool numbers =
      std::all_of(values.begin(), values.end(), [](const TomlNode& v) { return v.kind == TomlNode::Kind::number; });
  Rows rows;
  if (numbers) {
    const auto [least, most] = std::minmax_element(
        values.begin(), values.end(), [](const TomlNode& a, const TomlNode& b) { return a.number < b.number; });
    rows = {static_cast<std::size_t>(least - values.begin()), static_cast<std::size_t>(most - values.begin())};
  } else {
    std::vector<std::string> seen{parameter_value_text(values[0])};
    for (std::size_t i = 1; i < values.size(); ++i)
      if (std::find(seen.begin(), seen.end(), parameter_value_text(values[i])) == seen.end()) {
        seen.push_back(parameter_value_text(values[i]));
        rows.push_back(i);
      }
  }
  rows.erase(std::remove(rows.begin(), rows.end(), 0u), rows.end());
  return rows;
}

}  // namespace

std::uint64_t Sweep::points() const {
  std::uint64_t points = samples;
  for (const SweepParameter& parameter : parameters)
    if (!parameter.sampled) points *= parameter.values.size();
  return points;
}

Rows rows_at(const Sweep& sweep, std::uint64_t point) {
  Rows rows(sweep.parameters.size());
  std::uint64_t rest = point / sweep.samples;
  for (std::size_t i = rows.size(); i-- > 0;) {
    const SweepParameter& parameter = sweep.parameters[i];
    rows[i] = parameter.sampled ? point % sweep.samples : rest % parameter.values.size();
    if (!parameter.sampled) rest /= parameter.values.size();
  }
  return rows;
}

Scenario scenario_of(const Sweep& sweep, std::uint64_t job) {
  Scenario scenario = scenario_at(sweep, rows_at(sweep, job / sweep.seeds.size()), sweep.parameters.size());
  scenario.seed = sweep.seeds[job % sweep.seeds.size()];
  return scenario;
}

std::vector<world::Warning> check_sweep(const Sweep& sweep) {
  const std::size_t all = sweep.parameters.size();
  Rows rows(all, 0);
  const TriedScenario first = try_scenario(sweep, rows, all);
  if (!first.error.empty()) {
    // If the error appears without any parameter, it is the scenario's own; else it is that of the first parameter that
    // causes it.
    if (try_scenario(sweep, rows, 0).error == first.error) throw base::InputError(first.error);
    std::size_t count = 1;
    while (count < all && try_scenario(sweep, rows, count).error != first.error) ++count;
    refuse_value(sweep, rows, count - 1, first.error);
  }
  for (std::size_t i = 0; i < all; ++i) {
    for (const std::size_t row : rows_to_try(sweep.parameters[i])) {
      rows[i] = row;
      const TriedScenario other = try_scenario(sweep, rows, all);
      if (!other.error.empty()) refuse_value(sweep, rows, i, other.error);
    }
    rows[i] = 0;
  }
  return first.warnings;
}

std::string parameter_value_text(const TomlNode& value) {
  std::vector<std::string> items;
  for (const TomlNode& item : value.items)
    items.push_back(item.key.empty() ? parameter_value_text(item)
                                     : fmt::format("{} = {}", item.key, parameter_value_text(item)));
  switch (value.kind) {
    case TomlNode::Kind::flag:
      return value.flag ? "true" : "false";
    case TomlNode::Kind::number:
      return fmt::format("{}", value.number);
    case TomlNode::Kind::text:
      return value.text;
    case TomlNode::Kind::list:
      return fmt::format("[{}]", fmt::join(items, ", "));
    default:
      return fmt::format("{{ {} }}", fmt::join(items, ", "));
  }
}

}  // namespace sf::scenarios
