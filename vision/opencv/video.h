#pragma once
// Video file function of vision/opencv.h.

#include "vision/opencv.h"

namespace sf::vision {

std::unique_ptr<VideoFile> open_video(const std::string& file, int width, int height, double rate);

}  // namespace sf::vision
