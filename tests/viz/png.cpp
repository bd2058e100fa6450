#include "tests/viz/png.h"

#include <gtest/gtest.h>
#include <spng.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "viz/picture_file.h"

namespace sf::scenes {

Picture picture_of(const viz::Canvas& canvas) {
  viz::PixelImage image = viz::paint_pixels(canvas.drawing());
  return {image.width, image.height, std::move(image.rgb)};
}

Picture read_png(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  Picture picture;
  spng_ctx* context = spng_ctx_new(0);
  spng_ihdr header{};
  std::size_t size = 0;
  EXPECT_EQ(spng_set_png_buffer(context, bytes.data(), bytes.size()), 0);
  EXPECT_EQ(spng_get_ihdr(context, &header), 0) << path << " is no PNG";
  EXPECT_EQ(spng_decoded_image_size(context, SPNG_FMT_RGB8, &size), 0);
  picture.rgb.resize(size);
  EXPECT_EQ(spng_decode_image(context, picture.rgb.data(), size, SPNG_FMT_RGB8, 0), 0);
  spng_ctx_free(context);
  picture.width = static_cast<int>(header.width);
  picture.height = static_cast<int>(header.height);
  return picture;
}

void expect_painted(const std::string& path, std::initializer_list<Painted> expected) {
  const Picture picture = read_png(path);
  for (const Painted& p : expected)
    EXPECT_GE(picture.count(p.color), p.least) << path << ", colour " << std::hex << p.color;
}

std::string own_file(const std::string& name) {
  const auto& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::string prefix = std::string("sf_") + test.test_suite_name() + "_" + test.name() + "_";
  std::replace(prefix.begin(), prefix.end(), '/', '_');
  return testing::TempDir() + prefix + name;
}

}  // namespace sf::scenes
