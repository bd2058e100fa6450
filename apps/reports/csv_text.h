#pragma once
// Fields of CSV files (RFC 4180).

#include <string>

namespace sf::apps {

/// In quotes where a comma, a quote or a line end would be misread.
std::string csv_field(const std::string& text);
/// The shortest text that reads back as the same number; empty for not-a-number.
std::string csv_number(double value);

}  // namespace sf::apps
