#pragma once
// Results for continuous integration: JUnit's XML, a suite per scenario, a case per expectation.

#include <span>
#include <string>
#include <string_view>

#include "scenarios/runner.h"

namespace sf::scenarios {

/// With what XML reserves replaced, and what it forbids (control characters) left out.
std::string escaped(std::string_view text);

std::string junit_of(std::span<const ScenarioResult> results);

}  // namespace sf::scenarios
