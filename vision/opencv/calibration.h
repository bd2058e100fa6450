#pragma once
// Calibration functions of vision/opencv.h.

#include "vision/opencv.h"

namespace sf::vision {

std::vector<BoardCorner> find_board(const Image& image, const Chessboard& board);
Calibration calibrate(const std::vector<std::vector<BoardCorner>>& corners, const Chessboard& board, int width,
                      int height);

}  // namespace sf::vision
