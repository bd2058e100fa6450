#pragma once
// World-file settings of cameras.

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "base/camera_pixels.h"
#include "base/jpeg.h"
#include "base/lens.h"
#include "base/rigid_transform.h"
#include "sensors/camera_response.h"
#include "sensors/lidar_beams.h"

namespace sf::sensors {

/// Settings of one camera. It looks along its x axis; y points to the left of the image, z up.
struct CameraSettings {
  base::RigidTransform X_MS;                ///< sensor in the mover's frame
  std::uint32_t width = 320, height = 240;  ///< [px]
  base::Lens lens;
  double range_min = 0.0, range_max = 50.0;  ///< [m] of the depth along the optical axis
  double depth_noise = 0.0;  ///< [1/m] >= 0, standard deviation of depths over their squares, as of stereo cameras
  bool normals = false;
  std::uint8_t mode = 0;      ///< row of kCameraModes
  bool rgb = false;           ///< pixels have colours
  bool mono = false;          ///< and these are grey, of the luminance (Rec. 709)
  int jpeg = 0;               ///< quality of JPEG files in packets and messages, in [1, 100]; 0: PNG
  std::uint32_t samples = 1;  ///< beams per pixel; depths, labels and normals are those of the first
  double exposure = 0.0;      ///< [s] as Shutter::exposure
  double readout = 0.0;       ///< [s] as Shutter::readout
  CameraResponse response;    ///< of the colours
  bool linear = false;        ///< colours are stored linear in the light, else as sRGB
  std::shared_ptr<const LidarBeams>
      beams;  ///< one per pixel, with a part per sample; pixels that see nothing are not cast

  std::size_t columns() const { return normals ? 5 : rgb ? 2 : 1; }  ///< numbers per pixel: depth, colour, normal
  /// Returns whether the colour of a pixel is that of its one beam.
  bool is_plain() const { return samples == 1 && response.is_ideal() && !linear; }
  int jpeg_quality() const { return jpeg > 0 ? jpeg : base::kJpegQuality; }  ///< of files that are to be JPEG
  base::ColorFormat format() const { return {width, height, mono, jpeg}; }
  double depth_sigma(double depth) const { return depth_noise * depth * depth; }  ///< [m] standard deviation
};

inline constexpr std::string_view kCameraKeys[] = {
    "resolution", "fov",   "focal", "principal", "distortion", "fisheye", "range",      "normals",
    "rgb",        "mono",  "jpeg",  "samples",   "exposure",   "rolling", "scan_time",  "gain",
    "vignetting", "noise", "blur",  "linear",    "pose6",      "pantilt", "depth_noise"};

/// Reads the settings of cameras. Cameras with equal images share their beams.
class CameraReader {
 public:
  /// @throws base::InputError with file and line for invalid settings
  CameraSettings read(const world::Sensor& sensor);

 private:
  struct Image {
    std::uint32_t width, height;
    base::Lens lens;
    std::uint32_t samples = 1;
    double exposure = 0.0, readout = 0.0;
    bool operator==(const Image&) const = default;
  };
  std::shared_ptr<const LidarBeams> beams_of(const world::Sensor& sensor, const CameraSettings& s);

  std::vector<std::pair<Image, std::shared_ptr<const LidarBeams>>> known_;
};

}  // namespace sf::sensors
