#pragma once
// The self-test. Each case checks one limit of the farm's range: it creates a small world in memory, reads it through
// the farm, and compares the result with one computed independently of the farm.
//
//   Fixture fixture(device);
//   for (const Case& c : cases()) report(c, run(c, fixture));

#include <span>
#include <string_view>

#include "selftest/case.h"
#include "selftest/fixture.h"

namespace sf::selftest {

/// Returns all cases, group by group.
std::span<const Case> cases();
/// Returns a case that fails on purpose, to demonstrate the output of a failure and exit code 1. Not part of cases().
const Case& failing_case();

/// Runs a case. An exception is a failure of the case.
/// @throws base::Interrupted if the fixture's `stop` ended it
Outcome run(const Case& c, Fixture& fixture);

// The groups, each in its own source file.
std::span<const Case>
world_size_cases();                     ///< worlds from 1 mm to 1 000 km, up to 1e7 m away, ranges from 1 um to 100 km
std::span<const Case> beam_cases();     ///< grazing, along walls, through corners, from on a wall and from inside
std::span<const Case> segment_cases();  ///< points, slivers, a million walls in one cell
std::span<const Case> scan_cases();     ///< numbers of samples, fields of view, headings
std::span<const Case> fleet_cases();    ///< no robots, all at one place, a hundred thousand
std::span<const Case> magnet_cases();   ///< distances, moments, cancellation
std::span<const Case> lane_edge_cases();      ///< lane edges at every angle, and points that do not form an edge
std::span<const Case> time_cases();           ///< ticks of 1 us and 10 s, tick 1e9, a year
std::span<const Case> number_cases();         ///< NaN, infinity and denormals in packets, poses and commands
std::span<const Case> file_cases();           ///< the same in files
std::span<const Case> wire_format_cases();    ///< values at and beyond the limits of the wire formats
std::span<const Case> accuracy_mode_cases();  ///< errors within the stated bounds, flags elsewhere
std::span<const Case> device_cases();         ///< this device and 32-bit arithmetic compared with plain C++

}  // namespace sf::selftest
