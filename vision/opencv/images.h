#pragma once
// Image functions of vision/opencv.h.

#include <functional>

#include "vision/opencv.h"

namespace cv {
class Mat;
}  // namespace cv

namespace sf::vision {

/// Returns a matrix that refers to the image's pixels. It must not outlive the image or be written to.
cv::Mat wrap(const Image& image);

/// Calls `work`. @param what subject of the error message @throws base::InputError with OpenCV's reason if OpenCV
/// throws.
void attempt(const std::string& what, const std::function<void()>& work);

/// Reads an image in grey; without pixels if the file is unreadable. @throws base::InputError as ImageSource::next
Image read_image(const std::string& file);
void draw(Image& image, const std::vector<Mark>& marks);
std::vector<std::uint8_t> encode_jpeg(const Image& image, int most_side);
/// Copies an OpenCV matrix with 8 bits per channel and the image's number of channels.
/// @param source of the image. @throws base::InputError for more than `kMaxImagePixels`
void copy(const cv::Mat& from, const std::string& source, Image& to);

}  // namespace sf::vision
