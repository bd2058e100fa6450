#include "base/plugin.h"
#include "vision/opencv.h"

namespace sf::vision {

const OpenCv& opencv() {
  static const auto* const loaded = static_cast<const OpenCv*>(
      base::load_plugin(kOpenCvSymbol, "there are no images", "OpenCV 4.6 (Debian: libopencv-contrib406)"));
  return *loaded;
}

}  // namespace sf::vision
