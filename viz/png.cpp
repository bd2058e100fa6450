#include "viz/png.h"

#include <spng.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include "base/error.h"

namespace sf::viz {

namespace {

/// The file's bytes; empty when the encoding failed.
std::vector<std::uint8_t> encode_png(const std::uint8_t* rgb, int width, int height, PngContent content) {
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> png(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR;
  spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1);
  const bool photograph = content == PngContent::photograph;
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, photograph ? 1 : 6);
  if (photograph) spng_set_option(png.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB);
  spng_set_ihdr(png.get(), &header);
  const std::size_t size = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (spng_encode_image(png.get(), rgb, size, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE) != 0) return {};

  int error = 0;
  std::size_t length = 0;
  const std::unique_ptr<void, decltype(&std::free)> file(spng_get_png_buffer(png.get(), &length, &error), &std::free);
  if (file == nullptr || error != 0) return {};
  const auto* const first = static_cast<const std::uint8_t*>(file.get());
  return {first, first + length};
}

}  // namespace

void write_png(const std::string& path, const std::uint8_t* rgb, int width, int height, PngContent content) {
  const std::vector<std::uint8_t> png = encode_png(rgb, width, height, content);
  SF_CHECK(!png.empty(), "spng made no PNG");

  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (file) file.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  if (file) file.close();
  if (!file)
    throw base::InputError(path, 0,
                           std::string("cannot write the picture (") +
                               (errno != 0 ? std::strerror(errno) : "unknown reason") +
                               "): name a file in a folder that exists, can be written and has room");
}

}  // namespace sf::viz
