#pragma once
// The page's files (viz/web/), compiled into the program.

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "bridges/web_server.h"

namespace sf::bridges {

/// One file of viz/web, converted to a source by cmake/WebFiles.cmake.
struct EmbeddedFile {
  std::string_view name;
  std::string_view text;
};
extern const EmbeddedFile kEmbeddedFiles[];
extern const std::size_t kEmbeddedFileCount;

/// Returns the files by path; "/" is the page.
std::map<std::string, WebFile> web_files();

}  // namespace sf::bridges
