#pragma once
// Image source functions of vision/opencv.h.

#include "vision/opencv.h"

namespace sf::vision {

std::unique_ptr<ImageSource> open_source(const std::string& source, int width, int height, double rate);

}  // namespace sf::vision
