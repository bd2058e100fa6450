#pragma once
// Templates of robots, objects and lights that may join a running service (`serve --join`).

#include <cstdint>
#include <string>
#include <vector>

#include "world/world.h"

namespace sf::apps {

inline constexpr std::size_t kMostJoining = 1000;               ///< robots, objects and lights in all
inline constexpr std::size_t kMostJoiningOutlines = 1'000'000;  ///< pieces of their outlines in all

struct Joining {
  std::vector<std::uint32_t> rows;  ///< of `World::movers`
  std::size_t robots = 0, objects = 0, lights = 0;
};

/// Appends the copies of `wishes`, each "NAME=FIRST-LAST" or "NAME=ID", with names such as roomba1_100 or box_12.
/// @throws base::InputError for a wish in another form, an unknown name, a taken id, or beyond the limits above
Joining append_joining(world::World& world, const std::vector<std::string>& wishes);

/// "3 robots and 2 lights"
std::string joining_text(const Joining& joining);

}  // namespace sf::apps
