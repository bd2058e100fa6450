#pragma once
// Results as JUnit XML for continuous integration: one suite per scenario, one test case per expectation.

#include <span>
#include <string>
#include <string_view>

#include "scenarios/runner.h"

namespace sf::scenarios {

/// Escapes XML's reserved characters and removes forbidden control characters.
std::string escaped(std::string_view text);

std::string junit_of(std::span<const ScenarioResult> results);

}  // namespace sf::scenarios
