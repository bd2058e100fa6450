#pragma once
// Robots that may join a service, which no world file names (`serve --join`).

#include <cstdint>
#include <string>
#include <vector>

#include "world/world.h"

namespace sf::apps {

inline constexpr std::size_t kMostJoining = 1000;  ///< robots in all

/// Appends the copies of `wishes`, each "ROBOT=FIRST-LAST" or "ROBOT=ID", with names such as roomba1_100.
/// @return their rows
/// @throws base::InputError for a wish in another form, an unknown robot, a taken id, or more than kMostJoining robots
std::vector<std::uint32_t> append_joining(world::World& world, const std::vector<std::string>& wishes);

}  // namespace sf::apps
