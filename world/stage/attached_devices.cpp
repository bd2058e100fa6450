#include "world/stage/attached_devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "world/keys.h"

namespace sf::world {

const SensorKeyword* find_sensor_keyword(const BuildState& b, std::string_view type) {
  const auto& words = b.options.sensors;
  const auto word = std::find_if(words.begin(), words.end(), [&](const SensorKeyword& w) { return w.type == type; });
  return word == words.end() || type.empty() ? nullptr : &*word;
}

void add_sensor(BuildState& b, const Entity& entity, const Model& model, const SensorKeyword& word, const Pose& X_MB,
                double height, const std::string& name) {
  if (model.mover == kNone) {
    warn(b.context, entity.at,
         fmt::format("'{}' is carried by no robot: kept as a body that measures nothing", entity.word));
    return;
  }
  const auto& files = b.context.document.files;
  Sensor sensor{std::string(word.type),
                name,
                X_MB,
                height,
                b.context.metres_per_unit,
                b.context.radians_per_unit,
                {},
                entity.at.line,
                files[entity.at.file]};
  for (const Property& property : entity.properties) {
    // General properties of models are handled elsewhere and do not affect the measurement.
    if (!is_known_key(KeyScope::sensing, property.key, word.keys)) continue;
    if (property.key == "accuracy" && !b.options.accuracy.empty()) continue;
    Setting setting{property.key, {}, "", property.at.line, files[property.at.file]};
    for (const Value& value : property.values) {
      if (!value.is_text) setting.numbers.push_back(value.number);
      if (value.is_text) setting.text = value.text;
    }
    sensor.settings.push_back(std::move(setting));
  }
  b.world.movers[model.mover].sensors.push_back(std::move(sensor));
}

void add_magnet(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B) {
  const StageContext& context = b.context;
  const char* key = find(entity, "magnetic_moment") != nullptr ? "magnetic_moment" : "magneticmoment";
  const double moment = number(context, entity, key, 0.0);
  if (moment == 0.0 || !flag(context, entity, "magnetometer_return", true)) return;
  if (!(std::abs(moment) <= kMaxMoment))
    fail(context, find(entity, key)->at, fmt::format("'{}' is {}; expected at most {}", key, moment, kMaxMoment));
  Magnet magnet{{X_B.x, X_B.y},
                X_B.z + size.z / 2.0,
                kMomentUnit * moment,
                std::min(size.x, size.y) / 2.0,
                static_cast<std::uint32_t>(b.world.models.size())};
  if (!(magnet.radius > 0.0))
    fail(context, entity.at, "a magnet needs a 'size' above zero in x and y: half the smaller one is its radius");
  auto& magnets = model.mover == kNone ? b.world.magnets : b.world.movers[model.mover].magnets;
  magnets.push_back(magnet);
}

}  // namespace sf::world
