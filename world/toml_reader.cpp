#include "world/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/suggest.h"

namespace sf::world {

using Kind = TomlNode::Kind;

std::string shown_toml(const TomlNode& node) {
  constexpr std::size_t kLongest = 40;
  switch (node.kind) {
    case Kind::number:
      return fmt::format("{}", node.number);
    case Kind::text:
      return fmt::format("\"{}{}\"", node.text.substr(0, kLongest), node.text.size() > kLongest ? "..." : "");
    case Kind::flag:
      return node.flag ? "true" : "false";
    case Kind::list:
      return "a list";
    case Kind::table:
      return "a table";
    case Kind::other:
      break;
  }
  return "a date or time";
}

void TomlReader::fail(const TomlNode& node, const std::string& message) const {
  throw base::InputError(file_, node.line, message);
}

void TomlReader::require_kind(const TomlNode& root, std::string_view expected) const {
  struct Mark {
    std::string_view key, kind, use;
  };
  constexpr std::string_view kSweep = "a sweep", kTestbed = "a testbed", kPlan = "a plan of traffic lights";
  constexpr std::string_view kScenario = "a scenario", kScenarioUse = "`sensorfarm run` and `sensorfarm test`";
  constexpr std::array<Mark, 13> kMarks{{{"grid", kSweep, "`sensorfarm sweep`"},
                                         {"sample", kSweep, "`sensorfarm sweep`"},
                                         {"scenario", kSweep, "`sensorfarm sweep`"},
                                         {"camera", kTestbed, "`sensorfarm vps`"},
                                         {"survey", kTestbed, "`sensorfarm calibrate`"},
                                         {"program", kPlan, "`sensorfarm light`"},
                                         {"wave", kPlan, "`sensorfarm light`"},
                                         {"origin", "of a road network", "its RNDF"},
                                         {"expect", kScenario, kScenarioUse},
                                         {"robot", kScenario, kScenarioUse},
                                         {"default", kScenario, kScenarioUse},
                                         {"event", kScenario, kScenarioUse},
                                         {"duration", kScenario, kScenarioUse}}};
  for (const Mark& mark : kMarks) {
    const TomlNode* node = find(root, mark.key);
    if (node == nullptr) continue;
    if (mark.kind == expected) return;
    fail(*node, fmt::format("unknown key '{}': this file is {}, for {}; expected {}", mark.key, mark.kind, mark.use,
                            expected));
  }
}

void TomlReader::require_known(const TomlNode& table, std::span<const std::string_view> known) const {
  for (const TomlNode& item : table.items)
    if (std::find(known.begin(), known.end(), item.key) == known.end())
      fail(item, fmt::format("unknown key '{}'{}", item.key,
                             base::expected_one_of(item.key.size() > 40 ? "" : item.key, known)));
}

double TomlReader::number(const TomlNode& table, std::string_view key, double fallback, double least, double most,
                          std::string_view unit) const {
  const TomlNode* node = find(table, key);
  return node == nullptr ? fallback : number(*node, key, least, most, unit);
}

double TomlReader::number(const TomlNode& node, std::string_view key, double least, double most,
                          std::string_view unit) const {
  if (node.kind == Kind::number && node.number >= least && node.number <= most) return node.number;
  fail(node, fmt::format("'{}' expects a number from {:g} to {:g}{}; got {}", key, least, most,
                         unit.empty() ? "" : fmt::format(", in {}", unit), shown_toml(node)));
}

std::uint64_t TomlReader::whole(const TomlNode& table, std::string_view key, std::uint64_t fallback,
                                double most) const {
  const TomlNode* node = find(table, key);
  if (node == nullptr) return fallback;
  const bool fine = node->kind == Kind::number && node->number >= 0.0 && node->number <= most &&
                    node->number == std::floor(node->number);
  if (!fine)
    fail(*node, fmt::format("'{}' expects a whole number from 0 to {:.0f}; got {}", key, most, shown_toml(*node)));
  return static_cast<std::uint64_t>(node->number);
}

std::string TomlReader::text(const TomlNode& table, std::string_view key, const std::string& fallback) const {
  const TomlNode* node = find(table, key);
  if (node == nullptr) return fallback;
  if (node->kind != Kind::text || node->text.empty())
    fail(*node, fmt::format("'{}' expects a text in quotes; got {}", key, shown_toml(*node)));
  return node->text;
}

bool TomlReader::flag(const TomlNode& table, std::string_view key) const {
  const TomlNode* node = find(table, key);
  if (node != nullptr && node->kind != Kind::flag)
    fail(*node, fmt::format("'{}' expects true or false; got {}", key, shown_toml(*node)));
  return node != nullptr && node->flag;
}

const TomlNode* TomlReader::table(const TomlNode& in, std::string_view key) const {
  const TomlNode* node = find(in, key);
  if (node != nullptr && node->kind != Kind::table) fail(*node, fmt::format("'{}' expects a table", key));
  return node;
}

std::vector<const TomlNode*> TomlReader::tables(const TomlNode& in, std::string_view key) const {
  std::vector<const TomlNode*> found;
  const TomlNode* node = find(in, key);
  if (node == nullptr) return found;
  const bool fine = node->kind == Kind::list && std::all_of(node->items.begin(), node->items.end(),
                                                            [](const auto& item) { return item.kind == Kind::table; });
  if (!fine) fail(*node, fmt::format("'{}' expects tables, each under [[{}]]", key, key));
  for (const TomlNode& item : node->items) found.push_back(&item);
  return found;
}

void TomlReader::numbers(const TomlNode& table, std::string_view key, std::span<double> into, double most,
                         std::string_view expected) const {
  const TomlNode* node = find(table, key);
  if (node == nullptr) return;
  if (node->kind != Kind::list || node->items.size() != into.size())
    fail(*node, fmt::format("'{}' expects {}", key, expected));
  for (std::size_t i = 0; i < into.size(); ++i) into[i] = number(node->items[i], key, -most, most);
}

}  // namespace sf::world
