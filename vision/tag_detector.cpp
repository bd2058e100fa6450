#include "vision/tag_detector.h"

#include <algorithm>
#include <cmath>

namespace sf::vision {

TagDetector::TagDetector(const Testbed& testbed, const Camera& camera)
    : testbed_(testbed),
      camera_(camera),
      cells_(opencv().tag_pattern(testbed.dictionary, 0).cells),
      finder_(opencv().make_tag_finder(testbed.dictionary)) {}

TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;

bool TagDetector::measure(const Image& image, const TagOutline& outline, Sighting& out) {
  const TagMount& mount = testbed_.mount(outline.id);
  if (testbed_.only_listed && testbed_.tags.count(outline.id) == 0) {
    ++counts_.unlisted;
    return false;
  }
  find_edges(image, outline, cells_, edges_);
  const auto fit = fit_tag(camera_, edges_, mount.height);
  if (!fit) {
    ++counts_.unfitted;
    return false;
  }
  if (std::abs(fit->side - mount.side) > kMaxSideError * mount.side || fit->residual > kMaxResidual * fit->pixel) {
    ++counts_.misfitted;
    return false;
  }
  out.id = outline.id;
  out.fit = *fit;
  return true;
}

void TagDetector::detect(const Image& image, double time, std::vector<Sighting>& out) {
  out.clear();
  ++counts_.images;
  if (!finder_->find(image, outlines_)) ++counts_.unreadable;
  for (const TagOutline& outline : outlines_) {
    Sighting sighting;
    if (!measure(image, outline, sighting)) continue;
    sighting.time = time + middle_of_exposure(camera_, sighting.fit.row);
    out.push_back(sighting);
  }
  const auto side_error = [&](const Sighting& s) { return std::abs(s.fit.side - testbed_.mount(s.id).side); };
  std::sort(out.begin(), out.end(), [&](const Sighting& a, const Sighting& b) {
    return a.id != b.id ? a.id < b.id : side_error(a) < side_error(b);
  });
  out.erase(std::unique(out.begin(), out.end(), [](const Sighting& a, const Sighting& b) { return a.id == b.id; }),
            out.end());
  counts_.sightings += out.size();
}

}  // namespace sf::vision
