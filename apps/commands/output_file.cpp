#include "apps/commands/output_file.h"

#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace sf::apps {

namespace {

[[noreturn]] void refuse_output(const std::string& path) {
  throw base::InputError(path, 0, "cannot be written; name a file in a folder that exists and can be written");
}

}  // namespace

void check_writable(const std::string& path) {
  std::error_code error;
  const bool there = std::filesystem::exists(path, error);
  if (!std::ofstream(path, std::ios::binary | std::ios::app)) refuse_output(path);
  if (!there) std::filesystem::remove(path, error);
}

void write_text(const std::string& path, std::string_view text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) refuse_output(path);
}

}  // namespace sf::apps
