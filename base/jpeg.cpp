#include "base/jpeg.h"

#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>  // after <cstdio>, whose FILE it needs

#include "base/error.h"

namespace sf::base {

namespace {

/// libjpeg's handler of errors, which must not return.
void abort_encoding(j_common_ptr jpeg) {
  char text[JMSG_LENGTH_MAX];
  jpeg->err->format_message(jpeg, text);
  SF_CHECK(false, std::string("libjpeg did not create a JPEG: ") + text);
}

void describe(std::span<const std::uint8_t> pixels, int width, int height, int quality, jpeg_compress_struct& jpeg) {
  const auto w = static_cast<JDIMENSION>(width), h = static_cast<JDIMENSION>(height);
  const bool grey = pixels.size() == std::size_t{w} * h;
  SF_CHECK(grey || pixels.size() == std::size_t{3} * w * h, std::to_string(pixels.size()) + " bytes of pixels");
  jpeg.image_width = w, jpeg.image_height = h;
  jpeg.input_components = grey ? 1 : 3;
  jpeg.in_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg.dct_method = JDCT_ISLOW;
}

}  // namespace

std::string encode_jpeg(std::span<const std::uint8_t> pixels, int width, int height, int quality) {
  jpeg_error_mgr errors{};
  jpeg_compress_struct jpeg{};
  jpeg.err = jpeg_std_error(&errors);
  errors.error_exit = abort_encoding;
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): libjpeg's
  jpeg_mem_dest(&jpeg, &bytes, &size);
  describe(pixels, width, height, quality, jpeg);

  jpeg_start_compress(&jpeg, TRUE);
  const std::size_t stride = pixels.size() / jpeg.image_height;
  for (std::size_t y = 0; y < jpeg.image_height; ++y) {
    auto* row = const_cast<JSAMPLE*>(pixels.data() + y * stride);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string file(reinterpret_cast<const char*>(bytes), size);
  std::free(bytes);
  jpeg_destroy_compress(&jpeg);
  return file;
}

}  // namespace sf::base
