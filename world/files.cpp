#include "world/entities.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.h"

namespace sf::world {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMostBytes = 64u << 20;

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

std::string find_file(const Document& document, Place from, const std::string& name) {
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
  return {};
}

std::string read_text(const std::string& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw base::InputError(file, 0, "no such file; give the path of a file that is there");
  if (!is_file(file)) throw base::InputError(file, 0, "not a file; give the path of a file that is there");
  if (fs::file_size(file, error) > kMostBytes || error) {
    throw base::InputError(file, 0, fmt::format("larger than {} MiB: not a world file", kMostBytes >> 20));
  }
  std::ifstream in(file, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  if (!in) throw base::InputError(file, 0, "cannot be read; check its permissions");
  return content.str();
}

}  // namespace sf::world
