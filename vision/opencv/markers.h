#pragma once
// Tag functions of vision/opencv.h.

#include "vision/opencv.h"

namespace cv {
template <typename T>
struct Ptr;
}  // namespace cv
namespace cv::aruco {
class Dictionary;
}  // namespace cv::aruco

namespace sf::vision {

/// @throws base::InputError for an unknown name
cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name);

TagPattern tag_pattern(const std::string& dictionary, std::uint32_t id);
std::uint32_t tag_count(const std::string& dictionary);
std::unique_ptr<TagFinder> make_tag_finder(const std::string& dictionary);

}  // namespace sf::vision
