#pragma once
// Folders of numbered files, which other programs read as one sequence.

#include <string>

namespace sf::apps {

/// Makes the folder if needed, and removes files of an earlier call from it, so that no sequence is made of both:
/// those named `prefix`, six or more digits, `suffix`. A message states how many. Other files stay.
/// @throws base::InputError for a folder that cannot be made, or a file that cannot be removed
void begin_numbered_files(const std::string& folder, const std::string& prefix, const std::string& suffix);

}  // namespace sf::apps
