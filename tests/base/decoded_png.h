#pragma once
// Pixels of PNG files, read by the library.

#include <gtest/gtest.h>
#include <spng.h>

#include <cstdint>
#include <string_view>
#include <vector>

namespace sf::base {

struct DecodedPng {
  spng_ihdr header{};
  std::vector<std::uint8_t> pixels;  ///< as in the file; 16 bits in the machine's order
};

/// Fails the test if the bytes are not a PNG file.
inline DecodedPng decode_png(std::string_view file) {
  DecodedPng png;
  spng_ctx* const context = spng_ctx_new(0);
  std::size_t size = 0;
  EXPECT_EQ(spng_set_png_buffer(context, file.data(), file.size()), 0);
  EXPECT_EQ(spng_get_ihdr(context, &png.header), 0);
  EXPECT_EQ(spng_decoded_image_size(context, SPNG_FMT_PNG, &size), 0);
  png.pixels.resize(size);
  EXPECT_EQ(spng_decode_image(context, png.pixels.data(), size, SPNG_FMT_PNG, 0), 0);
  spng_ctx_free(context);
  return png;
}

}  // namespace sf::base
