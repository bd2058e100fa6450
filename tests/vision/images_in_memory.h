#pragma once

#include <utility>
#include <vector>

#include "vision/opencv.h"

namespace sf::vision {

class ImagesInMemory : public ImageSource {
 public:
  explicit ImagesInMemory(std::vector<Image> images) : images_(std::move(images)) {}
  bool next(Image& out) override {
    if (at_ == images_.size()) return false;
    out = images_[at_++];
    return true;
  }

 private:
  std::vector<Image> images_;
  std::size_t at_ = 0;
};

}  // namespace sf::vision
