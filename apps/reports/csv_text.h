#pragma once
// Fields of CSV files (RFC 4180).

#include <string>

#include "base/csv.h"

namespace sf::apps {

using base::csv_field;
/// The shortest text that reads back as the same number; empty for not-a-number.
std::string csv_number(double value);

}  // namespace sf::apps
