#pragma once
// The functions of vision/opencv.h, each implemented in a source of this folder.

#include "vision/opencv.h"

namespace sf::vision {

std::vector<BoardCorner> find_board(const Image& image, const Chessboard& board);
Calibration calibrate(const std::vector<std::vector<BoardCorner>>& corners, const Chessboard& board, int width,
                      int height);
std::unique_ptr<PaintFinder> make_paint_finder(const GroundRaster& raster, const PaintLines& lines,
                                               const std::vector<glm::dvec2>& pixels);
void place(const std::vector<glm::dvec3>& places, const std::vector<glm::dvec2>& pixels, Camera& camera);
std::unique_ptr<ImageSource> open_source(const std::string& source, int width, int height, double rate);
std::unique_ptr<VideoFile> open_video(const std::string& file, int width, int height, double rate);

}  // namespace sf::vision
