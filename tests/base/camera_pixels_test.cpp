// Images in readings of cameras.

#include "base/camera_pixels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/base/decoded_jpeg.h"
#include "tests/base/decoded_png.h"

namespace sf::base {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(CameraPixels, ColoursAreTheSecondNumberOfAPixel) {
  const std::vector<double> reading{1.5, 0x123456, 0, 0, 1, 2.5, 0xFF00FE,  1, 0, 0,
                                    3.5, NAN,      0, 0, 1, 4.5, 0x1000000, 0, 0, 1};
  EXPECT_EQ(color_bytes(reading, 5), (Bytes{0x12, 0x34, 0x56, 0xFF, 0x00, 0xFE, 0, 0, 0, 0, 0, 0}));
}

TEST(CameraPixels, FilesHaveTheFormatOfTheCamera) {
  const std::vector<double> reading{1.0, 0x202020, 2.0, 0xEFEFEF};
  EXPECT_EQ(image_bytes(reading, 2, true), (Bytes{0x20, 0xEF}));
  EXPECT_EQ(decode_png(color_file(reading, 2, {2, 1, false, 0})).pixels, color_bytes(reading, 2));
  EXPECT_EQ(decode_png(color_file(reading, 2, {2, 1, true, 0})).pixels, image_bytes(reading, 2, true));
  EXPECT_EQ(decode_jpeg(color_file(reading, 2, {2, 1, false, 95})).channels, 3);
  const DecodedJpeg grey = decode_jpeg(color_file(reading, 2, {2, 1, true, 100}));
  EXPECT_EQ(grey.channels, 1);
  EXPECT_NEAR(grey.pixels.at(0), 0x20, 1);
  EXPECT_NEAR(grey.pixels.at(1), 0xEF, 1);
}

/// Rounding, the limits, and the largest number of 16 bits.
TEST(CameraPixels, DepthsInMillimetres) {
  const std::vector<double> reading{0.5004, 0, 0.5006, 0, 65.5354, 0, 65.5356, 0, -HUGE_VAL, 0, 0.4999, 0, 100.0, 0};
  EXPECT_EQ(millimetre_depths(reading, 2, {0.5, 100.0}), (std::vector<std::uint16_t>{500, 501, 65535, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace sf::base
