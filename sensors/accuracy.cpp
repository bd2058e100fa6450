#include "sensors/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "base/error.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::string_view kExact = "exact";

const Mode* find_mode(std::span<const Mode> modes, std::string_view word) {
  const auto found = std::find_if(modes.begin(), modes.end(), [&](const Mode& mode) { return mode.word == word; });
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

/// Of a file's line, or of the command line.
[[noreturn]] void refuse(const world::World& world, const world::Accuracy& at, const std::string& message) {
  throw base::InputError(at.file.empty() ? world.file : at.file, at.line, message);
}

}  // namespace

std::uint8_t mode_of(std::span<const Mode> modes, const world::Accuracy& own, const world::World& world) {
  const world::Accuracy& asked = own.word.empty() ? world.accuracy : own;
  for (const std::string& word : words_in(asked.word))
    if (const Mode* const mode = find_mode(modes, word)) return static_cast<std::uint8_t>(mode - modes.data());
  if (own.word.empty() || own.word == kExact) return 0;
  std::vector<std::string_view> words;
  for (const Mode& known : modes) words.push_back(known.word);
  if (words.empty()) words.push_back(kExact);
  refuse(world, own, fmt::format("'accuracy' is \"{}\"; this sensor knows {}", own.word, listed(words)));
}

world::Accuracy accuracy_of(const world::Sensor& sensor) {
  const world::Setting* const setting = find(sensor, "accuracy");
  if (setting == nullptr) return {};
  if (setting->text.empty()) refuse(sensor, "accuracy", "'accuracy' expects a word, as in: accuracy \"exact\"");
  return {setting->text, setting->file, setting->line};
}

namespace {

void check_word(const world::World& world, std::span<const SensorKind* const> present, const std::string& word) {
  if (word == kExact) return;
  const auto knows = [&](const SensorKind* kind) { return find_mode(kind->modes, word) != nullptr; };
  if (std::any_of(present.begin(), present.end(), knows)) return;
  const auto all = kinds();
  if (std::none_of(all.begin(), all.end(), knows))
    refuse(world, world.accuracy,
           fmt::format("there is no accuracy \"{}\"; expected one of {}", word, listed(accuracy_words())));
  std::string who;
  for (const SensorKind* kind : all)
    if (knows(kind)) who += fmt::format("{}{}", who.empty() ? "" : ", ", kind->name);
  refuse(world, world.accuracy,
         fmt::format("accuracy \"{}\" is for {}, and the world has no such sensor; leave it out", word, who));
}

}  // namespace

void check_accuracy(const world::World& world, std::span<const SensorKind* const> present) {
  for (const std::string& word : words_in(world.accuracy.word)) check_word(world, present, word);
}

std::vector<std::string_view> accuracy_words() {
  std::vector<std::string_view> words{kExact};
  for (const SensorKind* kind : kinds())
    for (const Mode& mode : kind->modes)
      if (std::find(words.begin(), words.end(), mode.word) == words.end()) words.push_back(mode.word);
  return words;
}

std::string_view word_of(const SensorKind& kind, std::uint8_t mode) {
  return kind.modes.empty() ? kExact : kind.modes[mode].word;
}

}  // namespace sf::sensors
