#include "world/stage/parse_state.h"

#include <fmt/format.h>

#include <array>
#include <numeric>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr std::size_t kFewKeys = 32;  // up to this number, search is linear

}  // namespace

void fail(const ParseState& r, int line, const std::string& message) {
  throw base::InputError(r.document.files[r.file], line, message);
}

void warn(ParseState& r, int line, std::string message) {
  if (r.document.warnings.size() > kMaxWarnings) return;
  if (r.document.warnings.size() == kMaxWarnings)
    message = fmt::format("more than {} warnings; further warnings are dropped", kMaxWarnings);
  r.document.warnings.push_back({r.document.files[r.file], line, std::move(message)});
}

std::string shown(const Token& token) {
  if (token.kind == TokenKind::end) return "the end of the file";
  return token.kind == TokenKind::text ? '"' + token.text + '"' : '\'' + token.text + '\'';
}

namespace {

Value value_of(const Token& token) { return {token.kind == TokenKind::text, token.number, token.text}; }

/// Returns the weight of a property: itself, its values, and its long texts.
std::uint32_t weight_of(const Property& property) {
  constexpr std::size_t kStretch = 64;
  std::size_t bytes = property.key.size();
  for (const Value& value : property.values) bytes += value.text.size();
  return static_cast<std::uint32_t>(1 + property.values.size() + bytes / kStretch);
}

bool is_value(const Token& token) { return token.kind == TokenKind::number || token.kind == TokenKind::text; }

void read_tuple(ParseState& r, Property& property) {
  const int line = now(r).line;
  property.is_tuple = true;
  for (++r.at; now(r).kind != TokenKind::close_tuple; ++r.at) {
    if (now(r).kind == TokenKind::end) fail(r, line, "this '[' is never closed; expected ']'");
    if (!is_value(now(r))) {
      fail(r, now(r).line,
           fmt::format("expected a number, a \"string\" or ']' in the tuple of '{}', found {}", property.key,
                       shown(now(r))));
    }
    property.values.push_back(value_of(now(r)));
  }
  ++r.at;
}

}  // namespace

Property read_property(ParseState& r) {
  Property property{now(r).text, {}, false, location(r, now(r))};
  const int line = now(r).line;
  ++r.at;
  if (now(r).kind == TokenKind::open_tuple) {
    read_tuple(r, property);
  } else if (is_value(now(r))) {
    property.values.push_back(value_of(now(r)));
    ++r.at;
  } else {
    fail(r, line,
         fmt::format("'{}' requires a value (a number, a \"string\" or a [tuple]) or a body in parentheses; found {}",
                     property.key, shown(now(r))));
  }
  return property;
}

void add_property(ParseState& r, Entity& entity, KeyRows& rows, std::unordered_set<std::string>& written,
                  Property property) {
  const std::uint32_t weight = weight_of(property);
  entity.weight += weight;
  r.weight += weight;
  const auto [old, fresh] = rows.emplace(property.key, static_cast<std::uint32_t>(entity.properties.size()));
  if (!written.insert(property.key).second)
    warn(r, property.at.line,
         fmt::format("'{}' is given twice in the same '{}': the last one is used, not that of line {}", property.key,
                     entity.word, entity.properties[old->second].at.line));
  if (fresh) {
    entity.properties.push_back(std::move(property));
  } else {
    entity.properties[old->second] = std::move(property);
  }
}

namespace {

/// A family of numbered keys with one count: `spose[i]` and `spose3[i]`, counted by `scount`.
struct NumberedKeys {
  std::string stem;   ///< of the key itself
  std::string other;  ///< stem of another key that may have the same number instead; empty: none
  std::string count;  ///< key of the count
};

/// @param key ends in `[number]`
NumberedKeys family_of(const std::string& key) {
  const std::string stem = key.substr(0, key.rfind('['));
  for (const auto& [a, b, count] : {std::array{"spose", "spose3", "scount"}, {"straight", "arc", "pieces"}}) {
    if (stem == a) return {stem, b, count};
    if (stem == b) return {stem, a, count};
  }
  return {stem, "", stem == "bpose" || stem == "blength" ? "bcount" : stem + "s"};
}

/// Returns the smallest numbers below the family's count that no property has: `wanted` of them, or none if fewer are
/// free.
std::vector<std::size_t> free_numbers(const Entity& entity, const KeyRows& rows, const NumberedKeys& keys,
                                      std::size_t wanted) {
  std::vector<std::size_t> numbers;
  const auto count = rows.find(keys.count);
  if (count == rows.end() || entity.properties[count->second].values.size() != 1) return numbers;
  const double most = entity.properties[count->second].values[0].number;
  for (std::size_t i = 0; static_cast<double>(i) < most && numbers.size() < wanted; ++i)
    if (!rows.contains(fmt::format("{}[{}]", keys.stem, i)) && !rows.contains(fmt::format("{}[{}]", keys.other, i)))
      numbers.push_back(i);
  if (numbers.size() < wanted) numbers.clear();
  return numbers;
}

}  // namespace

void add_repeats(ParseState& r, Entity& entity, KeyRows& rows, std::unordered_set<std::string>& written,
                 std::vector<Property> repeats) {
  std::map<std::string, std::vector<Property*>> by_family;
  for (Property& repeat : repeats) {
    const NumberedKeys keys = family_of(repeat.key);
    by_family[std::min(keys.stem, keys.other.empty() ? keys.stem : keys.other)].push_back(&repeat);
  }
  for (auto& [stem, same] : by_family) {
    const std::vector<std::size_t> numbers = free_numbers(entity, rows, family_of(same.front()->key), same.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      std::string& key = same[i]->key;
      std::string meant = fmt::format("{}[{}]", family_of(key).stem, numbers[i]);
      warn(r, same[i]->at.line,
           fmt::format(
               "'{}' is given again in the same '{}' (first in line {}): read as '{}', a number that is missing; "
               "number the lines",
               key, entity.word, entity.properties[rows.at(key)].at.line, meant));
      key = std::move(meant);
    }
  }
  for (Property& repeat : repeats) add_property(r, entity, rows, written, std::move(repeat));
}

void sort_keys(Entity& entity) {
  if (entity.properties.size() <= kFewKeys) return;
  entity.by_key.resize(entity.properties.size());
  std::iota(entity.by_key.begin(), entity.by_key.end(), 0u);
  std::sort(entity.by_key.begin(), entity.by_key.end(),
            [&](std::uint32_t a, std::uint32_t b) { return entity.properties[a].key < entity.properties[b].key; });
}

const Property* find(const Entity& entity, std::string_view key) {
  const auto& all = entity.properties;
  if (entity.by_key.size() != all.size() || all.empty()) {
    const auto it = std::find_if(all.begin(), all.end(), [&](const Property& p) { return p.key == key; });
    return it == all.end() ? nullptr : &*it;
  }
  const auto it = std::lower_bound(entity.by_key.begin(), entity.by_key.end(), key,
                                   [&](std::uint32_t row, std::string_view wanted) { return all[row].key < wanted; });
  return it == entity.by_key.end() || all[*it].key != key ? nullptr : &all[*it];
}

}  // namespace sf::world
