#include "tests/viz/png.h"

#include <gtest/gtest.h>
#include <spng.h>

#include <fstream>
#include <iterator>

namespace sf::scenes {

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

}  // namespace sf::scenes
