#pragma once
// The self-test of a driver, device and processor. Each case checks one limit of the farm's range: it creates a small
// world in memory, reads it through the farm, and compares the result with one computed independently of the farm.
// Limits that do not depend on the machine, such as those of files and packets, are unit tests.
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
world_size_cases();  ///< worlds from 1 mm to 1 000 km, up to 1e7 m away, ranges from 1 um to 100 km, denormal poses
std::span<const Case> beam_cases();           ///< grazing, along walls, through corners, from on a wall and from inside
std::span<const Case> segment_cases();        ///< walls of zero length, slivers, a million walls in one cell
std::span<const Case> scan_cases();           ///< numbers of samples, fields of view, headings
std::span<const Case> fleet_cases();          ///< no robots, all at one place, a hundred thousand
std::span<const Case> magnet_cases();         ///< distances, moments, cancellation
std::span<const Case> lane_edge_cases();      ///< lane edges at every angle, and points that do not form an edge
std::span<const Case> lidar_cases();          ///< far away, in the planes of faces, large and small faces
std::span<const Case> accuracy_mode_cases();  ///< errors within the stated bounds, flags elsewhere
std::span<const Case>
device_cases();  ///< this device, also after a year, and 32-bit arithmetic compared with plain C++

}  // namespace sf::selftest
