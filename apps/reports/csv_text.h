#pragma once
// Fields of CSV files (RFC 4180).

#include <string>

#include "base/csv.h"

namespace sf::apps {

using base::csv_field;
/// Returns the shortest text that parses to the same number; empty for NaN.
std::string csv_number(double value);

}  // namespace sf::apps
