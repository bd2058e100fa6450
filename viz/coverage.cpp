#include "viz/coverage.h"

#include <cmath>

namespace sf::viz {
namespace {

bool finite(glm::dvec2 p) { return std::isfinite(p.x) && std::isfinite(p.y); }

int to_int(double value) { return static_cast<int>(std::clamp(value, -1e9, 1e9)); }

/// The x range of the part of a -> b with y in [y_min, y_max]; false when there is none.
bool x_range(glm::dvec2 a, glm::dvec2 b, double y_min, double y_max, double& x_min, double& x_max) {
  if (a.y > b.y) std::swap(a, b);
  if (b.y < y_min || a.y > y_max) return false;
  const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
  const double x_a = a.y < y_min ? a.x + slope * (y_min - a.y) : a.x;
  const double x_b = b.y > y_max ? a.x + slope * (y_max - a.y) : b.x;
  x_min = std::min(x_a, x_b);
  x_max = std::max(x_a, x_b);
  return true;
}

/// Part of an edge within one row and one column: `height` [px] signed, `x_mean` its mean distance from the column's
/// left.
void add_to_column(float* row, int column, int x_end, double height, double x_mean) {
  row[column] += static_cast<float>(height * (1.0 - x_mean));
  if (column + 1 < x_end) row[column + 1] += static_cast<float>(height * x_mean);
}

/// Part of an edge within one row, from x_a to x_b >= x_a, `height` [px] signed.
void add_to_row(CoverageBuffer& rows, const PixelBox& clip, int y, double x_a, double x_b, double height) {
  float* row = rows.row(y);
  if (x_a >= clip.x_max) return rows.touch(y, clip.x_max, clip.x_max);
  if (x_b <= clip.x_min) {
    row[clip.x_min] += static_cast<float>(height);
    return rows.touch(y, clip.x_min, clip.x_min + 1);
  }
  const double per_x = x_b > x_a ? height / (x_b - x_a) : 0.0;
  if (x_a < clip.x_min) {
    row[clip.x_min] += static_cast<float>(per_x * (clip.x_min - x_a));
    height -= per_x * (clip.x_min - x_a);
    x_a = clip.x_min;
  }
  if (x_b > clip.x_max) {
    height -= per_x * (x_b - clip.x_max);
    x_b = clip.x_max;
  }
  const int first = std::min(static_cast<int>(x_a), clip.x_max - 1);
  const int last = std::clamp(static_cast<int>(x_b), first, clip.x_max - 1);
  rows.touch(y, first, std::min(last + 2, clip.x_max));
  if (first == last) return add_to_column(row, first, clip.x_max, height, 0.5 * (x_a + x_b) - first);
  for (int column = first; column <= last; ++column) {
    const double from = std::max(x_a, static_cast<double>(column));
    const double to = std::min(x_b, column + 1.0);
    add_to_column(row, column, clip.x_max, per_x * (to - from), 0.5 * (from + to) - column);
  }
}

}  // namespace

CoverageBuffer::CoverageBuffer(int width, int height)
    : width_(width),
      values_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f),
      touched_(static_cast<std::size_t>(height)) {}

void add_line(CoverageBuffer& rows, const PixelBox& clip, glm::dvec2 a, glm::dvec2 b, double width) {
  if (!finite(a) || !finite(b)) return;
  const double half = 0.5 * std::max(width, 1.0);
  const float gain = static_cast<float>(std::min(width, 1.0));
  const double reach = half + 0.5;
  const int y_min = std::max(clip.y_min, to_int(std::floor(std::min(a.y, b.y) - reach)));
  const int y_max = std::min(clip.y_max, to_int(std::ceil(std::max(a.y, b.y) + reach)));
  const glm::dvec2 along = b - a;
  const double length_2 = glm::dot(along, along);
  const double inverse = length_2 > 0.0 ? 1.0 / length_2 : 0.0;

  for (int y = y_min; y < y_max; ++y) {
    const double y_mid = y + 0.5;
    double x_a = 0.0;
    double x_b = 0.0;
    if (!x_range(a, b, y_mid - reach, y_mid + reach, x_a, x_b)) continue;
    const int x_min = std::max(clip.x_min, to_int(std::floor(x_a - reach)));
    const int x_max = std::min(clip.x_max, to_int(std::ceil(x_b + reach)));
    if (x_min >= x_max) continue;

    float* row = rows.row(y);
    for (int x = x_min; x < x_max; ++x) {
      const glm::dvec2 p = glm::dvec2{x + 0.5, y_mid} - a;
      const double t = std::clamp(glm::dot(p, along) * inverse, 0.0, 1.0);
      const glm::dvec2 off = p - t * along;
      const float covered = static_cast<float>(std::clamp(reach - std::sqrt(glm::dot(off, off)), 0.0, 1.0));
      row[x] = std::max(row[x], gain * covered);
    }
    rows.touch(y, x_min, x_max);
  }
}

void add_edge(CoverageBuffer& rows, const PixelBox& clip, glm::dvec2 a, glm::dvec2 b) {
  if (!finite(a) || !finite(b) || a.y == b.y || clip.x_min >= clip.x_max) return;
  const double sign = a.y < b.y ? 1.0 : -1.0;
  if (a.y > b.y) std::swap(a, b);
  const double slope = (b.x - a.x) / (b.y - a.y);
  const double y_from = std::max(a.y, static_cast<double>(clip.y_min));
  const double y_to = std::min(b.y, static_cast<double>(clip.y_max));
  for (int y = to_int(std::floor(y_from)); y < y_to; ++y) {
    const double top = std::max(y_from, static_cast<double>(y));
    const double bottom = std::min(y_to, y + 1.0);
    const double x_top = a.x + slope * (top - a.y);
    const double x_bottom = a.x + slope * (bottom - a.y);
    add_to_row(rows, clip, y, std::min(x_top, x_bottom), std::max(x_top, x_bottom), sign * (bottom - top));
  }
}

void sum_edges(std::span<float> part) {
  float sum = 0.0f;
  for (float& value : part) {
    sum += value;
    value = std::min(std::abs(sum), 1.0f);
  }
}

}  // namespace sf::viz
