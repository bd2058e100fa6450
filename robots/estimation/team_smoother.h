#pragma once
// A fixed-interval smoother of a team: estimates from all readings, also from later ones (Rauch, Tung and Striebel).

#include <cstdint>
#include <functional>
#include <vector>

#include "robots/estimation/team_state.h"

namespace sf::estimation {

/// Readings of a whole run, in any order.
struct TeamReadings {
  std::vector<TeamEvent> events;            ///< poses and sightings; of each robot only the first pose is used
  std::vector<std::vector<Speeds>> speeds;  ///< by robot
};

/// Returns the estimates of each robot at the given times [ns], sorted; those before a robot's start are left out.
/// Memory grows with the square root of the number of events, if `stop` is empty or returns false; else it returns
/// early with estimates missing.
/// @param times by robot, sorted
std::vector<std::vector<Estimate>> smooth(const Team& team, TeamReadings readings,
                                          std::span<const std::vector<std::int64_t>> times,
                                          const std::function<bool()>& stop = {});

}  // namespace sf::estimation
