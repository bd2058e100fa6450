#pragma once
// Pixels of JPEG files, read by the library.

#include <cstdint>
#include <cstdio>
#include <string_view>
#include <vector>

#include <jpeglib.h>  // after <cstdio>, whose FILE it needs

namespace sf::base {

struct DecodedJpeg {
  int width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> pixels;  ///< grey, or red, green and blue
};

/// Ends the process if the bytes are not a JPEG file.
inline DecodedJpeg decode_jpeg(std::string_view file) {
  jpeg_error_mgr errors{};
  jpeg_decompress_struct jpeg{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(file.data()), file.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg_start_decompress(&jpeg);
  const std::size_t stride = std::size_t{jpeg.output_width} * static_cast<unsigned>(jpeg.output_components);
  DecodedJpeg image{static_cast<int>(jpeg.output_width), static_cast<int>(jpeg.output_height), jpeg.output_components,
                    std::vector<std::uint8_t>(stride * jpeg.output_height)};
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = image.pixels.data() + stride * jpeg.output_scanline;
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return image;
}

}  // namespace sf::base
