#include "viz/resample.h"

#include <algorithm>
#include <cstddef>

namespace sf::viz {
namespace {

/// The share of [from, to) that lies in cell i.
double overlap(double from, double to, int i) { return std::min(to, i + 1.0) - std::max(from, static_cast<double>(i)); }

}  // namespace

BoxMean box_mean(const ColorGrid& cells, double u_min, double u_max, double v_min, double v_max) {
  u_min = std::max(u_min, 0.0);
  v_min = std::max(v_min, 0.0);
  u_max = std::min(u_max, static_cast<double>(cells.columns));
  v_max = std::min(v_max, static_cast<double>(cells.rows));
  BoxMean mean;
  for (int j = static_cast<int>(v_min); j < v_max; ++j) {
    for (int i = static_cast<int>(u_min); i < u_max; ++i) {
      const double area = overlap(v_min, v_max, j) * overlap(u_min, u_max, i);
      const auto at =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(cells.columns) + static_cast<std::size_t>(i);
      const std::uint32_t color = cells.colors[at];
      mean.area += area;
      mean.rgb[0] += area * ((color >> 16) & 0xFFu);
      mean.rgb[1] += area * ((color >> 8) & 0xFFu);
      mean.rgb[2] += area * (color & 0xFFu);
    }
  }
  for (double& c : mean.rgb) c = mean.area > 0.0 ? c / mean.area : 0.0;
  return mean;
}

}  // namespace sf::viz
