// Fiducials with OpenCV's aruco.

#include "vision/opencv/markers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <utility>

#include "base/error.h"
#include "vision/opencv/images.h"

namespace sf::vision {

namespace {

using cv::aruco::PREDEFINED_DICTIONARY_NAME;
constexpr std::array<std::pair<std::string_view, PREDEFINED_DICTIONARY_NAME>, 21> kDictionaries{
    {{"apriltag_36h11", cv::aruco::DICT_APRILTAG_36h11}, {"apriltag_36h10", cv::aruco::DICT_APRILTAG_36h10},
     {"apriltag_25h9", cv::aruco::DICT_APRILTAG_25h9},   {"apriltag_16h5", cv::aruco::DICT_APRILTAG_16h5},
     {"aruco_original", cv::aruco::DICT_ARUCO_ORIGINAL}, {"aruco_4x4_50", cv::aruco::DICT_4X4_50},
     {"aruco_4x4_100", cv::aruco::DICT_4X4_100},         {"aruco_4x4_250", cv::aruco::DICT_4X4_250},
     {"aruco_4x4_1000", cv::aruco::DICT_4X4_1000},       {"aruco_5x5_50", cv::aruco::DICT_5X5_50},
     {"aruco_5x5_100", cv::aruco::DICT_5X5_100},         {"aruco_5x5_250", cv::aruco::DICT_5X5_250},
     {"aruco_5x5_1000", cv::aruco::DICT_5X5_1000},       {"aruco_6x6_50", cv::aruco::DICT_6X6_50},
     {"aruco_6x6_100", cv::aruco::DICT_6X6_100},         {"aruco_6x6_250", cv::aruco::DICT_6X6_250},
     {"aruco_6x6_1000", cv::aruco::DICT_6X6_1000},       {"aruco_7x7_50", cv::aruco::DICT_7X7_50},
     {"aruco_7x7_100", cv::aruco::DICT_7X7_100},         {"aruco_7x7_250", cv::aruco::DICT_7X7_250},
     {"aruco_7x7_1000", cv::aruco::DICT_7X7_1000}}};

}  // namespace

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  std::vector<std::string_view> words;
  for (const auto& [word, value] : kDictionaries) {
    if (word == name) return cv::aruco::getPredefinedDictionary(value);
    words.push_back(word);
  }
  throw base::InputError(
      fmt::format("'{}' is not a dictionary of tags; expected one of: {}", name, fmt::join(words, ", ")));
}

namespace {

class ArucoFinder : public TagFinder {
 public:
  explicit ArucoFinder(const std::string& dictionary)
      : dictionary_(dictionary.empty() ? cv::makePtr<cv::aruco::Dictionary>(cv::Mat(), 6, 0)
                                       : dictionary_of(dictionary)),
        settings_(cv::aruco::DetectorParameters::create()) {
    settings_->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
    // Windows of 13 and 23 pixels. The default's third window, of 3 pixels, finds no further tags but takes a third of
    // the time.
    settings_->adaptiveThreshWinSizeMin = 13;
    // The outline of the white border must not replace that of the tag, which is at most 1/24 of the perimeter away.
    settings_->minMarkerDistanceRate = 0.01;
  }

  bool find(const Image& image, const Region& region, std::vector<TagOutline>& found) override {
    found.clear();
    try {
      expect_sizes_of(image, region);
      const cv::Mat all = wrap(image);
      const bool is_whole = region.area() == whole(image).area();
      cv::aruco::detectMarkers(is_whole ? all : all({region.left, region.top, region.width, region.height}),
                               dictionary_, corners_, ids_, settings_, squares_);
    } catch (const cv::Exception&) {
      return false;
    }
    const bool all = dictionary_->bytesList.empty();
    const auto& corners = all ? squares_ : corners_;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      TagOutline outline{all ? 0 : static_cast<std::uint32_t>(ids_[i]), {}};
      const glm::dvec2 corner(region.left, region.top);
      for (std::size_t k = 0; k < 4; ++k) outline.corners[k] = corner + glm::dvec2(corners[i][k].x, corners[i][k].y);
      found.push_back(outline);
    }
    return true;
  }

 private:
  /// OpenCV limits perimeters to shares of the searched image's longer side, rounded down to pixels.
  void expect_sizes_of(const Image& image, const Region& region) {
    const cv::aruco::DetectorParameters defaults;
    const double image_side = std::max(image.width, image.height), side = std::max(region.width, region.height);
    const auto rate = [&](double of_image) {
      return side == image_side ? of_image : (std::floor(of_image * image_side) + 0.5) / side;
    };
    settings_->minMarkerPerimeterRate = rate(defaults.minMarkerPerimeterRate);
    settings_->maxMarkerPerimeterRate = rate(defaults.maxMarkerPerimeterRate);
  }

  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> settings_;
  std::vector<std::vector<cv::Point2f>> corners_, squares_;  // of tags, of dark quadrilaterals without a code
  std::vector<int> ids_;
};

}  // namespace

std::uint32_t tag_count(const std::string& dictionary) {
  return static_cast<std::uint32_t>(dictionary_of(dictionary)->bytesList.rows);
}

TagPattern tag_pattern(const std::string& dictionary, std::uint32_t id) {
  const auto tags = dictionary_of(dictionary);
  if (id >= static_cast<std::uint32_t>(tags->bytesList.rows))
    throw base::InputError(fmt::format("tag {} is not in dictionary '{}', which has the ids 0 to {}", id, dictionary,
                                       tags->bytesList.rows - 1));
  // One pixel per cell.
  const int cells = tags->markerSize + 2;
  cv::Mat picture;
  tags->drawMarker(static_cast<int>(id), cells, picture, 1);
  TagPattern pattern{cells, {}};
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column)
      pattern.white.push_back(picture.at<std::uint8_t>(row, column) > 127 ? 1 : 0);
  return pattern;
}

std::unique_ptr<TagFinder> make_tag_finder(const std::string& dictionary) {
  return std::make_unique<ArucoFinder>(dictionary);
}

}  // namespace sf::vision
