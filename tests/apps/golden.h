#pragma once
// Golden records of the complete outputs of commands and reports.

#include <string>
#include <string_view>

namespace sf {

/// Returns `text` without machine-dependent parts: times and rates, devices, hashes, folders. Decimals are rounded to
/// six digits, since a libm may differ in the last bit.
/// @param folder of the test, replaced by FOLDER in the record
std::string without_machine(std::string text, const std::string& folder = "");

/// Compares with tests/apps/golden/NAME.txt (tests/golden.h).
void expect_golden(std::string_view name, const std::string& text);

}  // namespace sf
