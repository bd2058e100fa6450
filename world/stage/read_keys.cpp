#include "world/stage/read_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace sf::world {

namespace {

struct UnitScale {
  double si = 1.0;     ///< SI units per unit of the file
  double shown = 1.0;  ///< SI units per unit of messages
  std::string_view name = {};
};

UnitScale scale_of(const StageContext& context, Unit unit) {
  switch (unit) {
    case Unit::length:
      return {context.metres_per_unit, 1.0, " m"};
    case Unit::angle:
      return {context.radians_per_unit, M_PI / 180.0, " degrees"};
    case Unit::seconds:
      return {1.0, 1.0, " s"};
    case Unit::milliseconds:
      return {1e-3, 1e-3, " milliseconds"};
    case Unit::none:
      break;
  }
  return {};
}

std::string bounds_text(const Bounds& bounds, double unit) {
  const std::string least = fmt::format("{:.10g}", bounds.least / unit);
  const std::string most = fmt::format("{:.10g}", bounds.most / unit);
  const bool unlimited = bounds.most >= kFinite.most;
  if (bounds.open) return "more than " + least + (unlimited ? "" : ", to " + most);
  return unlimited ? least + " or more" : least + " to " + most;
}

/// Returns "xmax of 'velocity_bounds'" for an element of a tuple, and "'name'" for other keys.
std::string key_name(const Key& key) {
  std::istringstream names{std::string(key.tuple.substr(std::min<std::size_t>(1, key.tuple.size())))};
  std::string name;
  for (std::uint32_t i = 0; i <= key.element; ++i) names >> name;
  if (name.ends_with(']')) name.pop_back();
  return fmt::format("{}'{}'", key.tuple.empty() ? "" : name + " of ", key.name);
}

}  // namespace

double read_number(StageContext& context, const Entity& entity, const Key& key, const Bounds& bounds, double value) {
  const SourceLocation at = find(entity, key.name)->at;
  const UnitScale unit = scale_of(context, key.unit);
  double written = 0.0;
  if (key.tuple.empty()) {
    written = number(context, entity, key.name, 0.0);
  } else {
    const auto elements = tuple(context, entity, key.name, key.least, std::string(key.tuple));
    if (key.element >= elements->size()) return value;
    written = (*elements)[key.element];
  }
  // Dividing by 1000 converts 100 ms to exactly 0.1 s.
  double read = key.unit == Unit::milliseconds ? written / 1000.0 : unit.si * written;
  if (key.unit == Unit::length) read = to_metres(context, at, written);
  // A full turn in degrees may exceed 2 pi by rounding.
  if (read > bounds.most && read <= bounds.most * (1.0 + 1e-12)) read = bounds.most;
  if (bounds.contains(read)) return read;
  fail(context, at,
       fmt::format("{} is {:.10g}{}; expected {}", key_name(key), read / unit.shown, key.tuple.empty() ? unit.name : "",
                   bounds_text(bounds, unit.shown)));
}

std::size_t word_row(const StageContext& context, SourceLocation at, std::string_view key, std::string_view written,
                     std::span<const std::string_view> words) {
  const auto word = std::find(words.begin(), words.end(), written);
  if (word != words.end()) return static_cast<std::size_t>(word - words.begin());
  std::string expected;
  for (std::size_t i = 0; i < words.size(); ++i)
    expected += fmt::format("{}\"{}\"", i == 0 ? "" : i + 1 < words.size() ? ", " : " or ", words[i]);
  fail(context, at, fmt::format("'{}' is \"{}\"; expected {}", key, written, expected));
}

std::size_t read_word(StageContext& context, const Entity& entity, std::string_view key,
                      std::span<const std::string_view> words) {
  return word_row(context, find(entity, key)->at, key, text(context, entity, key, ""), words);
}

}  // namespace sf::world
