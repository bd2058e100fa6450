#pragma once
// Camera model: pinhole with Brown's distortion (base/lens.h), and a pose in the world.
//
// Frames: W world, C camera (x right in the image, y down, z forward along the optical axis). "Normalised" image
// coordinates are x/z and y/z of a point in C, without distortion.

#include <array>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_double3.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace sf::vision {

struct Intrinsics {
  int width = 0, height = 0;           ///< [px]
  glm::dvec2 focal;                    ///< [px] > 0, along columns and rows
  glm::dvec2 center;                   ///< [px] principal point
  std::array<double, 5> distortion{};  ///< k1, k2 (radial), p1, p2 (tangential), k3 (radial)
};

struct Camera {
  std::string name;
  Intrinsics intrinsics;
  glm::dvec3 position;                 ///< [m] p_WC
  glm::dvec3 right{1.0, 0.0, 0.0};     ///< x axis of C in W; the three axes are orthonormal
  glm::dvec3 down{0.0, -1.0, 0.0};     ///< y axis of C in W
  glm::dvec3 forward{0.0, 0.0, -1.0};  ///< z axis of C in W; the default looks straight down
  double rate = 15.0;                  ///< [Hz] of images, > 0
  double exposure = 0.0;               ///< [s] per row, >= 0
  double readout = 0.0;  ///< [s] between the starts of first and last row (rolling shutter); 0: global shutter
};

/// True for a valid camera name. Names are used in `--input NAME=SOURCE` and as stems of file names: 1 to 64 letters,
/// digits, '_' and '-', starting with a letter or a digit.
bool is_camera_name(std::string_view name);
inline constexpr const char* kCameraNameForm =
    "a name of letters, digits, '_' and '-', at most 64 characters, starting with a letter or a digit";

/// Returns the pixel of a point in normalised coordinates.
glm::dvec2 distort(const Intrinsics& intrinsics, glm::dvec2 normalised);
/// Returns the normalised coordinates of a pixel: the inverse of `distort`, to rounding within the image.
glm::dvec2 undistort(const Intrinsics& intrinsics, glm::dvec2 pixel);
/// True if `distort` is invertible over the image and a margin of 5 %: larger field angles are imaged farther out.
bool is_invertible(const Intrinsics& intrinsics);

/// Returns the pixel of a point in the world, inside or outside of the image. Returns nullopt for points behind the
/// camera, more than 80 degrees off its axis, or where the distortion is not invertible.
std::optional<glm::dvec2> project(const Camera& camera, glm::dvec3 p_W);
/// Returns the point [m] where a ray in normalised coordinates meets the horizontal plane at height `z`; nullopt if it
/// does not, or at a depth of more than 1 km.
std::optional<glm::dvec2> meet_plane(const Camera& camera, glm::dvec2 normalised, double z);
/// The same for a pixel.
std::optional<glm::dvec2> to_plane(const Camera& camera, glm::dvec2 pixel, double z);

/// Returns the middle of the exposure of row `v`, relative to the start of the exposure of row 0 [s].
double middle_of_exposure(const Camera& camera, double v);

/// Sets the axes from the unit quaternion x, y, z, w of the rotation R_WC.
void set_orientation(Camera& camera, const std::array<double, 4>& xyzw);
std::array<double, 4> orientation(const Camera& camera);

}  // namespace sf::vision
