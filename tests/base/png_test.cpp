// PNG files, decoded by the library.

#include "base/png.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/base/decoded_png.h"

namespace sf::base {
namespace {

TEST(Png, IsLosslessForEveryFormat) {
  for (const PngContent content : {PngContent::figure, PngContent::photograph})
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {257, 1}, {1, 300}}) {
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(3 * width * height));
      for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 151 >> 2);
      std::vector<std::uint16_t> words(bytes.size() / 3);
      for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<std::uint16_t>(65535 - i * 4099);
      const auto* const raw = reinterpret_cast<const std::uint8_t*>(words.data());

      const DecodedPng color = decode_png(encode_png(bytes, width, height, content));
      EXPECT_EQ(color.header.color_type, SPNG_COLOR_TYPE_TRUECOLOR);
      EXPECT_EQ(color.pixels, bytes);
      const std::span<const std::uint8_t> part(bytes.data(), words.size());
      const DecodedPng grey = decode_png(encode_png(part, width, height, content));
      EXPECT_EQ(grey.header.color_type, SPNG_COLOR_TYPE_GRAYSCALE);
      EXPECT_EQ(grey.pixels, std::vector(part.begin(), part.end()));
      const DecodedPng deep = decode_png(encode_png(words, width, height, content));
      EXPECT_EQ(deep.header.bit_depth, 16);
      EXPECT_EQ(deep.pixels, std::vector(raw, raw + 2 * words.size()));
      EXPECT_EQ(deep.header.width, static_cast<std::uint32_t>(width));
      EXPECT_EQ(deep.header.height, static_cast<std::uint32_t>(height));
    }
}

}  // namespace
}  // namespace sf::base
