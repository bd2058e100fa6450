#pragma once
// Does it hold at the ends of the range? Every end is a case: a small world made in memory, read through the farm, and
// compared with an answer that owes nothing to the farm.
//
//   Fixture fixture(device);
//   for (const Case& c : cases()) report(c, run(c, fixture));

#include <span>
#include <string_view>

#include "selftest/case.h"
#include "selftest/fixture.h"

namespace sf::selftest {

/// All there are, group by group.
std::span<const Case> cases();
/// In none of them: fails on purpose, so that anyone can see how a wrong answer is told, and that it ends with exit 1.
const Case& failing_case();
/// @return null when none is called that.
const Case* find_case(std::string_view name);

/// Whatever it throws is a failure of the case.
Outcome run(const Case& c, Fixture& fixture);

// The groups, each a source of its own.
std::span<const Case>
world_size_cases();                     ///< worlds from 1 mm to 1 000 km, up to 1e7 m away, ranges from 1 um to 100 km
std::span<const Case> beam_cases();     ///< grazing, along walls, through corners, from on a wall and from inside
std::span<const Case> segment_cases();  ///< points, slivers, a million in one cell
std::span<const Case> scan_cases();     ///< numbers of samples, fields of view, headings
std::span<const Case> fleet_cases();    ///< nobody, all in one place, a hundred thousand
std::span<const Case> magnet_cases();   ///< distances, moments, what cancels
std::span<const Case> lane_edge_cases();      ///< lane edges at every angle, and what is no edge
std::span<const Case> time_cases();           ///< ticks of 1 us and 10 s, tick 1e9, a year
std::span<const Case> number_cases();         ///< not-a-number, infinity, denormals in packets, poses and commands
std::span<const Case> file_cases();           ///< likewise in files
std::span<const Case> wire_format_cases();    ///< words at and past their ends
std::span<const Case> accuracy_mode_cases();  ///< accuracy modes: within what they state, flagged where not
std::span<const Case> device_cases();         ///< this device beside plain C++, and 32 bits beside the farm

}  // namespace sf::selftest
