#include "sensors/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/elementary.h"
#include "base/error.h"
#include "base/suggest.h"
#include "base/tuple_text.h"

namespace sf::sensors {

namespace {

constexpr double kMostSeconds = 1e6;
constexpr double kFastest = 1e6;   // [Hz]
constexpr double kSlowest = 1e-6;  // [Hz]

const std::vector<double>& numbers(const world::Sensor& sensor, const world::Setting& setting, std::size_t least,
                                   const std::string& meaning) {
  const std::size_t count = setting.numbers.size();
  if (count < least || !setting.text.empty())
    refuse(sensor, setting.key, fmt::format("'{}' expects {}", setting.key, meaning));
  const std::size_t most = base::numbers_in(meaning);
  if (count > most)
    refuse(sensor, setting.key, fmt::format("'{}' has {} numbers; expected {}", setting.key, count, meaning));
  return setting.numbers;
}

/// Returns a limit: a whole number, or four digits that are rounded inwards, so that the limit holds.
std::string limit_text(double limit, bool is_least) {
  const double slack = 1e-9 * std::abs(limit);  // of the conversion to the file's unit
  if (!std::isfinite(limit) || std::abs(limit - std::round(limit)) <= slack) return fmt::format("{:.10g}", limit);
  const std::string digits = fmt::format("{:.3e}", limit);
  double shown = std::strtod(digits.c_str(), nullptr);
  if (is_least ? shown < limit - slack : shown > limit + slack) {
    const int exponent = std::atoi(digits.c_str() + digits.find('e') + 1);
    shown += (is_least ? 1.0 : -1.0) * std::strtod(fmt::format("1e{}", exponent - 3).c_str(), nullptr);
  }
  return fmt::format("{:.4g}", shown);
}

/// @param unit one unit of the file in SI; bounds and fallback are in SI
double scaled(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most,
              double unit, const std::string& name) {
  const world::Setting* setting = find(sensor, key);
  if (setting == nullptr) return fallback;
  const std::vector<double>& written = numbers(sensor, *setting, 1, "a number");
  if (written.size() > 1) refuse(sensor, key, fmt::format("'{}' has {} numbers; expected one", key, written.size()));
  const double value = unit * written.front();
  if (value >= least && value <= most) return value;
  refuse(sensor, key,
         fmt::format("'{}' is {:.10g}; expected {} to {}{}", key, value / unit, limit_text(least / unit, true),
                     limit_text(most / unit, false), name));
}

}  // namespace

void refuse(const world::Sensor& sensor, std::string_view key, const std::string& message) {
  const world::Setting* setting = find(sensor, key);
  if (setting != nullptr) throw base::InputError(setting->file, setting->line, message);
  throw base::InputError(sensor.file, sensor.line, message);
}

const world::Setting* find(const world::Sensor& sensor, std::string_view key) {
  const auto found = std::find_if(sensor.settings.begin(), sensor.settings.end(),
                                  [&](const world::Setting& setting) { return setting.key == key; });
  return found == sensor.settings.end() ? nullptr : &*found;
}

double number(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most) {
  return scaled(sensor, key, fallback, least, most, 1.0, "");
}

double length(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most) {
  return scaled(sensor, key, fallback, least, most, sensor.metres_per_unit, "");
}

double angle(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most) {
  const world::Setting* setting = find(sensor, key);
  const double written = setting == nullptr || setting->numbers.empty() ? 0.0 : setting->numbers.front();
  return scaled(sensor, key, fallback, least, most, sensor.radians_per_unit, hint_of_radians(sensor, written));
}

std::string hint_of_radians(const world::Sensor& sensor, double angle) {
  if (sensor.radians_per_unit != 1.0 || std::abs(angle) <= 2.0 * M_PI) return "";
  return fmt::format("; angles of this file are in radians (unit_angle): write {:.4g} if {:g} is in degrees",
                     angle * M_PI / 180.0, angle);
}

std::uint32_t whole(const world::Sensor& sensor, std::string_view key, std::uint32_t fallback, std::uint32_t least,
                    std::uint32_t most) {
  const double value = number(sensor, key, fallback, least, most);
  if (value == std::floor(value)) return static_cast<std::uint32_t>(value);
  refuse(sensor, key, fmt::format("'{}' is {:g}; expected a whole number from {} to {}", key, value, least, most));
}

std::size_t choice(const world::Sensor& sensor, std::string_view key, std::size_t fallback,
                   std::span<const std::string_view> words) {
  const world::Setting* setting = find(sensor, key);
  if (setting == nullptr) return fallback;
  const auto found = std::find(words.begin(), words.end(), setting->text);
  if (found != words.end() && setting->numbers.empty()) return static_cast<std::size_t>(found - words.begin());
  std::string expected;
  for (const std::string_view word : words) expected += fmt::format("{}\"{}\"", expected.empty() ? "" : " or ", word);
  refuse(sensor, key,
         fmt::format("'{}' is \"{}\"{}; expected {}", key, setting->text,
                     setting->numbers.empty() ? "" : " with numbers", expected));
}

std::optional<std::vector<double>> tuple(const world::Sensor& sensor, std::string_view key, std::size_t least,
                                         const std::string& meaning) {
  const world::Setting* setting = find(sensor, key);
  if (setting == nullptr) return std::nullopt;
  return numbers(sensor, *setting, least, meaning);
}

void refuse_beyond(const world::Sensor& sensor, std::string_view prefix, std::string_view counter, std::uint32_t count,
                   std::uint32_t most) {
  for (const world::Setting& setting : sensor.settings) {
    const std::size_t bracket = setting.key.find('[');
    if (!setting.key.starts_with(prefix) || bracket == std::string::npos) continue;
    if (std::strtoull(setting.key.c_str() + bracket + 1, nullptr, 10) < count) continue;
    refuse(sensor, setting.key,
           fmt::format("'{}' is beyond '{} {}' (numbered from 0); raise '{}' (at most {}) or leave it out", setting.key,
                       counter, count, counter, most));
  }
}

std::optional<std::size_t> preset_of(const world::Sensor& sensor, std::span<const std::string_view> names) {
  const world::Setting* const setting = find(sensor, "preset");
  if (setting == nullptr) return std::nullopt;
  const auto known = std::ranges::find(names, setting->text);
  if (known != names.end()) return static_cast<std::size_t>(known - names.begin());
  refuse(sensor, "preset",
         fmt::format("there is no preset \"{}\"; expected {}{}", setting->text, fmt::join(names, ", "),
                     base::suggest(setting->text, names)));
}

void require_range(const world::Sensor& sensor, std::string_view key, std::string_view what, double min, double max,
                   double most) {
  if (max > 0.0 && max <= most && min >= 0.0 && min < max) return;
  refuse(sensor, key,
         fmt::format("{} from {:g} to {:g} m; expected 0 or more, to more than that and at most {:g} m", what, min, max,
                     most));
}

base::RigidTransform spatial_mount(const world::Sensor& sensor) {
  base::RigidTransform X_MB = base::transform_of(sensor.X_MS);
  if (const auto pose = tuple(sensor, "pose6", 6, "[x y z roll pitch yaw]")) {
    const auto& v = *pose;
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs(v[k] * sensor.metres_per_unit) <= 1e6)) refuse(sensor, "pose6", "'pose6' is more than 1e6 m away");
    const double unit = sensor.radians_per_unit;
    for (std::size_t k = 3; k < 6; ++k)
      if (!(std::abs(v[k] * unit) <= 1e6)) refuse(sensor, "pose6", "an angle of 'pose6' is more than 1e6 radians");
    X_MB = base::compose(X_MB, {base::rotation_of(unit * v[3], unit * v[4], unit * v[5]),
                                sensor.metres_per_unit * glm::dvec3{v[0], v[1], v[2]}});
  }
  return base::compose(X_MB, {glm::dmat3(1.0), {0.0, 0.0, 0.5 * sensor.height}});
}

Pose planar_mount(const base::RigidTransform& X_MS) {
  return {X_MS.p.x, X_MS.p.y, X_MS.p.z, base::atan2(X_MS.R[0].y, X_MS.R[0].x)};
}

double rate_of(const world::Sensor& sensor, double fallback) {
  const world::Setting* rate = find(sensor, "rate");
  const world::Setting* interval = find(sensor, "update_interval");
  if (rate != nullptr) return number(sensor, "rate", fallback, kSlowest, kFastest);
  if (interval != nullptr) return 1000.0 / number(sensor, "update_interval", 100.0, 1e3 / kFastest, 1e3 / kSlowest);
  return fallback;
}

namespace {

/// Refuses a quantity that two settings state differently.
void refuse_restated(const world::Sensor& sensor) {
  struct Same {
    std::string_view list, key;
    std::size_t place;
  };
  constexpr Same kSame[] = {{"range", "range_min", 0},
                            {"range", "range_max", 1},
                            {"view", "range_min", 0},
                            {"view", "range_max", 1},
                            {"view", "fov", 2}};
  for (const auto& [list, key, place] : kSame) {
    const world::Setting *one = find(sensor, list), *two = find(sensor, key);
    if (one == nullptr || two == nullptr || one->numbers.size() <= place || two->numbers.size() != 1 ||
        one->numbers[place] == two->numbers[0])
      continue;
    refuse(sensor, key,
           fmt::format("'{}' is {:g}, but '{}' states {:g}; expected one of them", key, two->numbers[0], list,
                       one->numbers[place]));
  }
}

}  // namespace

SensorSpec common_spec(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type) {
  refuse_restated(sensor);
  SensorSpec row;
  row.mover = mover;
  row.sensor = number_of_type;
  row.name = sensor.name;
  row.X_MS = sensor.X_MS;
  row.rate = rate_of(sensor, row.rate);
  row.phase = number(sensor, "phase", 0.0, 0.0, kMostSeconds);
  row.latency = number(sensor, "latency", 0.0, 0.0, kMostSeconds);
  row.priority = static_cast<std::uint8_t>(whole(sensor, "priority", row.priority, 0, 9));
  return row;
}

void for_each_of(const world::World& world, std::string_view type,
                 const std::function<void(const world::Sensor&, std::uint32_t, std::uint32_t)>& body) {
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    std::uint32_t number_of_type = 0;
    for (const world::Sensor& sensor : world.movers[m].sensors)
      if (sensor.type == type) body(sensor, m, number_of_type++);
  }
}

}  // namespace sf::sensors
