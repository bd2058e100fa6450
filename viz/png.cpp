#include "viz/png.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace sf::viz {

void write_picture(const std::string& path, std::string_view bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (file) file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file) file.close();
  if (!file)
    throw base::InputError(path, 0,
                           std::string("cannot write the picture (") +
                               (errno != 0 ? std::strerror(errno) : "unknown reason") +
                               "): name a file in a folder that exists, can be written and has room");
}

void replace_picture(const std::string& path, std::string_view bytes) {
  const std::string part = path + ".part";
  write_picture(part, bytes);
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (!error) return;
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  throw base::InputError(path, 0, "cannot be replaced by a new picture (" + error.message() + ")");
}

void write_png(const std::string& path, std::span<const std::uint8_t> rgb, int width, int height,
               base::PngContent content) {
  write_picture(path, base::encode_png(rgb, width, height, content));
}

}  // namespace sf::viz
