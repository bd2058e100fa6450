#pragma once
// The part of each pixel that a shape covers, in pixel coordinates: x right, y down, pixel (i, j) is the square [i,
// i+1) x [j, j+1). Coverage is computed analytically, so edges are smooth without supersampling.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "base/pose.h"

namespace sf::viz {

/// Half-open box of whole pixels.
struct PixelBox {
  int x_min = 0, y_min = 0, x_max = 0, y_max = 0;
};

/// One float per pixel of a canvas, and the touched part of each row. All zero between shapes.
class CoverageBuffer {
 public:
  CoverageBuffer(int width, int height);
  float* row(int y) { return values_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_); }
  void touch(int y, int x_min, int x_max) {
    Touched& t = touched_[static_cast<std::size_t>(y)];
    t = {std::min(t.x_min, x_min), std::max(t.x_max, x_max)};
    y_min_ = std::min(y_min_, y);
    y_max_ = std::max(y_max_, y + 1);
  }
  /// Calls `visit(y, x_min, coverage)` for each touched row, with `coverage` from x_min on, then clears the row.
  template <class Visit>
  void drain(Visit&& visit) {
    for (int y = y_min_; y < y_max_; ++y) {
      Touched& t = touched_[static_cast<std::size_t>(y)];
      if (t.x_max <= t.x_min) continue;
      const std::span<float> part(row(y) + t.x_min, static_cast<std::size_t>(t.x_max - t.x_min));
      visit(y, t.x_min, part);
      std::fill(part.begin(), part.end(), 0.0f);
      t = Touched{};
    }
    y_min_ = 1 << 30;
    y_max_ = 0;
  }

 private:
  struct Touched {
    int x_min = 1 << 30;
    int x_max = 0;
  };
  int width_;
  int y_min_ = 1 << 30;
  int y_max_ = 0;
  std::vector<float> values_;
  std::vector<Touched> touched_;
};

/// Adds a line with round ends to `rows`, which holds the coverage of the union of all lines since the last drain.
/// @param width [px] > 0; a line thinner than a pixel becomes a paler line of one pixel.
void add_line(CoverageBuffer& rows, const PixelBox& clip, glm::dvec2 a, glm::dvec2 b, double width);

/// Adds one directed edge of a closed outline. `rows` then holds signed area differences: the coverage of a pixel is
/// the absolute sum of its row from the left up to it, at most 1. Outlines of the same orientation are united.
void add_edge(CoverageBuffer& rows, const PixelBox& clip, glm::dvec2 a, glm::dvec2 b);

/// Turns the area differences of a row part into coverage in place.
void sum_edges(std::span<float> part);

}  // namespace sf::viz
