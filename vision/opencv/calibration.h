#pragma once
// The function of vision/opencv.h about calibration.

#include "vision/opencv.h"

namespace sf::vision {

Calibration calibrate(const std::vector<Image>& images, int columns, int rows, double square);

}  // namespace sf::vision
