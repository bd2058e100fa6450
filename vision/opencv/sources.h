#pragma once
// The functions of vision/opencv.h about sources of images.

#include "vision/opencv.h"

namespace sf::vision {

std::unique_ptr<ImageSource> open_source(const std::string& source, int width, int height, double rate);

}  // namespace sf::vision
