#pragma once

#include "base/pose.h"

namespace sf::apps {

/// A pose given as three numbers, or as six.
struct TiltedPose {
  base::Pose X;
  base::Tilt tilt;
  bool has_height = false;  ///< six numbers
};

}  // namespace sf::apps
