#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "base/installation.h"
#include "world/stage/document.h"

namespace sf::world {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

std::string find_file(const Document& document, SourceLocation from, const std::string& name) {
  if (name.empty()) return {};
  const fs::path wanted(name);
  if (wanted.is_absolute()) return is_file(wanted) ? wanted.lexically_normal().string() : std::string();

  std::vector<fs::path> folders{fs::path(document.files[from.file]).parent_path(),
                                fs::path(document.files[0]).parent_path()};
  if (const char* path = std::getenv("STAGEPATH")) {
    std::istringstream list(path);
    for (std::string folder; std::getline(list, folder, ':');) folders.emplace_back(folder);
  }
  for (const fs::path& folder : folders) {
    const fs::path candidate = (folder / wanted).lexically_normal();
    if (is_file(candidate)) return candidate.string();
  }
  const std::string shipped = base::installed_file("worlds/" + name);
  return is_file(shipped) ? shipped : std::string();
}

std::string file_in_stage(const Document& document, const std::string& name, const std::string& found) {
  const fs::path candidate = (fs::path(document.files[0]).parent_path() / name).lexically_normal();
  return candidate != fs::path(found) && is_file(candidate) ? candidate.string() : std::string();
}

}  // namespace sf::world
