#pragma once
// `plot --allan`: draws the Allan deviations of recorded gyros and inertial measurement units, and those that follow
// from their settings.

#include "record/recording.h"
#include "viz/series_figure.h"
#include "world/world.h"

namespace sf::apps {

/// Returns a panel per sensor and quantity, at most 16, of recorded robots at rest; motion counts as noise.
/// @throws base::InputError if no such readings are recorded, too few, or with gaps
viz::SeriesOptions allan_figure(const record::Recording& recording, const world::World& world);

}  // namespace sf::apps
