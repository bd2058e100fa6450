#include <algorithm>

#include "sensors/kind.h"

namespace sf::sensors {

const SensorKind* find_sensor_type(std::uint8_t id) {
  const auto all = kinds();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SensorKind* kind) { return kind->id == id; });
  return found == all.end() ? nullptr : *found;
}

std::span<const world::SensorKeyword> vocabulary() {
  static const std::vector<world::SensorKeyword> words = [] {
    std::vector<world::SensorKeyword> all;
    for (const SensorKind* kind : kinds())
      if (!kind->word.type.empty()) all.push_back(kind->word);
    return all;
  }();
  return words;
}

}  // namespace sf::sensors
