#pragma once
// World and states of a recording, in the form that a farm accepts.

#include <cstdint>
#include <span>
#include <vector>

#include "base/report.h"
#include "farm/farm.h"
#include "record/recording.h"
#include "world/world.h"

namespace sf::scenarios {

/// @throws base::InputError if the world cannot be read, or does not match the recorded movers
world::World recorded_world(const record::Recording& recording);

/// Returns whether each tick has the states of all movers.
bool has_all_states(const record::Recording& recording);

/// Returns the states of all movers at a tick, by mover.
/// @pre has_all_states
void recorded_reports(const record::Recording& recording, std::size_t tick, std::vector<base::Report>& reports);

/// Removes absent movers from the farm, and subscribes all sensors of the others.
void set_absent(std::span<const base::Report> reports, farm::Farm& farm);

}  // namespace sf::scenarios
