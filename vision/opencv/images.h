#pragma once
// The functions of vision/opencv.h about images.

#include <functional>

#include "vision/opencv.h"

namespace cv {
class Mat;
}  // namespace cv

namespace sf::vision {

/// The same pixels as OpenCV's matrix, which lives as long as the image and must not be written to.
cv::Mat wrap(const Image& image);

/// Calls `work`. @throws base::InputError with OpenCV's reason where OpenCV throws. @param what its name for the error
void attempt(const std::string& what, const std::function<void()>& work);

/// In grey; without pixels where the file cannot be read. @throws base::InputError as ImageSource::next
Image read_image(const std::string& file);
void draw(Image& image, const std::vector<Mark>& marks);
/// Copies OpenCV's matrix, which has 8 bits a channel and the image's channels.
/// @param source of the image. @throws base::InputError for more than `kMaxImagePixels`
void copy(const cv::Mat& from, const std::string& source, Image& to);

}  // namespace sf::vision
