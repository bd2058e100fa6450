#include "world/stage/properties.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/tuple_text.h"

namespace sf::world {

void fail(const StageContext& context, SourceLocation at, const std::string& message) {
  throw base::InputError(context.document.files[at.file], at.line, message);
}

void warn(StageContext& context, SourceLocation at, const std::string& message) {
  if (context.warned.size() > kMaxWarnings) return;
  if (context.warned.size() == kMaxWarnings) {
    context.warned.insert("and more");
    context.warnings.push_back({context.document.files[at.file], at.line,
                                fmt::format("more than {} warnings; further warnings are dropped", kMaxWarnings)});
    return;
  }
  if (!context.warned.insert(fmt::format("{}:{}:{}", at.file, at.line, message)).second) return;
  context.warnings.push_back({context.document.files[at.file], at.line, message});
}

void warn_once(StageContext& context, SourceLocation at, std::string_view difference) {
  if (context.differences.insert(difference).second) warn(context, at, std::string(difference));
}

void charge(const StageContext& context, SourceLocation at, double& used, double more, double most,
            std::string_view what, std::string_view remedy) {
  if (used + more > most)
    fail(context, at,
         fmt::format("the world now has {:.0f} {}; expected at most {:.0f}: {}", used + more, what, most, remedy));
  used += more;
}

SourceLocation location_of(const Entity& entity, std::string_view key) {
  const Property* property = find(entity, key);
  return property != nullptr ? property->at : entity.at;
}

namespace {

// Returns the value of a property that is not a tuple.
const Value& single(const StageContext& context, const Property& property, bool is_text) {
  const Value* value = property.values.empty() ? nullptr : &property.values.front();
  if (value == nullptr || property.values.size() != 1 || value->is_text != is_text) {
    fail(context, property.at, fmt::format("'{}' expects {}", property.key, is_text ? "a \"string\"" : "one number"));
  }
  return *value;
}

}  // namespace

double to_metres(const StageContext& context, SourceLocation at, double value) {
  const double result = value * context.metres_per_unit;
  if (!(std::abs(result) <= kMaxLength)) {
    fail(context, at, fmt::format("{} m is too large; expected lengths up to {} m", result, kMaxLength));
  }
  return result;
}

double number(const StageContext& context, const Entity& entity, std::string_view key, double fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : single(context, *property, false).number;
}

double length(const StageContext& context, const Entity& entity, std::string_view key, double fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : to_metres(context, property->at, single(context, *property, false).number);
}

double above_zero(const StageContext& context, const Entity& entity, std::string_view key, double fallback) {
  const double value = length(context, entity, key, fallback);
  if (!(value > 0.0)) fail(context, find(entity, key)->at, fmt::format("'{}' expects a length above zero", key));
  return value;
}

bool flag(const StageContext& context, const Entity& entity, std::string_view key, bool fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : single(context, *property, false).number != 0.0;
}

std::string text(const StageContext& context, const Entity& entity, std::string_view key, const std::string& fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : single(context, *property, true).text;
}

std::string file_of(const StageContext& context, const Entity& entity, std::string_view key) {
  const std::string name = text(context, entity, key, "");
  const SourceLocation at = location_of(entity, key);
  const std::string file = find_file(context.document, at, name);
  if (file.empty()) {
    fail(context, at,
         fmt::format("cannot find the {} \"{}\"; searched the folders of this file and of the world file, $STAGEPATH "
                     "and the installed worlds",
                     key, name));
  }
  return file;
}

Accuracy accuracy(const StageContext& context, const LoadOptions& options, const Entity& entity) {
  const Property* property = find(entity, "accuracy");
  if (property == nullptr || !options.accuracy.empty()) return {options.accuracy, "", 0};
  return {single(context, *property, true).text, context.document.files[property->at.file], property->at.line};
}

std::uint32_t whole(const StageContext& context, const Entity& entity, std::string_view key, std::uint32_t fallback,
                    std::uint32_t least, std::uint32_t most) {
  const Property* property = find(entity, key);
  if (property == nullptr) return fallback;
  const double value = single(context, *property, false).number;
  if (!(value >= least && value <= most) || value != std::floor(value)) {
    fail(context, property->at,
         fmt::format("'{}' is {}; expected a whole number from {} to {}", key, property->values.front().text, least,
                     most));
  }
  return static_cast<std::uint32_t>(value);
}

std::optional<std::vector<double>> tuple(StageContext& context, const Entity& entity, std::string_view key,
                                         std::size_t least, const std::string& meaning) {
  const Property* property = find(entity, key);
  if (property == nullptr) return std::nullopt;
  std::vector<double> values;
  for (const Value& value : property->values) {
    if (value.is_text || !property->is_tuple) {
      fail(context, property->at, fmt::format("'{}' expects a tuple of numbers: {}", key, meaning));
    }
    values.push_back(value.number);
  }
  if (values.size() < least) {
    fail(context, property->at,
         fmt::format("'{}' has only {} number{}; expected {}", key, values.size(), values.size() == 1 ? "" : "s",
                     meaning));
  }
  const std::size_t most = base::numbers_in(meaning);
  if (values.size() > most) {
    warn(context, property->at,
         fmt::format("'{}' has {} numbers; only {} are read: {}", key, values.size(), most, meaning));
  }
  return values;
}

Pose pose(StageContext& context, const Entity& entity, std::string_view key) {
  const auto values = tuple(context, entity, key, 3, "[x y z yaw]");
  if (!values) return {};
  const SourceLocation at = find(entity, key)->at;
  const auto& v = *values;
  if (v.size() == 3)
    warn(context, at,
         fmt::format("'{0}' has three numbers, read as [x y z] with yaw 0: z is {1:g}; write [{2:g} {3:g} {1:g} 0], or "
                     "[{2:g} {3:g} 0 {1:g}] where the third is an angle",
                     key, v[2], v[0], v[1]));
  const double yaw = v.size() > 3 ? context.radians_per_unit * v[3] : 0.0;
  if (!(std::abs(yaw) <= 1e6)) fail(context, at, fmt::format("the yaw of '{}' is out of range", key));
  return {to_metres(context, at, v[0]), to_metres(context, at, v[1]), to_metres(context, at, v[2]), yaw};
}

}  // namespace sf::world
