#include "sensors/sensor_type.h"

#include <algorithm>

namespace sf::sensors {

void SensorBackend::take_over(SensorBackend& before, std::uint32_t rows) {
  base::Bytes state;
  base::ByteWriter out(state);
  for (std::uint32_t row = 0; row < rows; ++row) before.write_state(row, out);
  base::ByteReader in(state);
  for (std::uint32_t row = 0; row < rows; ++row) read_state(row, in);
}

const SensorType* find_sensor_type(std::uint8_t id) {
  const auto all = sensor_types();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SensorType* type) { return type->id == id; });
  return found == all.end() ? nullptr : *found;
}

namespace {

std::vector<const SensorType*>& all_types() {
  static std::vector<const SensorType*> types(built_in_sensor_types().begin(), built_in_sensor_types().end());
  return types;
}

std::vector<world::SensorKeyword> words_of_all() {
  std::vector<world::SensorKeyword> words;
  for (const SensorType* type : sensor_types())
    for (const world::SensorKeyword& word : {type->word, type->other_word})
      if (!word.type.empty()) words.push_back(word);
  return words;
}

std::vector<world::SensorKeyword>& all_words() {
  static std::vector<world::SensorKeyword> words = words_of_all();
  return words;
}

}  // namespace

std::span<const SensorType* const> sensor_types() { return all_types(); }

void add_sensor_type(const SensorType* type) {
  const auto after =
      std::find_if(all_types().begin(), all_types().end(), [&](const auto* t) { return t->id > type->id; });
  all_types().insert(after, type);
  all_words() = words_of_all();
}

std::span<const world::SensorKeyword> world_file_words() { return all_words(); }

}  // namespace sf::sensors
