#include "viz/png.h"

#include <spng.h>

#include <cstdlib>
#include <memory>

namespace sf::viz {

std::vector<std::uint8_t> encode_png(const std::uint8_t* rgb, int width, int height) {
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> png(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR;
  spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, 6);
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

}  // namespace sf::viz
