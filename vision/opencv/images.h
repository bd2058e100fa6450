#pragma once
// The functions of vision/opencv.h about images.

#include "vision/opencv.h"

namespace cv {
class Mat;
}  // namespace cv

namespace sf::vision {

/// The same pixels as OpenCV's matrix, which lives as long as the image and must not be written to.
cv::Mat wrap(const Image& image);

Image read_image(const std::string& file, int channels);
void write_image(const std::string& file, const Image& image);
void draw(Image& image, const std::vector<Mark>& marks);
/// Copies OpenCV's matrix, which has 8 bits a channel and the image's channels.
void copy(const cv::Mat& from, Image& to);

}  // namespace sf::vision
