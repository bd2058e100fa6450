#include "world/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/suggest.h"

namespace sf::world {

using Kind = TomlNode::Kind;

void TomlReader::fail(const TomlNode& node, const std::string& message) const {
  throw base::InputError(file_, node.line, message);
}

void TomlReader::require_known(const TomlNode& table, std::span<const std::string_view> known) const {
  for (const TomlNode& item : table.items)
    if (std::find(known.begin(), known.end(), item.key) == known.end())
      fail(item, fmt::format("unknown key '{}'{}; expected one of: {}", item.key,
                             item.key.size() > 40 ? "" : base::suggest(item.key, known), fmt::join(known, ", ")));
}

double TomlReader::number(const TomlNode& table, std::string_view key, double fallback, double least,
                          double most) const {
  const TomlNode* node = find(table, key);
  return node == nullptr ? fallback : number(*node, key, least, most);
}

double TomlReader::number(const TomlNode& node, std::string_view key, double least, double most) const {
  if (node.kind == Kind::number && node.number >= least && node.number <= most) return node.number;
  fail(node, fmt::format("'{}' expects a number from {:g} to {:g}", key, least, most));
}

std::uint64_t TomlReader::whole(const TomlNode& table, std::string_view key, std::uint64_t fallback,
                                double most) const {
  const TomlNode* node = find(table, key);
  if (node == nullptr) return fallback;
  const bool fine = node->kind == Kind::number && node->number >= 0.0 && node->number <= most &&
                    node->number == std::floor(node->number);
  if (!fine) fail(*node, fmt::format("'{}' expects a whole number from 0 to {:.0f}", key, most));
  return static_cast<std::uint64_t>(node->number);
}

std::string TomlReader::text(const TomlNode& table, std::string_view key, const std::string& fallback) const {
  const TomlNode* node = find(table, key);
  if (node == nullptr) return fallback;
  if (node->kind != Kind::text || node->text.empty()) fail(*node, fmt::format("'{}' expects a text in quotes", key));
  return node->text;
}

bool TomlReader::flag(const TomlNode& table, std::string_view key) const {
  const TomlNode* node = find(table, key);
  if (node != nullptr && node->kind != Kind::flag) fail(*node, fmt::format("'{}' expects true or false", key));
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
