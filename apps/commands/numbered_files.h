#pragma once
// Folders of numbered files, which other programs read as a sequence.

#include <string>

namespace sf::apps {

/// Creates the folder if needed and removes the files of an earlier call from it, so that the two sequences do not mix.
/// Removes files named `prefix`, six or more digits, `suffix`, and prints how many; other files stay.
/// @throws base::InputError if the folder cannot be created or a file cannot be removed
void begin_numbered_files(const std::string& folder, const std::string& prefix, const std::string& suffix);

}  // namespace sf::apps
