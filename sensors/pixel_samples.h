#pragma once
// Places and times of a pixel's samples.

#include <cstddef>
#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <vector>

namespace sf::sensors {

/// Places of the samples of an image's pixels. The first is a pixel's middle. The others are a lattice with equal
/// distances along both axes, displaced by at most half of these, from pixel to pixel in another direction: along an
/// edge, errors of its place cancel out. An exposure takes them one after the other, in an order in which they do not
/// drift across the pixel.
class PixelSamples {
 public:
  /// @param count > 0
  explicit PixelSamples(std::uint32_t count);
  /// Returns sample `k` of pixel (u, v) [px from its middle, within 1/2].
  glm::dvec2 at(std::uint32_t k, std::uint32_t u, std::uint32_t v) const;

 private:
  std::vector<glm::dvec2> places_;  ///< of the lattice
};

/// When the samples of an image are cast.
struct Shutter {
  double exposure = 0.0;      ///< [s] before the time of a row, divided among its samples
  double readout = 0.0;       ///< [s] from the first row to one below the last (rolling shutter); 0: all at once
  std::uint32_t height = 1;   ///< [px] > 0
  std::uint32_t samples = 1;  ///< per pixel, > 0

  /// Returns the time [s] <= 0 of a sample, relative to the first sample of the last row.
  double time_of(std::size_t row, std::uint32_t sample) const {
    const auto rows = static_cast<double>(height - 1 - row);
    return -readout * rows / height - exposure * sample / samples;
  }
};

}  // namespace sf::sensors
