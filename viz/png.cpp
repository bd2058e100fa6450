#include "viz/png.h"

#include <spng.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "base/error.h"

namespace sf::viz {

namespace {

using Png = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

Png begin_png(int width, int height, std::uint8_t bits, std::uint8_t color) {
  Png png(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = bits;
  header.color_type = color;
  spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_ihdr(png.get(), &header);
  return png;
}

std::string finish_png(const Png& png, const void* pixels, std::size_t bytes) {
  int error = spng_encode_image(png.get(), pixels, bytes, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  std::size_t length = 0;
  const std::unique_ptr<void, decltype(&std::free)> file(
      error == 0 ? spng_get_png_buffer(png.get(), &length, &error) : nullptr, &std::free);
  SF_CHECK(file != nullptr && error == 0, std::string("spng did not create a PNG: ") + spng_strerror(error));
  return {static_cast<const char*>(file.get()), length};
}

}  // namespace

std::string encode_png(std::span<const std::uint8_t> rgb, int width, int height, PngContent content, double dpi) {
  const Png png = begin_png(width, height, 8, SPNG_COLOR_TYPE_TRUECOLOR);
  const bool photograph = content == PngContent::photograph;
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, photograph ? 1 : 6);
  if (photograph) spng_set_option(png.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB);
  const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / 0.0254));
  spng_phys size{per_metre, per_metre, 1};
  if (per_metre > 0) spng_set_phys(png.get(), &size);
  return finish_png(png, rgb.data(), rgb.size());
}

std::string encode_grey_png(std::span<const std::uint16_t> grey, int width, int height) {
  return finish_png(begin_png(width, height, 16, SPNG_COLOR_TYPE_GRAYSCALE), grey.data(), grey.size_bytes());
}

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

void write_png(const std::string& path, std::span<const std::uint8_t> rgb, int width, int height, PngContent content) {
  write_picture(path, encode_png(rgb, width, height, content));
}

}  // namespace sf::viz
