#pragma once
// Does it hold at the ends of the range? Every end is a case: a small world made in memory, read through the farm, and
// compared with an answer that owes nothing to the farm.
//
//   Lab lab(device);
//   for (const Case& c : cases()) report(c, run(c, lab));

#include <span>
#include <string_view>

#include "extremes/case.h"
#include "extremes/lab.h"

namespace sf::extremes {

/// All there are, group by group.
std::span<const Case> cases();
/// In none of them: fails on purpose, so that anyone can see how a wrong answer is told, and that it ends with exit 1.
const Case& failure();
/// @return null when none is called that.
const Case* find_case(std::string_view name);

/// Whatever it throws is a failure of the case.
Outcome run(const Case& c, Lab& lab);

// The groups, each a source of its own.
std::span<const Case> places();    ///< worlds from 1 mm to 1 000 km, up to 1e7 m away, ranges from 1 um to 100 km
std::span<const Case> beams();     ///< grazing, along walls, through corners, from on a wall and from inside
std::span<const Case> segments();  ///< points, slivers, a million in one cell
std::span<const Case> fans();      ///< numbers of samples, fields of view, headings
std::span<const Case> fleets();    ///< nobody, all in one place, a hundred thousand
std::span<const Case> magnets();   ///< distances, moments, what cancels
std::span<const Case> edges();     ///< lane edges at every angle, and what is no edge
std::span<const Case> times();     ///< ticks of 1 us and 10 s, tick 1e9, a year
std::span<const Case> numbers();   ///< not-a-number, infinity, denormals in packets, poses and commands
std::span<const Case> files();     ///< likewise in files
std::span<const Case> wires();     ///< words at and past their ends
std::span<const Case> modes();     ///< accuracy modes: within what they state, flagged where not
std::span<const Case> devices();   ///< this device beside plain C++, and 32 bits beside the farm

}  // namespace sf::extremes
