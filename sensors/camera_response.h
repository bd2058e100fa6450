#pragma once
// What a camera makes of the light of its pixels: blur and vignetting by the lens, gain and noise of the image sensor.
// All values are linear in the light; 1 is the largest value of a pixel.

#include <cmath>
#include <cstddef>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_float3.hpp>
#include <span>
#include <vector>

namespace sf::sensors {

/// The light is blurred, multiplied by `gain` and the falloff of the lens, and then noisy.
struct CameraResponse {
  double gain = 1.0;        ///< >= 0
  double vignetting = 0.0;  ///< in [0, 1]: part of the light lost in the corners of the image
  double blur = 0.0;        ///< [px] >= 0, standard deviation of the blur by the lens
  double read_noise = 0.0;  ///< >= 0, standard deviation in the dark
  double shot_noise = 0.0;  ///< >= 0, variance per light: photon noise

  bool is_noisy() const { return read_noise > 0.0 || shot_noise > 0.0; }
  /// Returns whether it leaves all light as it is.
  bool is_ideal() const { return gain == 1.0 && vignetting == 0.0 && blur == 0.0 && !is_noisy(); }
  /// Returns the part of the light that the lens passes to a pixel. @param size [px] of the image
  double falloff(glm::dvec2 pixel, glm::dvec2 size) const;
  /// Returns the standard deviation of the noise of a mean value.
  double noise_of(double mean) const { return std::sqrt(read_noise * read_noise + shot_noise * mean); }
};

/// Gaussian blur by a lens.
class LensBlur {
 public:
  /// @param sigma [px] standard deviation; below 0.05 images stay as they are
  explicit LensBlur(double sigma);
  /// Blurs an image, row by row, in place. Beyond its borders it continues with the values there.
  void apply(std::span<float> image, std::size_t width) const { blur(image, width); }
  void apply(std::span<glm::vec3> image, std::size_t width) const { blur(image, width); }

 private:
  template <class Light>
  void blur(std::span<Light> image, std::size_t width) const;

  std::vector<float> taps_;  ///< an odd number; empty: no blur
};

}  // namespace sf::sensors
