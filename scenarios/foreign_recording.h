#pragma once
// Recordings of other programs as inputs of derived sensors: MCAP with ROS 2 messages, and CSV.

#include <string>

#include "scenarios/derive_file.h"
#include "scenarios/derived_replay.h"
#include "scenarios/foreign_sensors.h"

namespace sf::scenarios {

/// Reads the inputs of `file` from a recording: an MCAP file, a CSV file, or a folder of such files. Their world has
/// the file's robots, whose poses are unknown, with sensors for the inputs. Time 0 is that of the first reading:
/// `kTimeZero` of the run's options.
///
/// A NavSatFix becomes x (east) and y (north) [m] on a plane that touches WGS84 at the origin, at the ellipsoid's
/// height: a distance d from the origin is short by d^3 / (6 R^2), 4 mm at 10 km and 4 m at 100 km.
/// @throws base::InputError naming the file, and the available names, if a topic, column or unit does not exist; for
/// malformed messages and rows; and for more than 5e6 states (5e5 s times robots, in ticks of 0.1 s)
DerivedSource read_foreign(const std::string& recording, const DeriveFile& file);

}  // namespace sf::scenarios
