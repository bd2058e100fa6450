#include "sensors/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "base/error.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::string_view kExact = "exact";

/// Returns the mode of sensor type `type` called `word`, which may have a prefix "type:"; null if there is none.
const AccuracyMode* find_mode(std::string_view type, std::span<const AccuracyMode> modes, std::string_view word) {
  const std::size_t colon = word.find(':');
  if (colon != std::string_view::npos && word.substr(0, colon) != type) return nullptr;
  const std::string_view own = colon == std::string_view::npos ? word : word.substr(colon + 1);
  const auto found =
      std::find_if(modes.begin(), modes.end(), [&](const AccuracyMode& mode) { return mode.word == own; });
  return found == modes.end() ? nullptr : &*found;
}

std::vector<std::string> words_in(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

std::string listed(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", word);
  return text;
}

/// Throws an error at a line of the file, or at the command line.
[[noreturn]] void refuse_mode(const world::Accuracy& at, const std::string& message) {
  throw base::InputError(at.file.empty() ? "--accuracy" : at.file, at.line, message);
}

}  // namespace

std::uint8_t mode_of(std::string_view type, std::span<const AccuracyMode> modes, const world::Accuracy& own,
                     const world::World& world) {
  const world::Accuracy& asked = own.word.empty() ? world.accuracy : own;
  for (const std::string& word : words_in(asked.word))
    if (const AccuracyMode* const mode = find_mode(type, modes, word))
      return static_cast<std::uint8_t>(mode - modes.data());
  if (own.word.empty() || own.word == kExact) return 0;
  std::vector<std::string_view> words;
  for (const AccuracyMode& known : modes) words.push_back(known.word);
  if (words.empty()) words.push_back(kExact);
  refuse_mode(own, fmt::format("'accuracy' is \"{}\"; this sensor supports {}", own.word, listed(words)));
}

world::Accuracy accuracy_of(const world::Sensor& sensor) {
  const world::Setting* const setting = find(sensor, "accuracy");
  if (setting == nullptr) return {};
  if (setting->text.empty()) refuse(sensor, "accuracy", "'accuracy' expects a word, as in: accuracy \"exact\"");
  return {setting->text, setting->file, setting->line};
}

namespace {

void check_word(const world::World& world, std::span<const SensorType* const> present, const std::string& word) {
  if (word == kExact) return;
  const auto knows = [&](const SensorType* type) { return find_mode(type->name, type->modes, word) != nullptr; };
  if (std::any_of(present.begin(), present.end(), knows)) return;
  const auto all = sensor_types();
  if (std::none_of(all.begin(), all.end(), knows))
    refuse_mode(world.accuracy,
                fmt::format("there is no accuracy \"{}\"; expected one of {}", word, listed(accuracy_words())));
  std::string who;
  for (const SensorType* type : all)
    if (knows(type)) who += fmt::format("{}{}", who.empty() ? "" : ", ", type->name);
  refuse_mode(world.accuracy,
              fmt::format("accuracy \"{}\" is for {}, and the world has no such sensor; leave it out", word, who));
}

/// Types with modes check their sensors' words in `mode_of`. Other types accept only `exact`.
void check_sensor(const world::World& world, const world::Sensor& sensor) {
  const auto all = sensor_types();
  const auto type = std::find_if(all.begin(), all.end(), [&](const auto* k) { return k->word.type == sensor.type; });
  if (type != all.end() && (*type)->modes.empty()) mode_of((*type)->name, {}, accuracy_of(sensor), world);
}

}  // namespace

void check_accuracy(const world::World& world, std::span<const SensorType* const> present) {
  for (const std::string& word : words_in(world.accuracy.word)) check_word(world, present, word);
  for (const world::Mover& mover : world.movers)
    for (const world::Sensor& sensor : mover.sensors) check_sensor(world, sensor);
}

void set_accuracy(world::World& world, const std::string& words) {
  world.accuracy = {words, "", 0};
  for (world::Mover& mover : world.movers)
    for (world::Sensor& sensor : mover.sensors)
      std::erase_if(sensor.settings, [](const world::Setting& setting) { return setting.key == "accuracy"; });
  world::update_extent_and_hash(world);
}

std::vector<std::string_view> accuracy_words() {
  std::vector<std::string_view> words{kExact};
  for (const SensorType* type : sensor_types())
    for (const AccuracyMode& mode : type->modes)
      if (std::find(words.begin(), words.end(), mode.word) == words.end()) words.push_back(mode.word);
  return words;
}

namespace {

/// Settings that determine a sensor's bound.
using Alike = std::tuple<std::uint8_t, double, double, double, std::uint32_t>;

/// @param known bounds computed so far
const ErrorBound& bound_of(const world::World& world, const SensorSet::Group& group, std::size_t i,
                           std::map<Alike, ErrorBound>& known) {
  const SensorSpec& row = group.rows[i];
  const auto [at, is_new] = known.try_emplace(
      Alike{row.mode, row.sigma, row.limit, world.movers[row.mover].X_WM.z + row.X_MS.z, row.elements}, ErrorBound{});
  if (is_new) at->second = group.type->bound(world, group, i);
  return at->second;
}

}  // namespace

std::vector<AccuracyStatement> accuracy_statements(const world::World& world, const SensorSet& sensor_set) {
  std::vector<AccuracyStatement> statements;
  for (const SensorSet::Group& group : sensor_set.groups()) {
    if (group.type->bound == nullptr) continue;
    const std::size_t first = statements.size();
    std::map<Alike, ErrorBound> known;
    for (std::size_t i = 0; i < group.rows.size(); ++i) {
      const SensorSpec& row = group.rows[i];
      const ErrorBound& bound = bound_of(world, group, i, known);
      const auto same = std::find_if(
          statements.begin() + static_cast<std::ptrdiff_t>(first), statements.end(), [&](const AccuracyStatement& s) {
            return s.mode == row.mode && s.bound.error == bound.error && s.sigma == row.sigma;
          });
      if (same != statements.end())
        ++same->sensors;
      else
        statements.push_back({group.type, row.mode, 1, bound, row.sigma});
    }
  }
  return statements;
}

std::string modes_of(const SensorSet& sensor_set) {
  std::string text;
  for (const SensorSet::Group& group : sensor_set.groups()) {
    std::set<std::uint8_t> modes;
    for (const SensorSpec& row : group.rows)
      if (row.mode > 0) modes.insert(row.mode);
    for (const std::uint8_t mode : modes)
      text += fmt::format("{}{}:{}", text.empty() ? "" : " ", group.type->name, word_of(*group.type, mode));
  }
  return text.empty() ? std::string(kExact) : text;
}

std::string_view unit_of(const SensorType& type) {
  const std::string_view column = type.columns.front().name;
  return column.ends_with("_m") ? "m" : column.ends_with("_T") ? "T" : "";
}

std::string_view word_of(const SensorType& type, std::uint8_t mode) {
  return type.modes.empty() ? kExact : type.modes[mode].word;
}

}  // namespace sf::sensors
