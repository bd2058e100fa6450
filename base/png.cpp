#include "base/png.h"

#include <spng.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>

#include "base/error.h"

namespace sf::base {

namespace {

struct Format {
  std::uint8_t bits = 8, color = SPNG_COLOR_TYPE_TRUECOLOR;
  PngContent content = PngContent::figure;
  spng_filter_choice filter = SPNG_FILTER_CHOICE_SUB;  ///< of photographs
};

std::string encode(std::span<const std::byte> pixels, int width, int height, const Format& format, double dpi) {
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> png(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = format.bits;
  header.color_type = format.color;
  spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_ihdr(png.get(), &header);
  const bool photograph = format.content == PngContent::photograph;
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, photograph ? 1 : 6);
  if (photograph) spng_set_option(png.get(), SPNG_FILTER_CHOICE, format.filter);
  const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / 0.0254));
  spng_phys size{per_metre, per_metre, 1};
  if (per_metre > 0) spng_set_phys(png.get(), &size);

  int error = spng_encode_image(png.get(), pixels.data(), pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  std::size_t length = 0;
  const std::unique_ptr<void, decltype(&std::free)> file(
      error == 0 ? spng_get_png_buffer(png.get(), &length, &error) : nullptr, &std::free);
  SF_CHECK(file != nullptr && error == 0, std::string("spng did not create a PNG: ") + spng_strerror(error));
  return {static_cast<const char*>(file.get()), length};
}

}  // namespace

std::string encode_png(std::span<const std::uint8_t> pixels, int width, int height, PngContent content, double dpi) {
  const bool grey = pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const Format format{.color = static_cast<std::uint8_t>(grey ? SPNG_COLOR_TYPE_GRAYSCALE : SPNG_COLOR_TYPE_TRUECOLOR),
                      .content = content};
  return encode(std::as_bytes(pixels), width, height, format, dpi);
}

std::string encode_png(std::span<const std::uint16_t> grey, int width, int height, PngContent content) {
  // Depths change more along a row than from row to row.
  const Format format{
      .bits = 16, .color = SPNG_COLOR_TYPE_GRAYSCALE, .content = content, .filter = SPNG_FILTER_CHOICE_UP};
  return encode(std::as_bytes(grey), width, height, format, 0.0);
}

}  // namespace sf::base
