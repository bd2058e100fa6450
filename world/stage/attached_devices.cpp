#include "world/stage/attached_devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/suggest.h"
#include "world/beam_table.h"
#include "world/keys.h"
#include "world/stage/entity_color.h"
#include "world/stage/unit_hints.h"

namespace sf::world {

namespace {

const SensorKeyword* find_keyword(const BuildState& b, std::string_view type, bool derived) {
  const auto& words = b.options.sensors;
  const auto word = std::find_if(words.begin(), words.end(),
                                 [&](const SensorKeyword& w) { return w.type == type && w.derived == derived; });
  return word == words.end() || type.empty() ? nullptr : &*word;
}

}  // namespace

const SensorKeyword* find_sensor_keyword(const BuildState& b, std::string_view type) {
  return find_keyword(b, type, false);
}

const SensorKeyword* derived_keyword(const BuildState& b, const Entity& entity) {
  std::vector<std::string_view> names;
  for (const SensorKeyword& word : b.options.sensors)
    if (word.derived) names.push_back(word.type);
  if (names.empty()) return nullptr;
  const std::string name = text(b.context, entity, "type", "");
  if (const SensorKeyword* const word = find_keyword(b, name, true)) return word;
  fail(b.context, location_of(entity, "type"),
       fmt::format("derived sensor type '{}' is unknown; expected one of: {}{}", name, fmt::join(names, ", "),
                   base::suggest(name, names)));
}

namespace {

constexpr double kBlockHeight = 0.02;  // [m] height of a `sensor( )` block without a size
constexpr double kMaxSamples = 1e7;
/// Settings outside of `sensor( )` blocks that apply to each of them, besides those of all sensors.
constexpr std::string_view kOfAllBlocks[] = {"noise", "resolution"};

/// Maps settings with the same meaning to one key: `update_interval` sets the rate.
std::string_view meaning_of(std::string_view key) { return key == "update_interval" ? "rate" : key; }

/// Adds the settings of `entity`, except those that `sensor` already has. General model properties are handled
/// elsewhere and do not affect the measurement.
void add_settings(BuildState& b, const Entity& entity, std::span<const std::string_view> own, Sensor& sensor) {
  const std::vector<Setting> before = sensor.settings;
  for (const Property& property : entity.properties) {
    if (!is_known_key(KeyScope::sensing, property.key, own)) continue;
    const bool overridden = property.key == "accuracy" && !b.options.accuracy.empty();
    if (overridden || property.key == "laser_color") continue;
    const auto same = [&](const Setting& s) { return meaning_of(s.key) == meaning_of(property.key); };
    if (std::any_of(before.begin(), before.end(), same)) continue;
    warn_of_units(b, property, sensor.type);
    Setting setting{property.key, {}, "", property.at.line, b.context.document.files[property.at.file]};
    for (const Value& value : property.values) {
      if (!value.is_text) setting.numbers.push_back(value.number);
      if (value.is_text) setting.text += (setting.text.empty() ? "" : "\n") + value.text;
    }
    if (setting.key == "samples" && !setting.numbers.empty())
      charge(b.context, property.at, b.context.usage.samples, std::max(0.0, setting.numbers[0]), kMaxSamples,
             "samples of sensors", "give fewer 'samples'");
    // Stage uses the first number of a laser's noise as a variance; settings are standard deviations.
    const bool has_noise = setting.key == "noise" && !setting.numbers.empty() && setting.numbers[0] > 0.0;
    if (has_noise && b.context.noise.applies && (sensor.type == "laser" || sensor.type == "ranger"))
      setting.numbers[0] = std::sqrt(setting.numbers[0] / b.context.metres_per_unit);
    if (has_noise && !b.context.noise.stated && sensor.type == "ranger")
      warn_once(b.context, property.at,
                "the first number of 'noise' is a standard deviation here, but a variance in Stage: --stage-noise or "
                "the world key stage_noise 1 reads it as a variance, stage_noise 0 confirms a standard deviation");
    sensor.settings.push_back(std::move(setting));
  }
}

}  // namespace

void add_sensors(BuildState& b, const Entity& entity, const Model& model, const SensorKeyword& word, const Pose& X_MB,
                 double height, const std::string& name) {
  if (model.mover == kNone) {
    warn(b.context, entity.at,
         fmt::format("'{}' is not mounted on a robot: kept as a body that measures nothing", entity.word));
    return;
  }
  const Mover& carrier = b.world.movers[model.mover];
  const bool at_rest = carrier.is_tag ? carrier.controller.empty() : carrier.controller == "none";
  if (word.type == "loop" && !at_rest)
    warn(b.context, entity.at,
         fmt::format("'{}' moves with '{}', and link-speed takes it to stay where it starts; mount it on a robot at "
                     "rest (ctrl \"none\") or on an object (tag<N>)",
                     name, carrier.name));
  auto& sensors = b.world.movers[model.mover].sensors;
  const std::size_t before = sensors.size();
  const auto add = [&](const Entity& from, const Pose& X_MS, double high, std::string_view color) -> Sensor& {
    sensors.push_back({std::string(word.type),
                       name,
                       X_MS,
                       high,
                       b.context.metres_per_unit,
                       b.context.radians_per_unit,
                       {},
                       from.at.line,
                       b.context.document.files[from.at.file]});
    sensors.back().color = entity_color(b.context, from, color, sensors.back().color, 0);
    return sensors.back();
  };
  if (word.block_keys.empty() || find(entity, "scount") != nullptr)
    add_settings(b, entity, word.keys, add(entity, X_MB, height, "laser_color"));
  if (!word.table_key.empty() && sensors.size() > before)
    for (const Setting& setting : sensors.back().settings)
      if (setting.key == word.table_key && !setting.text.empty()) add_beam_table(b.world, setting);
  for (const Entity& block : entity.children) {
    if (block.type != "sensor" || word.block_keys.empty()) continue;
    Pose X_BS = pose(b.context, block, "pose");
    X_BS.z += size_of(b.context, block, {kBlockHeight, kBlockHeight, kBlockHeight}).z / 2.0;
    Sensor& sensor = add(block, compose(X_MB, X_BS), 0.0, "color");
    add_settings(b, block, word.block_keys, sensor);
    add_settings(b, entity, kOfAllBlocks, sensor);
  }
  if (sensors.size() == before)
    warn(b.context, entity.at, fmt::format("'{}' measures nothing: no sensor( ) and no scount in it", entity.word));
}

void add_magnet(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B) {
  StageContext& context = b.context;
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
    fail(context, entity.at, "a magnet requires a 'size' above zero in x and y: half the smaller one is its radius");
  auto& magnets = model.mover == kNone ? b.world.magnets : b.world.movers[model.mover].magnets;
  magnets.push_back(magnet);
}

}  // namespace sf::world
