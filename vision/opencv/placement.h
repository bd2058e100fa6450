#pragma once
// Camera pose function of vision/opencv.h.

#include "vision/opencv.h"

namespace sf::vision {

void place(const std::vector<glm::dvec3>& places, const std::vector<glm::dvec2>& pixels, Camera& camera);

}  // namespace sf::vision
