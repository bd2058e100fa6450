#pragma once
// World and states of a recording, as a farm takes them.

#include <cstdint>
#include <span>
#include <vector>

#include "base/report.h"
#include "farm/farm.h"
#include "record/recording.h"
#include "world/world.h"

namespace sf::scenarios {

/// @throws base::InputError where the world cannot be read, or is not the one of the recorded movers
world::World recorded_world(const record::Recording& recording);

/// Each tick has the states of all movers.
bool has_all_states(const record::Recording& recording);

/// The states of all movers at a tick, by mover. @pre has_all_states
void recorded_reports(const record::Recording& recording, std::size_t tick, std::vector<base::Report>& reports);

/// Takes movers that are absent out of the farm, and all sensors of the others into it.
void set_absent(std::span<const base::Report> reports, farm::Farm& farm);

}  // namespace sf::scenarios
