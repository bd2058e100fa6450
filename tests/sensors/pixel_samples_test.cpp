#include "sensors/pixel_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sf::sensors {
namespace {

std::vector<glm::dvec2> samples_of(std::uint32_t count, std::uint32_t u, std::uint32_t v) {
  const PixelSamples samples(count);
  std::vector<glm::dvec2> places;
  for (std::uint32_t k = 0; k < count; ++k) places.push_back(samples.at(k, u, v));
  return places;
}

TEST(PixelSamples, FillThePixelEvenly) {
  for (std::uint32_t count = 1; count <= 64; ++count) {
    const std::vector<glm::dvec2> places = samples_of(count, 17 * count, 5 * count);
    EXPECT_EQ(places[0], glm::dvec2(0.0)) << "the sample that has the depth";
    for (const int axis : {0, 1}) {
      std::vector<double> along;
      for (std::size_t i = 1; i < places.size(); ++i) along.push_back(places[i][axis]);
      std::ranges::sort(along);
      const auto n = static_cast<double>(along.size());
      for (std::size_t i = 0; i < along.size(); ++i)
        EXPECT_NEAR(along[i], (static_cast<double>(i) + 0.5) / n - 0.5, 0.5 / n) << count << ": one in each n-th";
    }
  }
}

/// An edge is where the part of its line of pixels says, to a hundredth: not displaced, and not stepwise.
TEST(PixelSamples, AverageToThePlaceOfAnEdge) {
  for (const std::uint32_t count : {4, 8, 16, 64})
    for (const int axis : {0, 1})
      for (double edge = -0.45; edge < 0.5; edge += 0.1) {
        const PixelSamples samples(count);
        double covered = 0.0;
        for (std::uint32_t i = 0; i < 200; ++i)
          for (std::uint32_t k = 1; k < count; ++k)
            covered += samples.at(k, axis == 0 ? 3 : i, axis == 0 ? i : 3)[axis] < edge ? 1.0 : 0.0;
        EXPECT_NEAR(covered / 200 / (count - 1), edge + 0.5, 0.01) << count << " samples, axis " << axis;
      }
}

TEST(PixelSamples, AreApartInPlaceAndTime) {
  for (std::uint32_t count = 9; count <= 64; ++count) {
    const std::vector<glm::dvec2> places = samples_of(count, 0, 0);
    double least = 1.0;
    for (std::size_t i = 1; i < places.size(); ++i)
      for (std::size_t k = 1; k < i; ++k) {
        const glm::dvec2 d = places[i] - places[k];  // of pixels side by side
        least = std::min(least, std::hypot(d.x - std::round(d.x), d.y - std::round(d.y)));
      }
    EXPECT_GT(least * std::sqrt(count), 0.5) << count << ": a square lattice has 1";
    glm::dvec2 drift{}, sum{};
    for (std::size_t i = 0; i < places.size(); ++i) sum += places[i], drift += static_cast<double>(i) * places[i];
    drift = 12.0 / count / count * (drift - 0.5 * (count - 1.0) * sum);
    EXPECT_LT(std::max(std::abs(drift.x), std::abs(drift.y)), 0.25) << count << ": correlation of place and time";
  }
}

}  // namespace
}  // namespace sf::sensors
