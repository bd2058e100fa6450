#pragma once
// Lenses of cameras, with OpenCV's models and parameters. "Normalised" coordinates of a direction are x/z and y/z in
// the frame of a camera: x to the right in the image, y down, z along the optical axis.
//
// Pinhole with distortion: D. C. Brown, "Close-range camera calibration", 1971, with a rational radial part. Fisheye:
// J. Kannala and S. Brandt, "A generic camera model and calibration method", 2006: theta (1 + k1 theta^2 + k2 theta^4 +
// k3 theta^6 + k4 theta^8) of the angle theta from the axis is imaged as its tangent is by a pinhole.

#include <array>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_uint2.hpp>
#include <optional>
#include <span>

namespace sf::base {

/// Returns distorted normalised coordinates. @param k k1 k2 p1 p2 k3, or these and k4 k5 k6
glm::dvec2 distorted(std::span<const double> k, glm::dvec2 n);

/// Jacobian of `distorted`, which is symmetric: d/dx = (xx, xy), d/dy = (xy, yy).
struct DistortionJacobian {
  double xx = 1.0, xy = 0.0, yy = 1.0;
  /// The distortion is invertible and does not mirror.
  bool is_positive() const { return xx > 0.0 && xx * yy - xy * xy > 0.0; }
};
DistortionJacobian distortion_jacobian(std::span<const double> k, glm::dvec2 n);

/// Returns the inverse of `distorted` by Newton's method, from `n` as a first guess, until a step changes nothing.
glm::dvec2 undistorted(std::span<const double> k, glm::dvec2 bent, glm::dvec2 n);

struct Lens {
  glm::dvec2 focal{1.0, 1.0};  ///< [px] > 0, along columns and rows
  glm::dvec2 center{};         ///< [px] principal point; whole numbers are centres of pixels
  /// k1 k2 p1 p2 k3 k4 k5 k6 of a pinhole; k1 k2 k3 k4 of a fisheye, the others 0.
  std::array<double, 8> distortion{};
  bool fisheye = false;

  bool operator==(const Lens&) const = default;
};

/// Angle from the axis [rad] beyond which a fisheye sees nothing.
inline constexpr double kWidestFisheye = 85.0 * 0.017453292519943295;

/// Returns the pixel of a direction in normalised coordinates.
glm::dvec2 pixel_of(const Lens& lens, glm::dvec2 normalised);

/// Returns theta (1 + k1 theta^2 + ...) of a fisheye.
double fisheye_radius(const Lens& lens, double angle);

/// Normalised coordinates of the pixels of an image.
class LensImage {
 public:
  LensImage(const Lens& lens, unsigned width, unsigned height);
  /// Returns a pixel where the lens is not invertible: no direction, or more than one, is imaged there, or between
  /// there and the principal point.
  std::optional<glm::uvec2> fold() const;
  /// Returns the direction that is imaged at a point [px] within the image, to rounding. nullopt: a fisheye sees
  /// nothing there. @pre there is no fold
  std::optional<glm::dvec2> direction(glm::dvec2 pixel) const;

 private:
  bool folds(glm::dvec2 pixel) const;
  bool is_image_of(glm::dvec2 bent, glm::dvec2 n) const;

  const Lens& lens_;
  unsigned width_, height_;
  double rim_ = 0.0;     ///< fisheye_radius of the widest angle up to which it grows
  double widest_ = 0.0;  ///< [rad] that angle
};

}  // namespace sf::base
