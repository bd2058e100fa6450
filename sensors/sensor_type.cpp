#include <algorithm>

#include "sensors/sensor_type.h"

namespace sf::sensors {

const SensorType* find_sensor_type(std::uint8_t id) {
  const auto all = sensor_types();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SensorType* type) { return type->id == id; });
  return found == all.end() ? nullptr : *found;
}

std::span<const world::SensorKeyword> world_file_words() {
  static const std::vector<world::SensorKeyword> words = [] {
    std::vector<world::SensorKeyword> all;
    for (const SensorType* type : sensor_types())
      for (const world::SensorKeyword& word : {type->word, type->other_word})
        if (!word.type.empty()) all.push_back(word);
    return all;
  }();
  return words;
}

}  // namespace sf::sensors
