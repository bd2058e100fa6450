// The plug-in of world/picture.h: reads JPEG, BMP and GIF with OpenCV's imgcodecs, which uses GDAL for GIF.

#include <exception>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "world/picture.h"

namespace {

using sf::world::PixelRow;

cv::Mat read(const std::string& file, const std::string& bytes) {
  if (bytes.starts_with("GIF8")) return cv::imread(file, cv::IMREAD_LOAD_GDAL);
  const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
  return cv::imdecode(encoded, cv::IMREAD_UNCHANGED);  // as stored: ignore the orientation tag of cameras
}

/// Converts OpenCV's blue, green and red, or grey, to RGBA.
void convert(const std::uint8_t* from, int channels, std::vector<std::uint8_t>& rgba) {
  for (std::size_t i = 0; i < rgba.size(); i += 4, from += channels) {
    for (std::size_t k = 0; k < 3; ++k) rgba[i + k] = channels == 1 ? from[0] : from[2 - k];
    rgba[i + 3] = channels == 4 ? from[3] : std::uint8_t{255};
  }
}

std::string decode(const std::string& file, const std::string& bytes, std::uint32_t width, std::uint32_t height,
                   const std::function<void(const PixelRow&)>& row) {
  cv::Mat picture;
  try {
    picture = read(file, bytes);
  } catch (const std::exception& error) {
    return error.what();
  }
  if (picture.empty()) return "OpenCV reports that it is corrupt or truncated";
  const bool as_expected =
      picture.depth() == CV_8U && picture.cols == static_cast<int>(width) && picture.rows == static_cast<int>(height);
  if (!as_expected) return "its pixels differ from its header";
  std::vector<std::uint8_t> rgba(std::size_t{width} * 4);
  for (int y = 0; y < picture.rows; ++y) {
    convert(picture.ptr(y), picture.channels(), rgba);
    row({rgba, picture.channels() == 4});
  }
  return {};
}

}  // namespace

extern "C" {
extern const sf::world::PictureDecoder sensorfarm_pictures;
const sf::world::PictureDecoder sensorfarm_pictures{.decode = decode};
}
