#include "world/properties.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr std::size_t kMostWarnings = 10'000;

}  // namespace

void fail(const Source& source, Place at, const std::string& message) {
  throw base::InputError(source.document.files[at.file], at.line, message);
}

void warn(Source& source, Place at, const std::string& message) {
  if (source.warned.size() > kMostWarnings) return;
  if (source.warned.size() == kMostWarnings) {
    source.warned.insert("and more");
    source.warnings.push_back({source.document.files[at.file], at.line,
                               fmt::format("more than {} warnings; from here on they are left out", kMostWarnings)});
    return;
  }
  if (!source.warned.insert(fmt::format("{}:{}:{}", at.file, at.line, message)).second) return;
  source.warnings.push_back({source.document.files[at.file], at.line, message});
}

void spend(const Source& source, Place at, double& spent, double more, double most, std::string_view what,
           std::string_view remedy) {
  if (spent + more > most)
    fail(source, at,
         fmt::format("this makes {:.0f} {} of the world; expected at most {:.0f}: {}", spent + more, what, most,
                     remedy));
  spent += more;
}

Place place_of(const Entity& entity, std::string_view key) {
  const Property* property = find(entity, key);
  return property != nullptr ? property->at : entity.at;
}

namespace {

// The one value of a property that is not a tuple.
const Value& single(const Source& source, const Property& property, bool is_text) {
  const Value* value = property.values.empty() ? nullptr : &property.values.front();
  if (value == nullptr || property.values.size() != 1 || value->is_text != is_text) {
    fail(source, property.at, fmt::format("'{}' expects {}", property.key, is_text ? "a \"string\"" : "one number"));
  }
  return *value;
}

}  // namespace

double metres(const Source& source, Place at, double value) {
  const double result = value * source.metres;
  if (!(std::abs(result) <= kMostLength)) {
    fail(source, at, fmt::format("{} m is too large; expected lengths up to {} m", result, kMostLength));
  }
  return result;
}

double number(const Source& source, const Entity& entity, std::string_view key, double fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : single(source, *property, false).number;
}

double length(const Source& source, const Entity& entity, std::string_view key, double fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : metres(source, property->at, single(source, *property, false).number);
}

double above_zero(const Source& source, const Entity& entity, std::string_view key, double fallback) {
  const double value = length(source, entity, key, fallback);
  if (!(value > 0.0)) fail(source, find(entity, key)->at, fmt::format("'{}' expects a length above zero", key));
  return value;
}

double angle(const Source& source, const Entity& entity, std::string_view key, double fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : source.radians * single(source, *property, false).number;
}

bool flag(const Source& source, const Entity& entity, std::string_view key, bool fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : single(source, *property, false).number != 0.0;
}

std::string text(const Source& source, const Entity& entity, std::string_view key, const std::string& fallback) {
  const Property* property = find(entity, key);
  return property == nullptr ? fallback : single(source, *property, true).text;
}

Accuracy accuracy(const Source& source, const LoadOptions& options, const Entity& entity, const Accuracy& fallback) {
  const Property* property = find(entity, "accuracy");
  if (property == nullptr || !options.accuracy.empty()) return fallback;
  return {single(source, *property, true).text, source.document.files[property->at.file], property->at.line};
}

std::uint32_t whole(const Source& source, const Entity& entity, std::string_view key, std::uint32_t fallback,
                    std::uint32_t least, std::uint32_t most) {
  const Property* property = find(entity, key);
  if (property == nullptr) return fallback;
  const double value = single(source, *property, false).number;
  if (!(value >= least && value <= most) || value != std::floor(value)) {
    fail(source, property->at,
         fmt::format("'{}' is {}; expected a whole number from {} to {}", key, property->values.front().text, least,
                     most));
  }
  return static_cast<std::uint32_t>(value);
}

std::optional<std::vector<double>> tuple(const Source& source, const Entity& entity, std::string_view key,
                                         std::size_t least, const std::string& meaning) {
  const Property* property = find(entity, key);
  if (property == nullptr) return std::nullopt;
  std::vector<double> values;
  for (const Value& value : property->values) {
    if (value.is_text || !property->is_tuple) {
      fail(source, property->at, fmt::format("'{}' expects a tuple of numbers: {}", key, meaning));
    }
    values.push_back(value.number);
  }
  if (values.size() < least) {
    fail(source, property->at,
         fmt::format("'{}' has {} of the numbers it needs; expected {}", key, values.size(), meaning));
  }
  return values;
}

Pose pose(Source& source, const Entity& entity, std::string_view key) {
  const auto values = tuple(source, entity, key, 3, "[x y z yaw]");
  if (!values) return {};
  const Place at = find(entity, key)->at;
  const auto& v = *values;
  if (v.size() == 3)
    warn(source, at,
         fmt::format("'{0}' has three numbers, read as [x y z] with yaw 0: z is {1:g}; write [{2:g} {3:g} {1:g} 0], or "
                     "[{2:g} {3:g} 0 {1:g}] where the third is an angle",
                     key, v[2], v[0], v[1]));
  const double yaw = v.size() > 3 ? source.radians * v[3] : 0.0;
  if (!(std::abs(yaw) <= 1e6)) fail(source, at, fmt::format("the yaw of '{}' is out of reach", key));
  return {metres(source, at, v[0]), metres(source, at, v[1]), metres(source, at, v[2]), yaw};
}

}  // namespace sf::world
