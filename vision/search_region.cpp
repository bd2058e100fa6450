#include "vision/search_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sf::vision {

namespace {

constexpr double kMostOfImage = 0.7;  // share of the image from which it is searched as a whole
constexpr int kPointsAlong = 5;       // of a side, since the lens bends lines

struct PixelBox {
  glm::dvec2 low{1e9}, high{-1e9};
  bool is_complete = true;  ///< all points have pixels

  bool is_empty() const { return low.x > high.x; }
};

/// Returns the pixels of a box in the world, from points on the sides of its lower and upper faces.
PixelBox projected(const Camera& camera, const TagPlace& place, double more) {
  PixelBox box;
  const glm::dvec2 reach = place.reach + more;
  for (const double z : {place.height - place.height_error, place.height + place.height_error}) {
    for (int i = 0; i < kPointsAlong; ++i)
      for (int j = 0; j < kPointsAlong; ++j) {
        const glm::dvec2 p = place.center + reach * (glm::dvec2{i, j} * (2.0 / (kPointsAlong - 1)) - 1.0);
        const auto pixel = project(camera, {p.x, p.y, z});
        box.is_complete = box.is_complete && pixel.has_value();
        if (!pixel) continue;
        box.low = glm::min(box.low, *pixel);
        box.high = glm::max(box.high, *pixel);
      }
    if (place.height_error == 0.0) break;
  }
  return box;
}

/// [px] Returns the least distance of the centre of a complete tag from the border of the image.
double least_distance(const Camera& camera, const TagPlace& place, const TagMount& mount) {
  if (mount.fit == TagFreedom::tilt) return 0.0;
  const auto distance = [&](glm::dvec2 off) {
    const auto a = project(camera, {place.center.x, place.center.y, place.height});
    const auto b = project(camera, {place.center.x + off.x, place.center.y + off.y, place.height});
    return a && b ? glm::distance(*a, *b) : 0.0;
  };
  // The other parts of a large place may be imaged smaller.
  return 0.5 * 0.5 * mount.side * std::min(distance({1.0, 0.0}), distance({0.0, 1.0}));
}

bool overlap(const Region& a, const Region& b) {
  return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;
}

Region around(const Region& a, const Region& b) {
  const int left = std::min(a.left, b.left), top = std::min(a.top, b.top);
  return {left, top, std::max(a.left + a.width, b.left + b.width) - left,
          std::max(a.top + a.height, b.top + b.height) - top};
}

}  // namespace

void add_region(const Camera& camera, const TagPlace& place, const TagMount& mount, int cells, Search& search) {
  if (search.whole) return;
  const glm::dvec2 last(camera.intrinsics.width - 1, camera.intrinsics.height - 1);
  const PixelBox centers = projected(camera, place, 0.0);
  if (centers.is_empty()) return;
  const double border = least_distance(camera, place, mount);
  if (centers.high.x < border || centers.high.y < border || centers.low.x > last.x - border ||
      centers.low.y > last.y - border)
    return;
  const PixelBox tags = projected(camera, place, M_SQRT1_2 * mount.side * (cells + 2.0) / cells);
  if (!tags.is_complete) {
    search.whole = true;
    return;
  }
  const glm::dvec2 low = glm::max(glm::floor(tags.low) - double{TagFinder::kRegionMargin}, glm::dvec2{0.0});
  const glm::dvec2 high = glm::min(glm::ceil(tags.high) + double{TagFinder::kRegionMargin}, last);
  const auto pixels = [](double n) { return static_cast<int>(n); };
  search.regions.push_back({pixels(low.x), pixels(low.y), pixels(high.x - low.x) + 1, pixels(high.y - low.y) + 1});
}

void merge_regions(const Intrinsics& image, Search& search) {
  auto& regions = search.regions;
  for (std::size_t i = 0; i < regions.size();) {
    const auto other = std::find_if(regions.begin() + static_cast<std::ptrdiff_t>(i) + 1, regions.end(),
                                    [&](const Region& each) { return overlap(regions[i], each); });
    if (other == regions.end()) {
      ++i;
      continue;
    }
    regions[i] = around(regions[i], *other);
    regions.erase(other);
    i = 0;  // the larger region may overlap earlier ones
  }
  std::int64_t area = 0;
  for (const Region& region : regions) area += region.area();
  if (static_cast<double>(area) > kMostOfImage * image.width * image.height) search.whole = true;
  if (search.whole) regions.clear();
}

}  // namespace sf::vision
