// Decodes PNG with spng.

#include <fmt/format.h>
#include <spng.h>

#include <memory>
#include <vector>

#include "base/error.h"
#include "world/picture_formats.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxExtras = 4u << 20;  // bytes of text and profile chunks, uncompressed

using Decoder = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

void check(const PictureSink& out, int result) {
  if (result != 0)
    throw base::InputError(out.file(), 0, fmt::format("corrupt PNG: {}; save it again", spng_strerror(result)));
}

bool stores_alpha(spng_ctx* png, const spng_ihdr& header) {
  spng_trns transparent{};
  return header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA || header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
         spng_get_trns(png, &transparent) == 0;
}

// Decodes row by row unless interlaced, so a large plan needs no second copy in memory.
void decode_rows(spng_ctx* png, std::size_t row_bytes, bool has_alpha, PictureSink& out) {
  std::vector<std::uint8_t> row(row_bytes);
  check(out, spng_decode_image(png, nullptr, 0, SPNG_FMT_RGBA8, SPNG_DECODE_TRNS | SPNG_DECODE_PROGRESSIVE));
  for (std::uint32_t y = 0; y < out.height(); ++y) {
    const int result = spng_decode_row(png, row.data(), row.size());
    if (result != SPNG_EOI) check(out, result);
    out.add({row, has_alpha});
  }
}

void decode_interlaced(spng_ctx* png, std::size_t row_bytes, bool has_alpha, PictureSink& out) {
  check_whole(out, "an interlaced picture");
  std::vector<std::uint8_t> rgba(row_bytes * out.height());
  check(out, spng_decode_image(png, rgba.data(), rgba.size(), SPNG_FMT_RGBA8, SPNG_DECODE_TRNS));
  for (std::uint32_t y = 0; y < out.height(); ++y)
    out.add({std::span(rgba).subspan(y * row_bytes, row_bytes), has_alpha});
}

}  // namespace

void decode_png(const std::string& bytes, PictureSink& out) {
  const Decoder png(spng_ctx_new(0), &spng_ctx_free);
  check(out, spng_set_png_buffer(png.get(), bytes.data(), bytes.size()));
  check(out, spng_set_image_limits(png.get(), 1u << 24, 1u << 24));
  check(out, spng_set_chunk_limits(png.get(), kMaxExtras, kMaxExtras));
  spng_ihdr header{};
  check(out, spng_get_ihdr(png.get(), &header));
  out.begin(header.width, header.height);
  const auto decode = header.interlace_method == 0 ? decode_rows : decode_interlaced;
  decode(png.get(), std::size_t{header.width} * 4, stores_alpha(png.get(), header), out);
}

}  // namespace sf::world
