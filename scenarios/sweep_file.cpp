// Reader of sweep files.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/elementary.h"
#include "base/error.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/installation.h"
#include "scenarios/sweep.h"
#include "scenarios/sweep_sample.h"
#include "world/toml_reader.h"

namespace sf::scenarios {

namespace {

using world::TomlNode;
using world::TomlReader;

constexpr double kMostSeed = 9.0e15;  // limit up to which a double represents all whole numbers exactly
constexpr double kMostJobsNumber = static_cast<double>(kMostJobs);
constexpr std::array<std::string_view, 5> kSweepKeys{"name", "scenario", "seeds", "grid", "sample"};
constexpr std::array<std::string_view, 4> kSampleKeys{"points", "method", "seed", "range"};
constexpr std::array<std::string_view, 5> kRangeKeys{"from", "to", "count", "scale", "whole"};

/// A range of numbers: { from, to } with scale = "log" and whole = true; with a count in a grid.
struct Range {
  double from = 0.0, to = 0.0;
  bool log = false;
  bool whole = false;

  /// @param u in [0, 1]; whole numbers are equally likely for u in [0, 1).
  double at(double u) const {
    if (whole && !log) return std::min(from + std::floor(u * (to - from + 1.0)), to);
    const double x = log ? from * base::exp(u * base::log(to / from)) : from + u * (to - from);
    return std::clamp(whole ? std::round(x) : x, from, to);
  }
  /// Returns a point of a grid of `count` points that includes both ends.
  /// @param i below `count`
  double point(std::uint64_t i, std::uint64_t count) const {
    if (i + 1 == count) return to;
    const double u = static_cast<double>(i) / static_cast<double>(count - 1);
    const double x = log ? from * base::exp(u * base::log(to / from)) : from + u * (to - from);
    return whole ? std::round(x) : std::stod(fmt::format("{:.12g}", x));  // 0.1, not 0.09999999999999999
  }
};

bool is_range(const TomlNode& node) {
  return node.kind == TomlNode::Kind::table &&
         (world::find(node, "from") != nullptr || world::find(node, "to") != nullptr);
}

Range range_of(const TomlReader& reader, const TomlNode& node) {
  reader.require_known(node, kRangeKeys);
  for (const std::string_view key : {"from", "to"})
    if (world::find(node, key) == nullptr)
      reader.fail(node, fmt::format("'{}' has no '{}'; expected a range {{ from = A, to = B }}", node.key, key));
  Range range{.from = reader.number(node, "from", 0.0, -1e15, 1e15),
              .to = reader.number(node, "to", 0.0, -1e15, 1e15),
              .whole = reader.flag(node, "whole")};
  const std::string scale = reader.text(node, "scale", "linear");
  if (scale != "linear" && scale != "log")
    reader.fail(*world::find(node, "scale"), "'scale' expects \"linear\" or \"log\"");
  range.log = scale == "log";
  if (!(range.from < range.to)) reader.fail(node, fmt::format("'{}' expects 'from' below 'to'", node.key));
  if (range.log && range.from <= 0.0)
    reader.fail(node, fmt::format("'{}': scale \"log\" expects 'from' above 0", node.key));
  if (range.whole && (range.from != std::floor(range.from) || range.to != std::floor(range.to)))
    reader.fail(node, fmt::format("'{}': whole = true expects whole numbers as 'from' and 'to'", node.key));
  return range;
}

TomlNode number_node(double value) {
  TomlNode node;
  node.kind = TomlNode::Kind::number;
  node.number = value;
  return node;
}

/// All leaves below a table, in the file's order: lists, ranges and single values.
struct Leaf {
  std::string name;
  const TomlNode* node;
};
void add_leaves(const TomlNode& table, const std::string& prefix, std::vector<Leaf>& leaves) {
  for (const TomlNode& node : table.items) {
    const std::string name = prefix + node.key;
    if (node.kind == TomlNode::Kind::table && !is_range(node))
      add_leaves(node, name + ".", leaves);
    else
      leaves.push_back({name, &node});
  }
  if (prefix.empty())
    std::stable_sort(leaves.begin(), leaves.end(),
                     [](const Leaf& a, const Leaf& b) { return a.node->line < b.node->line; });
}

/// @throws base::InputError for names that cannot be keys of a scenario
void check_name(const TomlReader& reader, const Leaf& leaf, std::set<std::string>& names) {
  if (leaf.name == "seed" || leaf.name == "name")
    reader.fail(*leaf.node, leaf.name == "seed"
                                ? "'seed' is not a parameter; expected seeds = N or seeds = [...] instead"
                                : "'name' is not a parameter; expected a key that changes the run");
  if (("." + leaf.name + ".").find("..") != std::string::npos)
    reader.fail(*leaf.node, fmt::format("'{}' has an empty part; expected keys separated by dots", leaf.name));
  if (!names.insert(leaf.name).second)
    reader.fail(*leaf.node, fmt::format("'{}' is already a parameter; expected it once", leaf.name));
}

void check_choices(const TomlReader& reader, const Leaf& leaf) {
  if (leaf.node->kind == TomlNode::Kind::list && leaf.node->items.empty())
    reader.fail(*leaf.node, fmt::format("'{}' has no values; expected at least one", leaf.name));
}

SweepParameter grid_parameter(const TomlReader& reader, const Leaf& leaf) {
  const TomlNode& node = *leaf.node;
  SweepParameter parameter{.name = leaf.name, .line = node.line};
  if (is_range(node)) {
    const Range range = range_of(reader, node);
    if (world::find(node, "count") == nullptr)
      reader.fail(node, fmt::format("'{}' has no 'count'; expected {{ from = A, to = B, count = N }}", leaf.name));
    const std::uint64_t count = reader.whole(node, "count", 2, kMostJobsNumber);
    if (count < 2) reader.fail(node, fmt::format("'{}' expects a count of at least 2", leaf.name));
    for (std::uint64_t i = 0; i < count; ++i) parameter.values.push_back(number_node(range.point(i, count)));
  } else if (node.kind == TomlNode::Kind::list) {
    parameter.values = node.items;
  } else {
    parameter.values = {node};
  }
  return parameter;
}

/// Called after each parameter, so that no list becomes much longer than the limit.
void check_number_of_jobs(const TomlReader& reader, const Sweep& sweep, std::size_t seeds) {
  double jobs = static_cast<double>(sweep.samples) * static_cast<double>(seeds);
  for (const SweepParameter& parameter : sweep.parameters)
    if (!parameter.sampled) jobs *= static_cast<double>(parameter.values.size());
  if (jobs > kMostJobsNumber)
    throw base::InputError(reader.file(), 0,
                           fmt::format("has {:.4g} jobs (points x seeds); expected {} at most: use fewer values or "
                                       "seeds, or a sample instead of the grid",
                                       jobs, kMostJobs));
}

void read_grid(const TomlReader& reader, const TomlNode* table, std::set<std::string>& names, Sweep& sweep) {
  if (table == nullptr) return;
  std::vector<Leaf> leaves;
  add_leaves(*table, "", leaves);
  for (const Leaf& leaf : leaves) {
    check_name(reader, leaf, names);
    check_choices(reader, leaf);
    sweep.parameters.push_back(grid_parameter(reader, leaf));
    check_number_of_jobs(reader, sweep, 1);
  }
}

SampleMethod method_of(const TomlReader& reader, const TomlNode& table) {
  const std::string method = reader.text(table, "method", "latin-hypercube");
  if (method == "latin-hypercube") return SampleMethod::latin_hypercube;
  if (method == "random") return SampleMethod::random;
  reader.fail(*world::find(table, "method"), "'method' expects \"latin-hypercube\" or \"random\"");
}

void read_sample(const TomlReader& reader, const TomlNode* table, std::set<std::string>& names, Sweep& sweep) {
  if (table == nullptr) return;
  reader.require_known(*table, kSampleKeys);
  std::vector<Leaf> leaves;
  if (const TomlNode* range = reader.table(*table, "range")) add_leaves(*range, "", leaves);
  if (leaves.empty() || world::find(*table, "points") == nullptr)
    reader.fail(*table, "a sample has points = N and [sample.range] with at least one parameter");
  sweep.samples = reader.whole(*table, "points", 1, kMostJobsNumber);
  if (sweep.samples == 0) reader.fail(*world::find(*table, "points"), "'points' expects at least 1");
  if (static_cast<double>(sweep.samples) * static_cast<double>(leaves.size()) > 4.0 * kMostJobsNumber)
    reader.fail(*table, "too many points and parameters; expected 4 000 000 sampled values at most");
  const auto rows = sample_points(method_of(reader, *table), sweep.samples, leaves.size(),
                                  reader.whole(*table, "seed", 1, kMostSeed));
  for (std::size_t d = 0; d < leaves.size(); ++d) {
    const TomlNode& node = *leaves[d].node;
    check_name(reader, leaves[d], names);
    check_choices(reader, leaves[d]);
    if (!is_range(node) && node.kind != TomlNode::Kind::list)
      reader.fail(node, fmt::format("'{}' expects a range {{ from = A, to = B }} or a list of values", node.key));
    if (const TomlNode* count = world::find(node, "count"))
      reader.fail(*count, "'count' belongs to ranges of a grid; the number of a sample's points is 'points'");
    SweepParameter parameter{.name = leaves[d].name, .sampled = true, .line = node.line};
    const Range range = is_range(node) ? range_of(reader, node) : Range{};
    for (const std::vector<double>& row : rows)
      parameter.values.push_back(
          is_range(node) ? number_node(range.at(row[d]))
                         : node.items[static_cast<std::size_t>(row[d] * static_cast<double>(node.items.size()))]);
    sweep.parameters.push_back(std::move(parameter));
  }
}

std::vector<std::uint64_t> seeds_of(const TomlReader& reader, const TomlNode& root, std::uint64_t first) {
  const TomlNode* node = world::find(root, "seeds");
  std::vector<std::uint64_t> seeds;
  if (node == nullptr || node->kind != TomlNode::Kind::list) {
    const std::uint64_t count = reader.whole(root, "seeds", 1, kMostJobsNumber);
    for (std::uint64_t k = 0; k < count; ++k) seeds.push_back(first + k);
  } else {
    for (const TomlNode& item : node->items) {
      TomlNode table;
      table.items = {item};
      table.items[0].key = "seeds";
      seeds.push_back(reader.whole(table, "seeds", 0, kMostSeed));
    }
  }
  if (seeds.empty()) reader.fail(*node, "'seeds' expects at least one: a number of seeds, or a list of them");
  if (std::set<std::uint64_t>(seeds.begin(), seeds.end()).size() != seeds.size())
    reader.fail(*node, "'seeds' contains a duplicate; expected distinct seeds");
  return seeds;
}

/// Returns a path relative to the sweep's file, else among the installed scenarios.
std::string scenario_file_of(const TomlReader& reader, const TomlNode& root) {
  const std::string file = reader.text(root, "scenario", "");
  if (file.empty()) throw base::InputError(reader.file(), 0, "has no scenario; expected scenario = \"FILE.toml\"");
  const std::filesystem::path beside = std::filesystem::path(reader.file()).parent_path() / file;
  const std::string found =
      std::filesystem::exists(beside) ? beside.lexically_normal().string() : base::installed_file(file);
  if (!std::filesystem::is_regular_file(found))
    reader.fail(*world::find(root, "scenario"),
                fmt::format("there is no scenario '{}'; expected a file, relative to this file's folder", file));
  return found;
}

}  // namespace

Sweep parse_sweep(const std::string& file, std::string_view text) {
  const TomlNode root = world::parse_toml(file, text);
  const TomlReader reader(file);
  reader.require_kind(root, "a sweep");
  reader.require_known(root, kSweepKeys);
  Sweep sweep{.file = file};
  sweep.name = reader.text(root, "name", std::filesystem::path(file).stem().string());
  sweep.scenario = scenario_file_of(reader, root);
  const std::string scenario = base::read_text(sweep.scenario);
  sweep.settings = world::parse_toml(sweep.scenario, scenario);
  sweep.hash = base::hash_bytes(scenario.data(), scenario.size(), base::hash_bytes(text.data(), text.size()));
  std::set<std::string> names;
  read_grid(reader, reader.table(root, "grid"), names, sweep);
  read_sample(reader, reader.table(root, "sample"), names, sweep);
  sweep.seeds = seeds_of(reader, root, parse_scenario(sweep.scenario, sweep.settings).seed);
  check_number_of_jobs(reader, sweep, sweep.seeds.size());
  return sweep;
}

Sweep read_sweep(const std::string& file) { return parse_sweep(file, base::read_text(file)); }

}  // namespace sf::scenarios
