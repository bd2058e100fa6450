#include "scene/height_field.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sf::scene {

namespace {

constexpr std::int32_t kMostLevels = 8;

float largest_step(const HeightField& field) {
  float most = 0.0f;
  for (std::int32_t j = 0; j < field.rows; ++j)
    for (std::int32_t i = 0; i < field.columns; ++i) {
      const float h = field.heights[field.at(i, j)];
      if (i > 0) most = std::max(most, std::abs(h - field.heights[field.at(i - 1, j)]));
      if (j > 0) most = std::max(most, std::abs(h - field.heights[field.at(i, j - 1)]));
    }
  return most;
}

/// Returns the plane over a block whose cells begin at (i, j), parallel to its corners on average.
/// @param sign -1: under it, with all signs changed
BoundingPlane plane_over(const HeightField& field, std::int32_t i, std::int32_t j, std::int32_t size, double sign) {
  const std::int32_t right = std::min(i + size, field.columns - 1), top = std::min(j + size, field.rows - 1);
  const auto height = [&](std::int32_t x, std::int32_t y) { return sign * field.heights[field.at(x, y)]; };
  const double a = height(i, j), b = height(right, j), d = height(i, top), e = height(right, top);
  const double slope[2] = {0.5 * ((b - a) + (e - d)) / (right - i), 0.5 * ((d - a) + (e - b)) / (top - j)};
  BoundingPlane plane;
  double unit[2];
  for (int axis = 0; axis < 2; ++axis) {
    plane.slope[axis] =
        static_cast<std::int16_t>(field.slope_unit > 0.0f ? std::lround(slope[axis] / field.slope_unit) : 0);
    unit[axis] = double{field.slope_unit} * plane.slope[axis];
  }
  double most = -HUGE_VAL;
  for (std::int32_t y = j; y <= top; ++y)
    for (std::int32_t x = i; x <= right; ++x)
      most = std::max(most, height(x, y) - ((x - i) * unit[0] + (y - j) * unit[1]));
  plane.height = std::nextafter(static_cast<float>(most), HUGE_VALF);
  return plane;
}

std::vector<BoundingPlane> pyramid_of(const HeightField& field, double sign) {
  constexpr std::size_t kLoadedAtOnce = 16;  // by horizons
  std::vector<BoundingPlane> out(static_cast<std::size_t>(field.pitch) * static_cast<std::size_t>(field.bias / 2) +
                                 kLoadedAtOnce);
  for (std::int32_t level = 1; level <= field.levels; ++level) {
    const std::int32_t size = 1 << level;
    for (std::int32_t j = 0; j < field.rows - 1; j += size)
      for (std::int32_t i = 0; i < field.columns - 1; i += size) {
        const std::int32_t row = ((j - field.bias) >> level) + field.bias / 2;
        out[static_cast<std::size_t>(row) * static_cast<std::size_t>(field.pitch) +
            static_cast<std::size_t>(i >> level)] = plane_over(field, i, j, size, sign);
      }
  }
  return out;
}

}  // namespace

HeightField build_height_field(std::uint32_t columns, std::uint32_t rows, glm::dvec2 cell, std::vector<float> heights) {
  HeightField field;
  field.columns = static_cast<std::int32_t>(columns), field.rows = static_cast<std::int32_t>(rows);
  field.cell = cell;
  field.heights = std::move(heights);
  const auto [low, high] = std::ranges::minmax(field.heights);
  field.lowest = low, field.highest = high;
  field.steepest = largest_step(field) * 1.000001f;
  const std::uint32_t longer = std::max(columns, rows) - 1;
  field.levels = std::clamp(static_cast<std::int32_t>(std::bit_width(longer - 1)), 1, kMostLevels);
  const auto padded = [&](std::uint32_t cells) {
    return static_cast<std::int32_t>((cells + (1u << field.levels) - 1) >> field.levels << field.levels);
  };
  field.pitch = padded(columns - 1) / 2;
  field.bias = 2 * padded(rows - 1);
  field.slope_unit = field.steepest / 32000.0f;
  field.above = pyramid_of(field, 1.0), field.below = pyramid_of(field, -1.0);
  return field;
}

}  // namespace sf::scene
