#pragma once
// Places of a pixel's samples.

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

}  // namespace sf::sensors
