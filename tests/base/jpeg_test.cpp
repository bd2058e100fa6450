// JPEG files: their size and error, and equal bytes with and without vector instructions.

#include "base/jpeg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "base/elementary.h"
#include "base/hash.h"
#include "tests/base/decoded_jpeg.h"

namespace sf::base {
namespace {

/// Smooth shades, or noise.
std::vector<std::uint8_t> picture(int width, int height, int channels, bool noise) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        pixels.push_back(
            noise ? static_cast<std::uint8_t>((static_cast<unsigned>(x + 4099 * y + 65537 * c) * 2654435761u) >> 24)
                  : static_cast<std::uint8_t>(128.0 + 90.0 * sin(0.05 * x + 0.03 * y + c)));
  return pixels;
}

/// One pixel, less than a block, whole blocks, and a part of a block more.
TEST(Jpeg, IsCloseToSmoothPictures) {
  for (const int channels : {1, 3})
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {64, 48}, {257, 17}}) {
      const std::vector<std::uint8_t> pixels = picture(width, height, channels, false);
      const DecodedJpeg image = decode_jpeg(encode_jpeg(pixels, width, height));
      EXPECT_EQ(std::tuple(image.width, image.height, image.channels), std::tuple(width, height, channels));
      ASSERT_EQ(image.pixels.size(), pixels.size());
      int most = 0;
      for (std::size_t i = 0; i < pixels.size(); ++i) most = std::max(most, std::abs(pixels[i] - image.pixels[i]));
      EXPECT_LE(most, channels == 1 ? 2 : 8) << width << " x " << height;
    }
}

TEST(Jpeg, QualityTradesErrorForBytes) {
  const std::vector<std::uint8_t> pixels = picture(160, 120, 3, true);
  std::size_t more = 0;
  double less = 256.0;
  for (const int quality : {1, 50, 95, 100}) {  // the least, that of cjpeg, the default, the best
    const std::string file = encode_jpeg(pixels, 160, 120, quality);
    const DecodedJpeg image = decode_jpeg(file);
    double sum = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i) sum += std::abs(pixels[i] - image.pixels[i]);
    EXPECT_GT(file.size(), more) << quality;
    EXPECT_LT(sum, less * static_cast<double>(pixels.size())) << quality;
    more = file.size(), less = sum / static_cast<double>(pixels.size());
  }
}

/// The library reads its environment once per thread.
TEST(Jpeg, BytesDoNotDependOnTheProcessor) {
  const auto hash_of = [](int channels) {
    std::uint64_t hash = 0;
    for (const bool noise : {false, true})
      for (const int quality : {1, 50, 95, 100}) {
        const std::string file = encode_jpeg(picture(257, 95, channels, noise), 257, 95, quality);
        hash = hash_bytes(file.data(), file.size(), hash);
      }
    return hash_hex(hash);
  };
  const std::string grey = hash_of(1), color = hash_of(3);
  EXPECT_EQ(grey, "d628018f7d19af9e");
  EXPECT_EQ(color, "023f84c2d2928a7d");
  setenv("JSIMD_FORCENONE", "1", 1);
  std::thread([&] {
    EXPECT_EQ(hash_of(1), grey);
    EXPECT_EQ(hash_of(3), color);
  }).join();
  unsetenv("JSIMD_FORCENONE");
}

}  // namespace
}  // namespace sf::base
