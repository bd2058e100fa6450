#include "apps/commands/numbered_files.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

#include "apps/reports/text.h"
#include "base/error.h"
#include "scenarios/experiment.h"

namespace sf::apps {

namespace {

namespace fs = std::filesystem;

bool is_numbered(std::string_view name, const std::string& prefix, const std::string& suffix) {
  constexpr std::size_t kDigits = 6;
  if (name.size() < prefix.size() + kDigits + suffix.size()) return false;
  if (!name.starts_with(prefix) || !name.ends_with(suffix)) return false;
  const std::string_view number = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
  return std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

void begin_numbered_files(const std::string& folder, const std::string& prefix, const std::string& suffix) {
  scenarios::make_folder(folder);
  std::vector<fs::path> old;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (is_numbered(entry.path().filename().string(), prefix, suffix) && !entry.is_directory(error))
      old.push_back(entry.path());
  for (const fs::path& file : old)
    if (!fs::remove(file, error) && error)
      throw base::InputError(
          file.string(), 0,
          "was written by an earlier call and cannot be removed (" + error.message() + "); name another folder");
  if (!old.empty())
    print_message("removed {} of an earlier call ({}NNNNNN{}) from {}", counted(old.size(), "file"), prefix, suffix,
                  folder);
}

}  // namespace sf::apps
