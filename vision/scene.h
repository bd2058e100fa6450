#pragma once
// A simulated testbed seen by cameras: a floor with horizontal patches above it, including tags.

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <vector>

#include "base/pose.h"
#include "vision/tag_pattern.h"

namespace sf::vision {

/// A horizontal patch of one grey, or a tag with its white border. Higher patches hide lower ones; at equal height,
/// later patches hide earlier ones.
struct Patch {
  enum class Shape { rectangle, disc, tag };
  Shape shape = Shape::rectangle;
  base::Pose X_WP;      ///< pose of its centre at `time`; z: its height
  double time = 0.0;    ///< [s] time of the pose
  glm::dvec2 velocity;  ///< [m/s] in the world
  double turn = 0.0;    ///< [rad/s]
  glm::dvec2 size;      ///< [m] along its x and y; for a disc: the diameter, twice; for a tag: the side, twice
  double albedo = 0.5;  ///< in [0, 1]: grey of a rectangle or disc
  double dark = 0.05;   ///< albedo of a tag's black cells
  double light = 0.8;   ///< albedo of a tag's white cells
  TagPattern pattern;   ///< of a tag
  double border = 1.0;  ///< [cells] width of the white border around a tag
};

/// Returns the pose of a patch at time `t` [s], with constant velocity and turn rate.
base::Pose pose_at(const Patch& patch, double t);

struct Scene {
  double floor = 0.45;    ///< albedo, in [0, 1]
  double texture = 0.03;  ///< amplitude of the unevenness of the floor [albedo]
  glm::dvec2 gradient;    ///< [1/m] relative change of the light along x and y of the world
  std::vector<Patch> patches;
};

/// A lens and an image sensor. Grey values are linear in the light.
struct Imaging {
  double exposure_gain = 255.0;  ///< [grey] for albedo 1 in the light at the world's origin
  double vignetting = 0.25;      ///< fraction of the light lost in the corners of the image
  double blur = 0.6;             ///< [px] standard deviation of the lens blur
  double read_noise = 1.0;       ///< [grey] standard deviation in the dark
  double shot_noise = 0.02;      ///< [grey] variance per grey: photon noise
};

}  // namespace sf::vision
