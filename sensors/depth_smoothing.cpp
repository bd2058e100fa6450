#include "sensors/depth_smoothing.h"

#include <algorithm>
#include <cmath>

namespace sf::sensors {

void smooth_depths(std::uint32_t width, double noise, std::vector<double>& depths, std::vector<double>& before) {
  before = depths;
  const int w = static_cast<int>(width), h = static_cast<int>(depths.size() / width);
  for (int v = 0; v < h; ++v)
    for (int u = 0; u < w; ++u) {
      const double middle = before[v * w + u], most = kDepthSigmas * noise * middle * middle;
      double sum = 0.0, count = 0.0;
      for (int y = std::max(v - kDepthWindow, 0); y <= std::min(v + kDepthWindow, h - 1); ++y)
        for (int x = std::max(u - kDepthWindow, 0); x <= std::min(u + kDepthWindow, w - 1); ++x)
          if (const double depth = before[y * w + x]; std::abs(depth - middle) <= most) sum += depth, ++count;
      depths[v * w + u] = sum / count;  // NaN if the middle is
    }
}

}  // namespace sf::sensors
