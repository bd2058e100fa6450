#pragma once
// Tables of beam directions, for patterns that are not rings: CSV with a heading, one beam per line in the order of the
// scan. Columns, in any order: `azimuth_deg`, `elevation_deg` or `zenith_deg`, and optionally `time_s`; also as in the
// tables that Livox publishes: `Time/s,Azimuth/deg,Zenith/deg`. Others are ignored.

#include <string>
#include <string_view>

#include "world/world.h"

namespace sf::world {

/// Returns the rows of a text, and whether it has times. @param file for errors
/// @throws base::InputError with file and line
BeamTable parse_beam_table(const std::string& file, std::string_view text);

/// Returns the table that a setting names; null: it is not in the world.
const BeamTable* find_beam_table(const World& world, const Setting& setting);

/// Reads the table that a setting names, unless the world has it. @throws base::InputError with file and line
void add_beam_table(World& world, const Setting& setting);

}  // namespace sf::world
