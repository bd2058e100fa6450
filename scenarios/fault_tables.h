#pragma once
// [[fault]] tables: faults of sensors in scenario files and in recordings.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "farm/fault.h"
#include "record/recording.h"
#include "world/toml_reader.h"

namespace sf::scenarios {

/// Reads the [[fault]] tables of a file. @throws base::InputError with file and line
std::vector<farm::Fault> read_faults(const world::TomlReader& reader, const world::TomlNode& root);

/// Reads a file that contains [[fault]] tables only. @throws base::InputError with file and line
std::vector<farm::Fault> parse_faults(const std::string& file, std::string_view text);

/// Writes the faults as tables that read back as the same faults, for recordings.
std::string faults_text(std::span<const farm::Fault> faults);

/// Returns the faults of a recorded run. @throws base::InputError if they cannot be read
std::vector<farm::Fault> recorded_faults(const record::Recording& recording);

}  // namespace sf::scenarios
