#pragma once
// `plot --allan`: draws the Allan deviations of recorded gyros and inertial measurement units, and those that follow
// from their settings, or those of the columns of a table, such as the log of a real device.

#include <string>

#include "record/recording.h"
#include "viz/series_figure.h"
#include "world/world.h"

namespace sf::apps {

/// Returns a panel per sensor and quantity, at most 16, of recorded robots at rest; motion counts as noise.
/// @throws base::InputError if no such readings are recorded, too few, or with gaps
viz::SeriesOptions allan_figure(const record::Recording& recording, const world::World& world);

/// Returns a panel per column of numbers of a CSV file with a heading, at most 16. Its column `time_s` has the times of
/// the rows, at equal intervals.
/// @throws base::InputError with file and line for other tables, and for fewer than four rows
viz::SeriesOptions allan_figure_of_table(const std::string& file);

}  // namespace sf::apps
