#pragma once
// The dial: which of its kind's modes each sensor measures in.
//
// A world file says `accuracy "word"` for all sensors, or inside one of them; the command line's word comes before
// both. Several words, with spaces between, are for several kinds: a sensor takes the first that its kind knows, and is
// exact when there is none.

#include <string>
#include <string_view>
#include <vector>

#include "sensors/kind.h"

namespace sf::sensors {

/// Row of `modes` that a sensor measures in.
/// @param own what its place in the world file says  @throws base::InputError, there, for a word that is not among them
std::uint8_t mode_of(std::span<const Mode> modes, const world::Accuracy& own, const world::World& world);

/// `accuracy "word"` among a sensor's settings.
world::Accuracy accuracy_of(const world::Sensor& sensor);

/// @throws base::InputError when no kind knows the world's word, or none that the world has sensors of.
void check_accuracy(const world::World& world, std::span<const SensorKind* const> present);

/// Every word that some kind knows, `exact` first, in order of the kinds.
std::vector<std::string_view> accuracy_words();

/// The word of a mode: `exact` for kinds without modes.
std::string_view word_of(const SensorKind& kind, std::uint8_t mode);

}  // namespace sf::sensors
