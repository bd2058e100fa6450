#include <algorithm>

#include "sensors/sensor_type.h"

namespace sf::sensors {

const SensorType* find_sensor_type(std::uint8_t id) {
  const auto all = sensor_types();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SensorType* kind) { return kind->id == id; });
  return found == all.end() ? nullptr : *found;
}

std::span<const world::SensorKeyword> world_file_words() {
  static const std::vector<world::SensorKeyword> words = [] {
    std::vector<world::SensorKeyword> all;
    for (const SensorType* kind : sensor_types())
      if (!kind->word.type.empty()) all.push_back(kind->word);
    return all;
  }();
  return words;
}

}  // namespace sf::sensors
