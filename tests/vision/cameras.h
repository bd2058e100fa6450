#pragma once
// Test cameras: 1280 x 1024 pixels, 5 m x 4 m of the floor from 6.5 m.

#include <cmath>

#include "vision/camera.h"

namespace sf::vision {

inline Camera plain_camera() {
  Camera camera;
  camera.name = "plain";
  camera.intrinsics = {1280, 1024, {1664.0, 1664.0}, {639.5, 511.5}, {}};
  camera.position = {0.0, 0.0, 6.5};
  return camera;
}

/// A lens with barrel and tangential distortion, tilted by 3.4 degrees, with 5 ms of exposure and a rolling shutter.
inline Camera distorted_camera() {
  Camera camera = plain_camera();
  camera.name = "distorted";
  camera.intrinsics.center = {645.2, 508.7};
  camera.intrinsics.distortion = {-0.18, 0.06, 0.0005, -0.0004, 0.0};
  camera.exposure = 0.005;
  camera.readout = 0.015;
  set_orientation(camera, {std::cos(0.03), std::sin(0.03), 0.0, 0.0});
  return camera;
}

}  // namespace sf::vision
